# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours, quality and texture coordinates that a fitted template gets from its scan."""
import math
import struct
import unittest

from ply import Ply, float_of
from program import UNREADABLE, WRONG_USAGE, ProgramTest, files
from shapes import dome

NAMES = ("red", "green", "blue", "quality", "s", "t")


def sheet(rows, columns):
    points, faces = dome(rows, columns)
    return [(x, y, 0.3 * math.sin(math.pi * x) * math.sin(2 * y)) for x, y, _ in points], faces


def place(x, y, z):
    return 1.05 * x + 0.05 * math.sin(2 * y), y, 1.2 * z


MESH, SHEET = sheet(21, 21), sheet(31, 33)
SCAN, PLACED = (([place(*p) for p in points], faces) for points, faces in (SHEET, MESH))


def values(x, y, _):
    """What the scan has at a point: red, green, blue, quality, s, t."""
    return 30 + 150 * x, 20 + 200 * y, 77, 5 * x - y, x / 2, y / 3


def vertices(form, points, types, columns, line="\n"):
    """PLY with further columns. @param types  of coordinates, then of each column"""
    letters = "".join(files.LETTERS[kind] for kind in [types[0]] * 3 + types[1:])
    rows = [(letters, (*p, *(each if kind in ("float", "double") else round(each) for each, kind in zip(more, types[1:]))))
            for p, more in columns]
    faces = [(f"B{len(f)}i", (len(f), *f)) for f in points[1]]
    names = [f"{types[0]} {c}" for c in "xyz"] + [f"{kind} {name}" for kind, name in zip(types[1:], NAMES)]
    return files.rows_of_ply(form, [("vertex", names, rows), ("face", ["list uchar int vertex_indices"], faces)], line)


class Transfer(ProgramTest):
    def setUp(self):
        super().setUp()
        self.mesh.write_bytes(files.ply_plain(MESH))
        self.types = ["double", "uchar", "uchar", "uchar", "float", "float", "float"]
        self.scan, self.out = self.folder / "scan.ply", self.work / "out.ply"
        self.scan.write_bytes(vertices("binary_little_endian", SCAN, self.types, [(p, values(*p)) for p in SCAN[0]]).replace(
            b"obj_info x 1", b"comment TextureFile skin of a.png"))

    def fitted(self, *arguments, mesh=None):
        self.done("-q", "--fit", self.scan, mesh or self.mesh, self.out, *arguments)
        return Ply(self.out)

    def require_values(self, ply):
        """The values of the scan's function, apart from the border, which may lie beside the scan."""
        columns = ply.elements["vertex"]
        inside = [(k, p) for k, p in enumerate(ply.points()) if 0.12 < p[0] < 0.95 and 0.1 < p[1] < 0.9]
        self.assertGreater(len(inside), 200)
        for k, p in inside:
            for name, expected in zip(NAMES, values(*p)):
                found, step = (columns[name][k], 1) if name in NAMES[:3] else (float_of(columns[name][k]), 0.01)
                self.assertLess(abs(found - expected), 1.5 * step, (k, name))

    def test_new_columns(self):
        plain, rows = self.fitted(), {}
        for form, line in ("ascii", "\n"), ("ascii", "\r\n"), ("binary_little_endian", "\n"), ("binary_big_endian", "\n"):
            with self.subTest(form + repr(line)):
                self.mesh.write_bytes(files.rows_of_ply(form, [
                    ("vertex", ["float x", "float y", "float z"], [("fff", p) for p in MESH[0]]),
                    ("face", ["list uchar int vertex_indices"], [(f"B{len(f)}i", (len(f), *f)) for f in MESH[1]])], line))
                self.done("-q", "--fit", self.scan, self.mesh, self.out, "--transfer", "colour,quality,uv")
                given = self.out.read_bytes()
                self.assertIn(f"property uchar red{line}property uchar green{line}".encode(), given)
                self.assertIn(f"{line}comment TextureFile skin of a.png{line}".encode(), given)
                self.out.write_bytes(given.replace(b"\r\n", b"\n") if "\r" in line else given)
                if form == "ascii":
                    ply = Ply(self.out)
                    self.require_values(ply)
                    self.assertEqual(ply.faces(), plain.faces())
                    self.assertEqual(ply.point_bits(), plain.point_bits())
                else:
                    row = struct.Struct(files.FORMS[form] + "fffBBBfff")
                    at = given.index(b"end_header\n") + len(b"end_header\n")
                    rows[form] = [row.unpack_from(given, at + k * row.size) for k in range(len(MESH[0]))]
        for binary in rows.values():
            for k, found in enumerate(binary):
                self.assertEqual(found[3:6], tuple(ply.elements["vertex"][name][k] for name in NAMES[:3]))
                self.assertEqual(found[6:], tuple(float_of(ply.elements["vertex"][name][k]) for name in NAMES[3:]))

    def test_own_texture(self):
        """The scan's coordinates, whose names are other ones, and its texture replace those of the template."""
        self.scan.write_bytes(self.scan.read_bytes().replace(b"float s\n", b"float u\n").replace(b"float t\n", b"float v\n")
                              .replace(b"skin of a.png\n", b"skin of a.png\ncomment TextureFile second.png\n"))
        own = [(p, (9,) * 6) for p in MESH[0]]
        for form in "ascii", "binary_little_endian":
            with self.subTest(form):
                self.mesh.write_bytes(vertices(form, MESH, ["float", "uchar", "uchar", "uchar", "float", "float", "float"], own)
                                      .replace(b"obj_info x 1", b"comment TextureFile the old one.png"))
                ply = self.fitted("--transfer", "colour,quality,uv")
                self.require_values(ply)
                self.assertEqual(list(ply.elements["vertex"]), ["x", "y", "z", *NAMES])
                textures = [line for line in self.out.read_bytes().split(b"\n") if b"TextureFile" in line]
                self.assertEqual(textures, [b"comment TextureFile skin of a.png"])

    def test_own_columns_and_far_vertices(self):
        """The scan ends at y = 0.5: beyond it colours stay, as real numbers up to 1, and those of no others change."""
        scan = SCAN[0], [f for f in SCAN[1] if all(SHEET[0][v][1] < 0.5 for v in f)]
        self.scan.write_bytes(vertices("ascii", scan, self.types, [(p, values(*p)) for p in scan[0]]))
        types = ["float", "float", "float", "float", "double"]
        mesh = self.folder / "own.ply"
        mesh.write_bytes(vertices("binary_little_endian", PLACED, types, [(p, (0.25, 0.5, 1, 7.5)) for p in PLACED[0]]))
        for distance in (0.01, 0.2):
            ply = self.fitted("--transfer", "colour", "--within", distance, mesh=mesh)
            v = ply.elements["vertex"]
            near = [p[1] < 0.45 + distance for p in ply.points()]
            far = [p[1] > 0.52 + distance for p in ply.points()]
            self.assertGreater(sum(far), 40)
            self.assertGreater(sum(near), 150)
            for k, bits in enumerate(v["red"]):
                x = ply.points()[k][0]
                if far[k]:
                    self.assertEqual((float_of(bits), float_of(v["green"][k])), (0.25, 0.5))
                elif near[k] and ply.points()[k][1] < 0.45 and 0.12 < x < 0.95:
                    self.assertAlmostEqual(float_of(bits), (30 + 150 * x) / 255, delta=0.02)
            self.assertEqual(len(set(v["quality"])), 1)

    def test_colours_of_16_bits_onto_8(self):
        self.scan.write_bytes(vertices("binary_little_endian", SCAN, ["double", "ushort", "ushort", "ushort"],
                                       [(p, [257 * c for c in values(*p)[:3]]) for p in SCAN[0]]))
        mesh = self.folder / "own.ply"
        mesh.write_bytes(vertices("ascii", PLACED, ["float", "uchar", "uchar", "uchar"], [(p, (9, 9, 9)) for p in PLACED[0]]))
        self.assertEqual(set(self.fitted("--transfer", "colour", mesh=mesh).elements["vertex"]["blue"]), {77})

    def test_fractions_have_their_own(self):
        self.done("-q", "--fit", self.scan, self.mesh, self.out, "--transfer", "quality", "--fractions", "0.5,1", "--within", 1)
        half, whole = (Ply(self.work / f"out-000{k}.ply").elements["vertex"]["quality"] for k in (1, 2))
        self.assertNotEqual(half, whole)

    def test_refusals(self):
        self.refused(UNREADABLE, "has no quality of vertices", "--fit", self.mesh, self.mesh, self.out, "--transfer", "quality")
        self.refused(WRONG_USAGE, "give some of colour, quality, uv", "--fit", self.scan, self.mesh, self.out, "--transfer", "colour,normals")
        self.refused(WRONG_USAGE, "needs --fit, and template and scan in PLY", self.mesh, self.out, self.edit, "--transfer", "colour")
        (self.folder / "scan.obj").write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.refused(WRONG_USAGE, "needs --fit, and template and scan in PLY", "--fit", self.folder / "scan.obj", self.mesh, self.out,
                     "--transfer", "colour")
        for arguments in (("--within", "1"), ("--transfer", "uv", "--within", "-1"), ("--transfer", "uv", "--within", "near")):
            self.refused(WRONG_USAGE, "a length of 0 or more", "--fit", self.scan, self.mesh, self.out, *arguments)


if __name__ == "__main__":
    unittest.main()
