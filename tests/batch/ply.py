# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes PLY files such that every bit can be compared."""
import os
import struct

# What the host stores coordinates in, and what the meshes for it are written in.
SCALAR = os.environ.get("LAPEDIT_SCALAR", "float")
_NUMBER, _WORD = {"float": ("<f", "<I"), "double": ("<d", "<Q")}[SCALAR]

# Floats are read as the integers of the same bits: what is compared are bits, and NaN equals itself.
BITS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "I", "double": "Q",
        "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "I",
        "float64": "Q"}


def float_of(bits):
    return struct.unpack(_NUMBER, struct.pack(_WORD, bits))[0]


def bits_of(number):
    return struct.unpack(_WORD, struct.pack(_NUMBER, number))[0]


class Ply:
    """elements[element][property] is a list with one entry per row; a list property's entries are tuples."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        end = data.index(b"end_header\n") + len(b"end_header\n")
        header = data[:end].decode().splitlines()
        assert header[1] in ("format binary_little_endian 1.0", "format ascii 1.0"), header[1]
        layout = []
        for line in header:
            words = line.split()
            if words[0] == "element":
                layout.append((words[1], int(words[2]), []))
            elif words[0] == "property":
                layout[-1][2].append(words[1:])
        if header[1] == "format ascii 1.0":
            data = data[:end] + _packed(data[end:].split(), layout)
        self.elements = {}
        offset = end
        for element, count, properties in layout:
            self.elements[element], offset = _read_rows(data, offset, count, properties)

    def points(self):
        """Vertices as triples of floats."""
        v = self.elements["vertex"]
        return [tuple(float_of(c) for c in row) for row in zip(v["x"], v["y"], v["z"])]

    def point_bits(self):
        v = self.elements["vertex"]
        return list(zip(v["x"], v["y"], v["z"]))

    def faces(self):
        f = self.elements["face"]
        return f["vertex_indices"] if "vertex_indices" in f else f["vertex_index"]


def _packed(words, layout):
    """The rows of a text file as they are in a binary one."""
    words, packed = iter(words), []

    def pack(kind):
        real = kind in ("float", "double", "float32", "float64")
        value = float(next(words)) if real else int(next(words))
        packed.append(struct.pack("<" + (BITS[kind].translate({73: "f", 81: "d"}) if real else BITS[kind]), value))
        return value
    for _element, count, properties in layout:
        for _ in range(count):
            for kind in properties:
                for _ in range(pack(kind[1]) if kind[0] == "list" else 1):
                    pack(kind[-2])
    return b"".join(packed)


def _read_rows(data, offset, count, properties):
    columns = {words[-1]: [] for words in properties}
    if count == 0:
        return columns, offset
    # All lists of a property are as long as its first one (triangles): then a row has a fixed layout.
    form, at = "<", offset
    lengths = []
    for words in properties:
        if words[0] == "list":
            size = struct.unpack_from("<" + BITS[words[1]], data, at)[0]
            lengths.append(size)
            part = BITS[words[1]] + (BITS[words[2]] * size)
        else:
            lengths.append(None)
            part = BITS[words[0]]
        form += part
        at += struct.calcsize("<" + part)
    row_size = struct.calcsize(form)
    rows = list(zip(*struct.iter_unpack(form, data[offset:offset + count * row_size])))
    column = 0
    for words, size in zip(properties, lengths):
        if size is None:
            columns[words[-1]] = list(rows[column])
            column += 1
        else:
            assert set(rows[column]) == {size}, f"lists of different lengths in {words[-1]}"
            columns[words[-1]] = list(zip(*rows[column + 1:column + 1 + size])) if size else [()] * count
            column += 1 + size
    return columns, offset + count * row_size


def write_ply(path, points, faces, vertex_extra="", vertex_values=None, face_extra="", face_values=None):
    """An ASCII PLY. The extras are header lines, the values one string per row; a face may have any corners."""
    vertex_values = vertex_values or [""] * len(points)
    face_values = face_values or [""] * len(faces)
    with open(path, "w", encoding="ascii") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty {SCALAR} x\nproperty {SCALAR} y\n"
                   f"property {SCALAR} z\n{vertex_extra}element face {len(faces)}\n"
                   f"property list uchar int vertex_indices\n{face_extra}end_header\n")
        for (x, y, z), more in zip(points, vertex_values):
            file.write(f"{x!r} {y!r} {z!r} {more}\n")
        for face, more in zip(faces, face_values):
            file.write(f"{len(face)} {' '.join(map(str, face))} {more}\n")
    return path
