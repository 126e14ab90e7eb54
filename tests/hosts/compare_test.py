# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of builds reports each difference."""
import math
import pathlib
import tempfile
import unittest
import unittest.mock

import compare
import ply_meshes

POINTS = [(0.125 * v, 0.25 * v * v, 1.0 - v) for v in range(20)]
LIFTED = [(x, y, z + 3) if v < 5 else (x, y, z) for v, (x, y, z) in enumerate(POINTS)]


def with_x(points, vertex, x):
    return [(x, *p[1:]) if v == vertex else p for v, p in enumerate(points)]


def next_float(number):
    """The float above a positive one."""
    return number + 2.0 ** (math.floor(math.log2(number)) - 23)


class CompareTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def build(self, name, edit="mesh.ply/lift", before=None, after=None):
        """Results of a build whose only edit moves the first five vertices, unless other meshes are given."""
        folder = self.folder / name / edit
        folder.mkdir(parents=True)
        for number, points in enumerate((before or POINTS, after or LIFTED), 1):
            ply_meshes.write(folder / f"pose-000{number}.ply", points, [(0, 1, 2)])
        (folder / "report.json").touch()
        return self.folder / name

    # What another build makes, and what is said of it.
    OTHERS = {"one bit in the region": ({"after": with_x(LIFTED, 3, next_float(LIFTED[3][0]))}, "the edit gives other coordinates"),
              "one bit outside": ({"after": with_x(LIFTED, 19, next_float(LIFTED[19][0]))}, "the edit gives other coordinates"),
              "sign of a zero": ({"after": with_x(LIFTED, 0, -0.0)}, "the edit gives other coordinates"),
              "another mesh": ({"before": with_x(POINTS, 0, 9.0)}, "the mesh that was read has other coordinates"),
              "another edit": ({"edit": "mesh.ply/other"}, "mesh.ply/other is not among the edits")}

    def test_builds_are_compared(self):
        first = self.build("first")
        self.assertEqual(compare.compare([first, self.build("same"), self.build("same too")]), [])
        for name, (change, sentence) in self.OTHERS.items():
            with self.subTest(name):
                failures = compare.compare([first, self.build("same as " + name), self.build(name, **change)])
                self.assertIn(sentence, failures[-1])
                self.assertFalse([failure for failure in failures if "same as" in failure])

    def test_missing_results_are_a_failure(self):
        first, nowhere = self.build("first"), self.folder / "nowhere"
        self.assertIn("has not the edit mesh.ply/lift", compare.compare([first, nowhere])[0])
        self.assertIn("has no edits", compare.compare([nowhere, first])[0])
        still = [self.build(name, after=POINTS) for name in ("still", "as still")]
        self.assertIn("moves nothing", compare.compare(still)[0])

    def test_stored_digests_are_compared(self):
        results = self.build("first")
        with unittest.mock.patch.object(compare, "DIGESTS", self.folder / "digests.txt"):
            with unittest.mock.patch.object(compare.sys, "argv", ["compare.py", "--store", str(results)]):
                compare.main()
            self.assertEqual(compare.compare_with_stored(results), [])
            for name, (change, sentence) in self.OTHERS.items():
                with self.subTest(name):
                    self.assertIn(sentence, compare.compare_with_stored(self.build(name, **change))[0])
            self.assertIn("has no edits", compare.compare_with_stored(self.folder / "nowhere")[0])


if __name__ == "__main__":
    unittest.main()
