# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the numbers of vertices and normals in the bytes of a mesh file (see mesh_files.py), independently of the program."""
import itertools
import math
import re
import struct

from mesh_files import LETTERS, MARK, fanned

TYPES = {**LETTERS, "float32": "f", "uint8": "B", "int32": "i"}
TOKEN = re.compile(rb"\\(?:\r\n|\n)|#[^\r\n]*|\r\n|\n|\r|(?:[^\s\\]|\\(?!\r?\n))+")


def lines_of(data):
    """The words of each line that has any, with their spans in the data; a backslash continues a line."""
    lines = [[]]
    for match in TOKEN.finditer(data.replace(MARK, b"   ", 1) if data.startswith(MARK) else data):
        word = match.group()
        if word in (b"\r\n", b"\n", b"\r"):
            lines.append([])
        elif word[:1] != b"#" and word[:2] not in (b"\\\r", b"\\\n"):
            lines[-1].append((word, match.span()))
    return [line for line in lines if line]


class MeshBytes:
    """points; polygons; triangles, fanned; groups: (kind, number of the vertex, normal or polygon, spans, values) of every
    three numbers that an edit may change."""

    def __init__(self, name, data):
        self.data, self.points, self.polygons, self.groups, self.is_single = data, [], [], [], False
        self.normals_of_corners = None  # OBJ: like polygons
        {"ply": self.read_ply, "obj": self.read_obj, "off": self.read_off, "stl": self.read_stl}[name.lower()[-3:]]()
        self.triangles, self.users = [fan for p in self.polygons for fan in fanned(p)], {}
        normals = [fan for p in self.normals_of_corners or self.polygons for fan in fanned(p)]
        for points, those in zip(self.triangles, normals):  # vertex normal -> corners, with the two others of the triangle
            for k in range(3):
                self.users.setdefault(those[k], []).append((points[k], points[k - 2], points[k - 1]))

    def add(self, kind, number, words):
        values = [value for value, _ in words]
        self.groups.append((kind, number, [span for _, span in words], values))
        return values

    def add_text(self, kind, number, words):
        return self.add(kind, number, [(float(word), span) for word, span in words[:3]])

    def read_ply(self):
        end = re.search(rb"end_header(\r\n|\n|\r)", self.data)
        elements = []
        for words in (line.split() for line in re.split(r"\r\n|\n|\r", self.data[:end.start()].decode())):
            if words and words[0] == "format":
                order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[words[1]]
            elif words and words[0] == "element":
                elements.append((words[1], int(words[2]), []))
            elif words and words[0] == "property":
                elements[-1][2].append((words[-1], [TYPES[word] for word in words[1:-1] if word != "list"]))
        tokens, at = re.finditer(rb"\S+", self.data[end.end():]), end.end()

        def number(letter):
            nonlocal at
            if not order:
                match = next(tokens)
                value = (float if letter in "fd" else int)(match.group())
                return struct.unpack(letter, struct.pack(letter, value))[0], tuple(end.end() + k for k in match.span())
            at += struct.calcsize(letter)
            span = at - struct.calcsize(letter), at
            return struct.unpack_from(order + letter, self.data, span[0])[0], span

        for element, count, properties in elements:
            for row in range(count):
                found = {}
                for name, letters in properties:
                    first = number(letters[0])
                    found[name] = first if len(letters) == 1 else [number(letters[1])[0] for _ in range(first[0])]
                if element == "vertex":
                    self.points.append(self.add("position", row, [found[c] for c in "xyz"]))
                    self.is_single = dict(properties)["x"] == ["f"]
                corners = found.get("vertex_indices", found.get("vertex_index"))
                if "nx" in found:
                    self.add(*(("vertex normal", row) if element == "vertex" else ("facet normal", len(self.polygons))),
                             [found["n" + c] for c in "xyz"])
                if element == "face":
                    self.polygons.append(corners)
                if element == "tristrips":
                    for strip in (list(g) for ends, g in itertools.groupby(corners, lambda c: c == -1) if not ends):
                        self.polygons += [[strip[k + k % 2], strip[k + 1 - k % 2], strip[k + 2]] for k in range(len(strip) - 2)]

    def read_obj(self):
        self.normals_of_corners, normals = [], 0
        for (keyword, _), *words in lines_of(self.data):
            if keyword == b"v":
                self.points.append(self.add_text("position", len(self.points), words))
            elif keyword == b"vn":
                self.add_text("vertex normal", normals, words)
                normals += 1
            elif keyword == b"f":
                def index(text, count):
                    return -1 if not text else int(text) - 1 if int(text) > 0 else count + int(text)
                parts = [(word.split(b"/") + [b"", b""])[:3] for word, _ in words]
                self.polygons.append([index(part[0], len(self.points)) for part in parts])
                self.normals_of_corners.append([index(part[2], normals) for part in parts])

    def read_off(self):
        lines = lines_of(self.data)
        keyword, *counts = lines.pop(0)
        prefixes, first = keyword[0].split(b"OFF")
        vertices, faces = (int(word) for word in [first, *(word for word, _ in counts or lines.pop(0))][not first:][:2])
        while all(len(line) % 3 == 0 for line in lines[:1]) and len(lines) < vertices + faces:  # several vertices in a line
            ends = [k for k, line in enumerate(lines) if len(line) > 3 and line[0][0] not in (b"3", b"4", b"7")]
            lines[ends[0]:ends[0] + 1] = [lines[ends[0]][:3], lines[ends[0]][3:]]
        for row, words in enumerate(lines[:vertices]):
            self.points.append(self.add_text("position", row, words))
            if b"N" in prefixes:
                behind = 3 + (b"4" in prefixes) + 4 * (b"NC" in prefixes and words[3][0] == b"9")
                self.add_text("vertex normal", row, words[behind:])
        diagonals = set()
        for line in lines[vertices:vertices + faces]:
            corners = [int(word) for word, _ in line[1:1 + int(line[0][0])]]
            self.polygons.append(split_as_meshlab(self.points, corners, diagonals) if len(corners) == 4 else corners)

    def read_stl(self):
        if len(self.data) == 84 + 50 * int.from_bytes(self.data[80:84], "little"):
            self.is_single = True
            words = [((struct.unpack_from("<f", self.data, at)[0]), (at, at + 4))
                     for begin in range(84, len(self.data), 50) for at in range(begin, begin + 48, 4)]
        else:
            words = [(float(word), span) for line in lines_of(self.data) if line[0][0].lower() in (b"vertex", b"facet")
                     for word, span in line[-3:]]
        numbers = {}
        for facet, begin in enumerate(range(0, len(words), 12)):
            self.add("facet normal", facet, words[begin:begin + 3])
            corners = []
            for k in range(begin + 3, begin + 12, 3):
                point = tuple(value for value, _ in words[k:k + 3])
                corners.append(numbers.setdefault(point, len(numbers)))
                self.add("position", corners[-1], words[k:k + 3])
            self.polygons.append(corners if len(set(corners)) == 3 else [])
        self.points = [list(point) for point in numbers]

    def texts(self, group):
        return [self.data[slice(*span)] for span in group[2]]

    def between(self):
        """The bytes between the numbers."""
        spans = sorted(span for _, _, group, _ in self.groups for span in group)
        ends = [0, *(end for _, end in spans)]
        return [self.data[begin:end] for begin, end in zip(ends, [*(begin for begin, _ in spans), len(self.data)])]

    def normal(self, kind, number):
        """Returns the unit normal by the angles at corners, or of a polygon by its area; None if there is no area."""
        if kind == "facet normal":
            vectors = [(cross(self.points, *triangle), 1) for triangle in fanned(self.polygons[number])]
        else:
            vectors = [(unit(cross(self.points, *corner)), angle(self.points, *corner)) for corner in self.users.get(number, ())]
        return unit([sum(weight * vector[k] for vector, weight in vectors) for k in range(3)])


def split_as_meshlab(points, quad, diagonals):
    """The quad from the corner on where the diagonal begins with which MeshLab reads it from OFF: that whose worse triangle has
    the better shape; none twice."""
    def worse(a, b, c, d):
        return min(shape(points, a, b, c), shape(points, a, c, d))
    following = [*quad[1:], quad[0]]
    chosen = following if worse(*quad) < worse(*following) else quad
    if {chosen[0], chosen[2]} in diagonals:
        chosen = [*chosen[1:], chosen[0]]
    diagonals.add(frozenset((chosen[0], chosen[2])))
    return chosen


def shape(points, *corners):
    """Inradius over circumradius, up to a factor."""
    a, b, c = (math.dist(points[corners[k - 1]], points[corners[k]]) for k in range(3))
    return (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)


def cross(points, a, b, c):
    u, v = ([points[end][k] - points[a][k] for k in range(3)] for end in (b, c))
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def angle(points, a, b, c):
    u, v = (unit([points[end][k] - points[a][k] for k in range(3)]) for end in (b, c))
    return math.acos(max(-1, min(1, sum(p * q for p, q in zip(u, v)))))


def unit(vector):
    length = math.hypot(*vector)
    return [c / length for c in vector] if length > 0 else vector
