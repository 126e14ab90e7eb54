# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes PLY files such that every bit can be compared."""
import os
import pathlib
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

import mesh_files  # noqa: E402

# The type of MeshLab's coordinates, and of those in the meshes that are written here.
SCALAR = os.environ.get("LAPEDIT_SCALAR", "float")
_NUMBER, _WORD = {"float": ("<f", "<I"), "double": ("<d", "<Q")}[SCALAR]

KINDS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
         "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}
# Floats are read as integers of the same bits, so that bits are compared, and NaN equals itself.
AS_BITS = str.maketrans("fd", "IQ")


def float_of(bits):
    return struct.unpack(_NUMBER, struct.pack(_WORD, bits))[0]


def bits_of(number):
    return struct.unpack(_WORD, struct.pack(_NUMBER, number))[0]


class Ply:
    """elements[element][property] is a list with one entry per row; a list property's entries are tuples. All lists of a
    property have the length of the first one."""

    def __init__(self, path):
        with open(path, "rb") as file:
            header, _, self._rest = file.read().partition(b"end_header\n")
        _, form, *lines = header.decode().splitlines()
        assert form in ("format ascii 1.0", "format binary_little_endian 1.0"), form
        self._ascii = "ascii" in form
        if self._ascii:
            self._rest = self._rest.split()
        layout = []
        for words in map(str.split, lines):
            if words[0] == "element":
                layout.append((words[1], int(words[2]), []))
            elif words[0] == "property":
                layout[-1][2].append(words[1:])
        self.elements = {element: self._read_rows(count, properties) if count else {words[-1]: [] for words in properties}
                         for element, count, properties in layout}

    def points(self):
        """Vertices as triples of floats."""
        return [tuple(map(float_of, row)) for row in self.point_bits()]

    def point_bits(self):
        v = self.elements["vertex"]
        return list(zip(v["x"], v["y"], v["z"]))

    def faces(self):
        f = self.elements["face"]
        return f["vertex_indices"] if "vertex_indices" in f else f["vertex_index"]

    def _read_rows(self, count, properties):
        form, fields = "", []
        for words in properties:
            first, size = len(form), None
            form += KINDS[words[words[0] == "list"]]
            if words[0] == "list":
                # The last number of a row that begins so.
                size = int(self._rest[first]) if self._ascii else struct.unpack_from("<" + form, self._rest)[-1]
                form += KINDS[words[2]] * size
            fields.append((words[-1], first, size))
        columns, rows = self._columns(form, count), {}
        for name, first, size in fields:
            assert size is None or set(columns[first]) == {size}, f"lists of different lengths in {name}"
            rows[name] = columns[first] if size is None else list(zip(*columns[first + 1:first + 1 + size])) or [()] * count
        return rows

    def _columns(self, form, count):
        size = count * (len(form) if self._ascii else struct.calcsize("<" + form))
        data, self._rest = self._rest[:size], self._rest[size:]
        bits = form.translate(AS_BITS)
        if not self._ascii:
            return list(map(list, zip(*struct.iter_unpack("<" + bits, data))))
        columns = []
        for k, (kind, word) in enumerate(zip(form, bits)):
            numbers = map(float if kind in "fd" else int, data[k::len(form)])
            columns.append(list(struct.unpack(f"<{count}{word}", struct.pack(f"<{count}{kind}", *numbers))))
        return columns


def write_ply(path, points, faces):
    """An ASCII PLY. A face may have any corners."""
    path.write_bytes(mesh_files.ply_plain((points, faces), SCALAR))
    return path
