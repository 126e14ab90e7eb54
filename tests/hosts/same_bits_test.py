# SPDX-License-Identifier: GPL-3.0-or-later
"""MeshLab with the filter gives the same coordinates as the program, to the bit, for the recorded edits.

Environment, besides that of tests/batch/host.py:
  LAPEDIT_RESULTS  what write_results.sh made in the precision of MeshLab
"""
import os
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "batch"))

from host import FilterHost, replay  # noqa: E402
from ply import Ply  # noqa: E402

RESULTS = pathlib.Path(os.environ["LAPEDIT_RESULTS"])


class SameBits(FilterHost):
    def test_recorded_edits(self):
        results = sorted(RESULTS.glob("*/*/report.json"))
        self.assertGreater(len(results), 5)
        for mesh, name in (report.parent.relative_to(RESULTS).parts for report in results):
            with self.subTest(mesh=mesh, edit=name):
                before, expected = (Ply(RESULTS / mesh / name / f"pose-000{k}.ply").point_bits() for k in (1, 3))
                path, _ = self.edited([replay(HERE / "edits" / mesh / f"{name}.json")], RESULTS / "meshes" / f"{mesh}.ply")
                self.assertEqual(sum(a != b for a, b in zip(Ply(path).point_bits(), expected)), 0)
                self.assertNotEqual(before, expected)


if __name__ == "__main__":
    unittest.main()
