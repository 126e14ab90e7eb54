# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of builds reports each difference."""
import contextlib
import io
import json
import pathlib
import struct
import tempfile
import unittest
import unittest.mock

import compare

POINTS = [(0.1 * v, 0.2 * v * v, 1.0 - v) for v in range(20)]


def next_float(number):
    """The float above a positive one."""
    return struct.unpack("<f", struct.pack("<I", struct.unpack("<I", struct.pack("<f", number))[0] + 1))[0]


def write_mesh(path, points, faces=((0, 1, 2),)):
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
              "property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes((header % (len(points), len(faces))).encode() + b"".join(struct.pack("<3f", *p) for p in points)
                     + b"".join(struct.pack("<B3i", 3, *f) for f in faces))


class CompareTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def build(self, name, edit="mesh.ply/lift", before=None, after=None, **options):
        """Results of a build whose only edit moves the first five vertices, unless other meshes are given."""
        folder = self.folder / name / edit
        folder.mkdir(parents=True)
        write_mesh(folder / "pose-0001.ply", before or POINTS, **options)
        write_mesh(folder / "pose-0002.ply", after or self.lifted(), **options)
        (folder / "report.json").write_text(json.dumps(
            {"outputs": [{"steps": [{"handle": 1, "free": 3, "anchors": 1}]}]}))
        return self.folder / name

    @staticmethod
    def lifted():
        return [(x, y, z + 3) if v < 5 else (x, y, z) for v, (x, y, z) in enumerate(POINTS)]

    def compare(self, *folders):
        """@return what is printed, and the sentences"""
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            failures = compare.compare(list(folders))
        return out.getvalue(), "\n".join(failures)

    def test_the_same_is_the_same(self):
        table, failures = self.compare(self.build("a"), self.build("b"), self.build("c"))
        self.assertEqual(failures, "")
        self.assertIn("| mesh.ply/lift | 5 | 5 | 60 | 0 | 0 |", table)
        self.assertIn("120 coordinates compared, 0 differ.", table)

    def test_one_bit_of_one_coordinate_is_seen(self):
        other = self.lifted()
        other[3] = (next_float(other[3][0]), *other[3][1:])
        table, failures = self.compare(self.build("a"), self.build("b"), self.build("c", after=other))
        self.assertIn("mesh.ply/lift on c: 1 (1 ULP", failures)
        self.assertNotIn("on b", failures)
        self.assertIn("| 60 | 0 | 1 (1 ULP", table)

    def test_so_is_one_outside_the_region(self):
        other = self.lifted()
        other[19] = (next_float(other[19][0]), *other[19][1:])
        self.assertIn("1 (1 ULP", self.compare(self.build("a"), self.build("b", after=other))[1])

    def test_the_sign_of_a_zero_counts_but_is_no_distance(self):
        other = self.lifted()
        other[0] = (-0.0, *other[0][1:])
        self.assertIn("1 (0 ULP", self.compare(self.build("a"), self.build("b", after=other))[1])

    def test_an_edit_that_moves_nothing_compares_nothing(self):
        self.assertIn("moves nothing", self.compare(self.build("a", after=POINTS), self.build("b", after=POINTS))[1])

    def test_stored_digests_are_compared(self):
        results = self.build("a")
        with unittest.mock.patch.object(compare, "DIGESTS", self.folder / "digests.txt"):
            with unittest.mock.patch.object(compare.sys, "argv", ["compare.py", "--store", str(results)]):
                compare.main()
            self.assertEqual(compare.compare_with_stored(results), [])
            other = self.lifted()
            other[3] = (next_float(other[3][0]), *other[3][1:])
            self.assertIn("the edit gives other coordinates", compare.compare_with_stored(self.build("b", after=other))[0])
            self.assertIn("the mesh has other", compare.compare_with_stored(self.build("c", before=other))[0])
            self.assertIn("no stored digests", compare.compare_with_stored(self.build("d", edit="mesh.ply/other"))[0])
            self.assertIn("has no edits", compare.compare_with_stored(self.folder / "nowhere")[0])

    def test_meshes_have_to_be_read_alike(self):
        other = [(9, 9, 9), *POINTS[1:]]
        self.assertIn("read have other coordinates", self.compare(self.build("a"), self.build("b", before=other))[1])
        self.assertIn("other vertices or faces", self.compare(self.build("c"), self.build("d", faces=((0, 2, 1),)))[1])

    def test_missing_results_are_a_failure(self):
        self.assertIn("has not the edits", self.compare(self.build("a"), self.build("b", edit="mesh.ply/other"))[1])
        self.assertIn("has not the edits", self.compare(self.build("c"), self.folder / "nowhere")[1])
        self.assertIn("has not the edits", self.compare(self.folder / "nowhere", self.build("d"))[1])


if __name__ == "__main__":
    unittest.main()
