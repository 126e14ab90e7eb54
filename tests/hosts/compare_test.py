# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of builds notices each difference above the tolerance, between folders and against stored numbers."""
import contextlib
import io
import math
import pathlib
import tempfile
import unittest
import unittest.mock

import compare
import ply_meshes

POINTS = [(0.125 * v, 0.25 * v * v, 1.0 - v) for v in range(20)]
SIZE = math.dist((0, 0, 1), (0.125 * 19, 0.25 * 19 * 19, -18))
LIFTED = [(x, y, z + 3) if v < 5 else (x, y, z) for v, (x, y, z) in enumerate(POINTS)]


def moved(points, vertex, by, axis=0):
    return [tuple(c + by * (k == axis) for k, c in enumerate(p)) if v == vertex else p for v, p in enumerate(points)]


class CompareTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        stored = unittest.mock.patch.object(compare, "STORED", self.folder / "stored.json")
        stored.start()
        self.addCleanup(stored.stop)
        self.one = self.build([LIFTED])
        self.run_main("--store", self.one)

    def build(self, poses, edit="lift", before=POINTS):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        (folder / "mesh.ply" / edit).mkdir(parents=True)
        for number, points in enumerate((before, *poses)):
            ply_meshes.write(folder / "mesh.ply" / edit / f"pose-000{number}.ply", points, [(0, 1, 2)], "double")
        return folder

    def run_main(self, *arguments):
        """@return what is printed where the folders differ, else an empty text"""
        text = io.StringIO()
        with contextlib.redirect_stdout(text), unittest.mock.patch.object(compare.sys, "argv", ["compare.py", *map(str, arguments)]):
            try:
                compare.main()
            except SystemExit:
                return text.getvalue()
        return ""

    def test_each_difference_is_noticed(self):
        cases = [("coordinates that differ", [moved(LIFTED, v, 1e-8 * SIZE, axis)], POINTS) for v in (0, 7, 19) for axis in range(3)]
        cases += [("not finite", [moved(LIFTED, 19, number)], POINTS) for number in (math.nan, math.inf)]
        cases += [("mesh of other coordinates", [LIFTED], moved(POINTS, 19, math.ulp(19.0))), ("in place of 1", [LIFTED, LIFTED], POINTS),
                  ("another number of vertices", [LIFTED[:19]], POINTS), ("too little", [POINTS], POINTS)]
        for sentence, poses, before in cases:
            for first in (self.one, "--stored"):
                with self.subTest(sentence, first=first):
                    self.assertIn(sentence, self.run_main(first, self.build(poses, before=before)))
        self.assertIn("is missing", self.run_main(self.one, self.build([LIFTED], "other")))
        self.assertIn("is not in stored.json", self.run_main("--stored", self.build([LIFTED], "other")))

    def test_tolerances(self):
        for edit, by, differs in (("lift", 0.9e-9, False), ("fit", 0.9e-5, False), ("fit", 1.1e-5, True)):
            folders = [self.build([pose], edit) for pose in (LIFTED, moved(LIFTED, 3, by * SIZE))]
            self.assertEqual(bool(self.run_main(*folders)), differs, (edit, by))


if __name__ == "__main__":
    unittest.main()
