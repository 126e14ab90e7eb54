# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python of the documents, as printed. Run by run.sh in an environment with trimesh, PyVista and PyMeshLab."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import imageio
import numpy
import trimesh

PROJECT = pathlib.Path(__file__).resolve().parent.parent.parent


def blocks(document):
    """Returns the Python of each heading."""
    text = (PROJECT / document).read_text(encoding="utf-8")
    return {section.splitlines()[0]: re.findall(r"```python\n(.*?)```", section, re.DOTALL)[0]
            for section in re.split(r"(?m)^## ", text) if "```python" in section}


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.jobs = blocks("common/python/README.md")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def printed(self, code):
        done = subprocess.run([sys.executable, "-W", "error::DeprecationWarning:__main__", "-c", code], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_all_are_here(self):
        self.assertEqual(list(self.jobs), ["Move a point", "Pose an arm", "Animate 60 frames", "Edit 200 meshes", "PyMeshLab"])

    def test_move_a_point(self):
        self.assertRegex(self.printed(self.jobs["Move a point"]),
                         r'^1\.(5|499)\d* \d+\nsteps\[0\] steps\[0\]: unknown key "radius"; .*\n$')

    def test_pose_an_arm(self):
        self.assertRegex(self.printed(self.jobs["Pose an arm"]), r"^\d{4,} 0\.[01]\d+\n$")
        bent = trimesh.load_mesh(self.folder / "bent.ply", process=False)
        tip = bent.vertices[bent.vertices[:, 0].argmax()]
        numpy.testing.assert_allclose(tip[[0, 2]], [2.08, 3.6], atol=0.3)
        self.assertGreater(bent.volume, 0.8 * numpy.pi * 0.16 * 4.4)

    def test_animate_60_frames(self):
        self.printed(self.jobs["Animate 60 frames"])
        frames = numpy.array([frame[..., :3] for frame in imageio.mimread(self.folder / "pull.gif", memtest=False)]).astype(int)
        self.assertEqual(frames.shape[:3], (60, 320, 320))
        moved = numpy.abs(frames - frames[0]).mean(axis=(1, 2, 3))
        self.assertGreater(moved[30], 5)
        self.assertGreater(moved[30], 2 * moved[4])

    def test_edit_200_meshes(self):
        (self.folder / "meshes").mkdir()
        for k in range(200):
            mesh = trimesh.creation.icosphere(subdivisions=2)
            mesh.apply_scale([1 + k / 400, 1, 1])
            if k == 7:
                mesh.apply_translation([0, 0, 100])
            mesh.export(self.folder / f"meshes/mesh-{k:03}.ply")
        lines = self.printed(self.jobs["Edit 200 meshes"]).split("\n")[:-1]
        self.assertEqual([line.split(":")[0] for line in lines], [f"mesh-{k:03}.ply" for k in range(200)])
        self.assertRegex(lines[7], "98 away from the nearest vertex")
        edited = sorted((self.folder / "edited").iterdir())
        self.assertEqual(len(edited), 199)
        self.assertAlmostEqual(trimesh.load_mesh(edited[0]).vertices[:, 2].max(), 1.3, delta=0.02)

    def test_pymeshlab(self):
        self.assertRegex(self.printed(self.jobs["PyMeshLab"]), r"^0\.\d+\n$")

    def test_readme(self):
        self.assertRegex(self.printed(blocks("README.md")["In Python"]), r"^1\.(5|499)\d*\n$")


if __name__ == "__main__":
    unittest.main()
