# SPDX-License-Identifier: GPL-3.0-or-later
"""Each job of the cookbook does what it says, on generated meshes: its commands and its JSON with the program, and, with
`cookbook_test.py --python`, also its Python, in an environment that has the package and trimesh. `xvfb-run cookbook_test.py --pictures`
makes the page's pictures, with python3-vtk9.

Environment:
  LAPEDIT_COMMAND    the program laplacian-edit
  LAPEDIT_MAKE_MESH  the program that generates the meshes
"""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/cli"))

from ply import Ply, write_ply as write  # noqa: E402

PROGRAM = pathlib.Path(os.environ["LAPEDIT_COMMAND"])
PAGE = (ROOT / "common/docs/cookbook.md").read_text(encoding="utf-8")
PYTHON, PICTURES = (sys.argv[1:] == [option] for option in ("--python", "--pictures"))


def read(path):
    mesh = Ply(path)
    return mesh.points(), mesh.faces()


def with_eyes(points, faces):
    """A head with a sphere of 136 vertices behind each eyelid."""
    points, faces = list(points), list(faces)
    rows, columns = 9, 15
    for side in (-1, 1):
        first = len(points)
        angles = [(math.pi * (i + 1) / (rows + 1), 2 * math.pi * j / columns) for i in range(rows) for j in range(columns)]
        points += [[0.36 * side + 0.15 * math.sin(a) * math.cos(b), 0.15 + 0.15 * math.sin(a) * math.sin(b),
                    0.75 + 0.15 * math.cos(a)] for a, b in angles] + [[0.36 * side, 0.15, 0.6]]
        for i in range(rows - 1):
            for j in range(columns):
                p, q = first + columns * i + j, first + columns * i + (j + 1) % columns
                faces += [[p, p + columns, q], [q, p + columns, q + columns]]
        faces += [[first + columns * (rows - 1) + (j + 1) % columns, first + columns * (rows - 1) + j, first + columns * rows]
                  for j in range(columns)]
    return points, faces


def largest(axis, points):
    return max(point[axis] for point in points)


class Cookbook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.environment = os.environ | {"PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
        for name in ("arm", "hand", "head", "letters", "person"):
            subprocess.run([os.environ["LAPEDIT_MAKE_MESH"], name, cls.folder / f"{name}.ply"], check=True, capture_output=True)
        cls.jobs = {section.splitlines()[0]: section for section in re.split(r"(?m)^## ", PAGE)}
        cls.begin = "".join(line[4:] + "\n" for line in cls.jobs["# Cookbook"].splitlines() if line.startswith("    "))

    def blocks(self, job, language):
        return re.findall(rf"```{language}\n(.*?)```", self.jobs[job], re.S)

    def run_command(self, command):
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=self.folder, env=self.environment, timeout=200,
                              capture_output=True, encoding="utf-8", errors="replace", check=False)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")
        return done.stdout

    def apply(self, job, mesh, tolerance):
        """Applies the job's JSON to a mesh, and its Python, which agrees with it to the tolerance."""
        (text,) = self.blocks(job, "json")
        (self.folder / "edit.json").write_text(text, encoding="utf-8")
        before, faces = read(self.folder / f"{mesh}.ply")
        name = "selected" if "selected" in text else mesh
        self.run_command(f"laplacian-edit --strict --report report.json {name}.ply out.ply edit.json")
        after, now = read(self.folder / "out.ply")
        self.assertTrue(now == faces)
        return before, after, self.same_in_python(job, mesh, after, tolerance)

    def draw(self, name, *meshes, toward=(0.3, 0.1, 1), up=(0, 1, 0)):
        """Draws meshes of the folder side by side into the page's picture of this name."""
        if PICTURES:
            panels = [word for mesh in meshes for word in ("--panel", f"{mesh}.ply", "")]
            subprocess.run(["/usr/bin/python3", ROOT / "common/demo/render.py", ROOT / f"common/docs/pictures/cookbook_{name}.png", *panels,
                            "--height", "220", "--toward", *map(str, toward), "--up", *map(str, up)], cwd=self.folder, check=True)

    def same_in_python(self, job, mesh, after, tolerance):
        if not PYTHON:
            return
        code = self.begin.replace("MESH", mesh) + self.blocks(job, "python")[0] + "numpy.save('python.npy', mesh.vertices)\n"
        done = subprocess.run([sys.executable, "-c", code], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        import numpy
        difference = numpy.abs(numpy.load(self.folder / "python.npy") - numpy.array(after)).max()
        self.assertLess(difference, tolerance, job)

    def test_every_job_is_here(self):
        self.assertEqual(sorted(name for name in self.jobs if "```python" in self.jobs[name]), sorted([
            "Bend a pipe by 30 degrees", "Lengthen a nose by 5 %", "Scale an ear along one axis", "Pose an arm and a finger",
            "Move landmarks to targets", "Fit a template with eyes to a scan", "Move half a row of teeth", "Make a face symmetric",
            "Repeat an edit on another mesh of the same object"]))

    def test_look(self):
        printed = "".join(self.run_command(line) for line in self.blocks("# Cookbook", "sh")[0].splitlines())
        self.assertIn("vertices: 25414", printed)
        self.assertIn("vertex: 13452, position: ", printed)

    def test_pipe(self):
        before, after, _ = self.apply("Bend a pipe by 30 degrees", "arm", 0.1)
        self.assertLess(abs(largest(1, after) - 2.65), 0.02)
        self.draw("pipe", "arm", "out", toward=(0.2, -0.2, 1))
        tip = max(range(len(before)), key=lambda i: before[i][0])
        for ours, expected in zip(after[tip], (5 + 5 * math.cos(math.pi / 6), 2.5, 0)):
            self.assertAlmostEqual(ours, expected, delta=1e-3)

    def test_nose(self):
        before, after, _ = self.apply("Lengthen a nose by 5 %", "head", 0.01)
        self.assertAlmostEqual((largest(2, after) - 0.9) / (largest(2, before) - 0.9), 1.05, delta=1e-4)

    def test_ear(self):
        before, after, _ = self.apply("Scale an ear along one axis", "head", 0.05)
        ear = [i for i, p in enumerate(before) if math.dist(p, (0.98, 0.08, -0.17)) < 0.2]
        self.assertAlmostEqual((max(after[i][1] for i in ear) - min(after[i][1] for i in ear)) /
                               (max(before[i][1] for i in ear) - min(before[i][1] for i in ear)), 1.3, delta=0.01)
        self.draw("ear", "head", "out", toward=(1, 0.1, 0.35))

    def test_arm_and_finger(self):
        job = "Pose an arm and a finger"
        (text,) = self.blocks(job, "json")
        (self.folder / "edit.json").write_text(text, encoding="utf-8")
        self.run_command("laplacian-edit --strict person.ply out.ply edit.json")
        self.assertAlmostEqual(largest(0, read(self.folder / "out.ply")[0]), 1.79, delta=0.02)
        self.draw("arm", "person", "out")
        tip = json.loads(text)
        tip["steps"][0] = {"region": {"radius": 0.6}, "handles": [
            {"within": {"point": [0.16, 1.6, 0.04], "radius": 0.35},
             "rotation": {"axis": [-1, 0, 0], "degrees": 60, "center": [0.12, 0.6, 0]}}]}
        (self.folder / "edit.json").write_text(json.dumps(tip), encoding="utf-8")
        self.run_command(re.search(r"`(laplacian-edit --fractions [^`]*)`", self.jobs[job])[1])
        bent, _ = read(self.folder / "out-0004.ply")
        self.assertLess(min(p[2] for p in bent), -0.8)
        self.draw("finger", "hand", "out-0004", toward=(0.9, 0.2, -0.5))
        self.same_in_python(job, "hand", bent, 1e-5)

    def test_landmarks(self):
        job = "Move landmarks to targets"
        for command in re.split(r"\n(?=printf|laplacian-edit)", self.blocks(job, "sh")[0].strip()):
            self.run_command(command)
        short = read(self.folder / "out.ply")[0]
        landmarks = json.loads((self.folder / "report.json").read_text(encoding="utf-8"))["outputs"][0]["steps"][0]["landmarks"]
        self.assertEqual(sorted(one["name"] for one in landmarks), ["chin", "crown", "left", "nose", "right"])
        self.assertLess(max(one["residual"] for one in landmarks), 1e-3)
        self.draw("landmarks", "head", "out", toward=(0.5, 0.1, 1))
        _before, after, _ = self.apply(job, "head", 1e-5)
        self.assertTrue(after == short, "--landmarks stands for another edit")

    def test_template_with_eyes(self):
        points, faces = read(self.folder / "head.ply")
        write(self.folder / "scan.ply", [[1.05 * x, 0.95 * y, 1.1 * z] for x, y, z in points], faces)
        points, faces = with_eyes(points, faces)
        self.assertEqual(len(points), 25686)
        write(self.folder / "template.ply", points, faces)
        before, after, _ = self.apply("Fit a template with eyes to a scan", "template", 0.01)
        eye, skin = ([after[i][2] - before[i][2] for i in some] for some in (
            range(25414, 25550), [i for i in range(25414) if math.dist(before[i], (-0.36, 0.15, 0.9)) < 0.15]))
        self.assertGreater(sum(skin) / len(skin), 0.03)
        self.assertAlmostEqual(sum(eye) / len(eye), sum(skin) / len(skin), delta=0.02)

    def test_teeth(self):
        job = "Move half a row of teeth"
        self.run_command(self.blocks(job, "sh")[0])
        before, after, _ = self.apply(job, "letters", 0.1)
        self.draw("teeth", "letters", "out", toward=(0.2, -0.6, 0.6))
        for i, point in enumerate(before):
            if point[0] > 1.5 and point[2] > 0.1:
                self.assertAlmostEqual(after[i][0] - point[0], 0.1, delta=1e-3)
            elif 0.3 < point[0] < 1.2 and point[2] > 0.1:
                self.assertLess(math.dist(after[i], point), 0.02)

    def test_symmetric_face(self):
        job = "Make a face symmetric"
        (self.folder / "crook.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [
            {"region": {"radius": 1}, "handles": [{"points": [[0, -0.13, 1.2]], "targets": [[0.12, -0.13, 1.2]]}]}]}))
        self.run_command("laplacian-edit head.ply crooked.ply crook.json")
        points, faces = read(self.folder / "crooked.ply")
        write(self.folder / "mirrored.ply", [[-x, y, z] for x, y, z in points], [face[::-1] for face in faces])
        self.run_command(self.blocks(job, "sh")[0])
        after, _ = read(self.folder / "out.ply")
        self.draw("symmetric", "crooked", "out", toward=(0, 0, 1))
        crooked, even = (max(made, key=lambda p: p[2])[0] for made in (points, after))  # where the nose's tip is
        self.assertGreater(crooked, 0.08)
        self.assertLess(abs(even), 0.03)
        self.apply(job, "crooked", 10)  # all of the way
        self.same_in_python(job, "crooked", after, 0.01)

    def test_another_mesh(self):
        before, after, _ = self.apply("Repeat an edit on another mesh of the same object", "head", 1e-5)
        self.assertAlmostEqual(largest(2, after) - largest(2, before), 0.2, delta=0.02)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
