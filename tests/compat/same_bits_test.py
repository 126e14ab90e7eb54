# SPDX-License-Identifier: GPL-3.0-or-later
"""MeshLab with the filter gives the same coordinates as the program, to the bit, for the recorded edits.

Environment, besides that of tests/cli/host.py:
  LAPEDIT_GENERATED  folder of the generated meshes
"""
import os
import pathlib
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from host import COMMAND, FilterHost, replay  # noqa: E402
from ply import SCALAR, Ply  # noqa: E402


class SameBits(FilterHost):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([sys.executable, HERE / "ply_meshes.py", SCALAR, os.environ["LAPEDIT_GENERATED"],
                        os.environ.get("LAPEDIT_MESHES", ""), cls.folder / "meshes"], check=True)

    def test_recorded_edits(self):
        edits = [(edit, mesh) for edit in sorted(HERE.glob("edits/*/*.json")) if edit.stem != "fit"
                 for mesh in (self.folder / "meshes").glob(f"{edit.parent.name}.ply")]
        self.assertGreater(len(edits), 5)
        for edit, mesh in edits:
            with self.subTest(mesh=mesh.stem, edit=edit.stem):
                made = self.folder / "made.ply"
                subprocess.run([COMMAND, "--quiet", mesh, made, edit], check=True)
                path, _ = self.edited([replay(edit)], mesh)
                before, expected = (Ply(file).point_bits() for file in (mesh, made))
                self.assertEqual(sum(a != b for a, b in zip(Ply(path).point_bits(), expected)), 0)
                self.assertNotEqual(before, expected)


if __name__ == "__main__":
    unittest.main()
