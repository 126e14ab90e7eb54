# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of builds reports each difference above the tolerance, and prints the largest one."""
import contextlib
import io
import json
import math
import pathlib
import tempfile
import unittest
import unittest.mock

import compare
import ply_meshes

POINTS = [(0.125 * v, 0.25 * v * v, 1.0 - v) for v in range(20)]
SIZE = math.dist((0, 0, 1), (0.125 * 19, 0.25 * 19 * 19, -18))


def lifted(points, count=5, height=3.0):
    return [(x, y, z + height) if v < count else (x, y, z) for v, (x, y, z) in enumerate(points)]


def moved(points, vertex, by, axis=0):
    return [tuple(c + by * (k == axis) for k, c in enumerate(p)) if v == vertex else p for v, p in enumerate(points)]


LIFTED = lifted(POINTS)
EDIT = "mesh.ply/lift"
OTHER_COORDINATES = "has coordinates that differ"
OTHER_MESH = "begins with a mesh of other coordinates"
NOT_FINITE = "has a coordinate that is not finite"


class CompareTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        stored = unittest.mock.patch.object(compare, "STORED", self.folder / "stored.json")
        stored.start()
        self.addCleanup(stored.stop)
        self.count = 0

    def build(self, *poses, edit=EDIT, before=POINTS, scalar="double"):
        """Results of a build that has one edit."""
        self.count += 1
        folder = self.folder / str(self.count) / edit
        folder.mkdir(parents=True)
        for number, points in enumerate((before, *(poses or (LIFTED,))), 1):
            ply_meshes.write(folder / f"pose-000{number}.ply", points, [(0, 1, 2)], scalar)
        return folder.parents[1]

    def run_main(self, *arguments):
        """@return code at the end, text printed"""
        text = io.StringIO()
        with contextlib.redirect_stdout(text), unittest.mock.patch.object(compare.sys, "argv", ["compare.py", *map(str, arguments)]):
            try:
                compare.main()
            except SystemExit as end:
                return end.code, text.getvalue()
        return 0, text.getvalue()

    def both(self, one, other):
        """What the comparisons say of two builds: of their folders, and of one with the stored results of the other."""
        self.assertEqual(self.run_main("--store", one), (0, ""))
        return self.run_main(one, other), self.run_main("--stored", other)

    def assert_unlike(self, sentence, one, other):
        for code, text in self.both(one, other):
            self.assertEqual(code, 1, text)
            self.assertIn(f"{other}: {EDIT} {sentence}", text)

    def test_differences_within_the_tolerance_are_printed(self):
        near = [(x, y, z + 0.4e-9 * SIZE * (-1) ** v) if v < 5 else (x, y, z) for v, (x, y, z) in enumerate(LIFTED)]
        for code, text in self.both(self.build(), self.build(near)):
            self.assertEqual(code, 0, text)
        code, text = self.run_main(self.build(), self.build(), self.build(near))
        self.assertEqual(code, 0)
        self.assertIn(f"Largest difference over the size: 4e-10, allowed 1e-09 ({self.folder / str(self.count)}: {EDIT})", text)

    def test_any_vertex_may_not_move(self):
        one = self.build(LIFTED, LIFTED)
        for axis in range(3):
            for vertex in range(20):
                with self.subTest(vertex=vertex, axis=axis):
                    other = moved(LIFTED, vertex, 1e-8 * SIZE, axis)
                    for poses in ((other, LIFTED), (LIFTED, other)):
                        self.assert_unlike(OTHER_COORDINATES, one, self.build(*poses))

    def test_a_vertex_among_many(self):
        """Also if most of them do not move."""
        points = [(v % 200, v // 200, 0.0) for v in range(20000)]
        for count in (5, 20000):
            after = lifted(points, count)
            one = self.build(after, before=points)
            self.run_main("--store", one)
            sample = json.loads(compare.STORED.read_text())[EDIT]["vertices"][1]
            for vertex, by in ((0, 300e-9), (19999, 300e-9), (sample, 2e-9)):
                with self.subTest(count=count, vertex=vertex):
                    other = moved(after, vertex, by * math.hypot(199, 99))
                    self.assert_unlike(OTHER_COORDINATES, one, self.build(other, before=points))

    def test_numbers_that_are_not_finite(self):
        for number in (math.nan, math.inf):
            for vertex in (0, 19):
                with self.subTest(number=number, vertex=vertex):
                    other = self.build(moved(LIFTED, vertex, number))
                    self.assert_unlike(NOT_FINITE, self.build(), other)
                    self.assertIn(NOT_FINITE, self.run_main(other, self.build())[1])
                    self.assertEqual(self.run_main(other, self.build(moved(LIFTED, vertex, number)))[0], 1)

    def test_the_mesh_that_was_read_has_the_same_bits(self):
        self.assert_unlike(OTHER_MESH, self.build(), self.build(before=[(-0.0, *POINTS[0][1:]), *POINTS[1:]]))
        self.assert_unlike(OTHER_MESH, self.build(), self.build(before=moved(POINTS, 19, math.ulp(19.0))))

    def test_other_counts(self):
        self.assert_unlike(OTHER_MESH, self.build(), self.build(LIFTED[:10], before=POINTS[:10]))
        self.assert_unlike("has poses with another number of vertices", self.build(), self.build(LIFTED[:19]))
        self.assert_unlike("has 1 poses in place of 2", self.build(LIFTED, LIFTED), self.build())
        self.assert_unlike("has 2 poses in place of 1", self.build(), self.build(LIFTED, LIFTED))

    def test_edits_that_one_build_lacks(self):
        one, other = self.build(), self.build(edit="mesh.ply/other")
        for folders in ((one, other), (other, one)):
            code, text = self.run_main(*folders)
            self.assertEqual(code, 1)
            self.assertIn(f"{one}: mesh.ply/other is missing", text)
            self.assertIn(f"{other}: {EDIT} is missing", text)
        self.run_main("--store", one)
        self.assertIn("mesh.ply/other is not in stored.json", self.run_main("--stored", other)[1])
        for arguments in ((self.folder / "none", self.folder / "neither"), ("--stored", self.folder / "none")):
            code, text = self.run_main(*arguments)
            self.assertEqual(code, 1)
            self.assertIn("no edits", text)

    def test_edits_that_move_too_little(self):
        little = "moves nothing, or too little"
        for poses in ((POINTS,), (POINTS, LIFTED), (lifted(POINTS, 20, 0.9e-3 * SIZE),)):
            with self.subTest(poses=poses):
                code, text = self.run_main(self.build(*poses), self.build(*poses))
                self.assertEqual(code, 1)
                self.assertIn(little, text)
        self.assert_unlike(little, self.build(), self.build(POINTS))

    def test_fits_have_a_tolerance_of_their_own(self):
        for by, code in ((0.9e-5, 0), (1.1e-5, 1)):
            folders = [self.build(pose, edit="mesh.ply/fit") for pose in (LIFTED, moved(LIFTED, 3, by * SIZE))]
            self.assertEqual(self.run_main(*folders)[0], code)

    def test_single_precision_is_refused(self):
        folders = [self.build(scalar="float") for _ in range(2)]
        self.assertIn("other properties than double", self.run_main(*folders)[0])


if __name__ == "__main__":
    unittest.main()
