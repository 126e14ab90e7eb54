#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of the recorded edits as binary PLY files in single precision, as MeshLab reads them.

usage: float_meshes.py GENERATED MESHES FOLDER
  GENERATED, MESHES  folders of the generated and of the real meshes; MESHES may be empty
  FOLDER             where to write <mesh>.ply; strips and equal corners of STL files become indexed triangles
"""
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "batch"))

from ply import Ply  # noqa: E402


def read_off(path):
    words = path.read_text(encoding="ascii").split()
    count, triangles = int(words[1]), int(words[2])
    points = list(map(float, words[4:4 + 3 * count]))
    faces = list(map(int, words[4 + 3 * count:4 + 3 * count + 4 * triangles]))
    return list(zip(points[0::3], points[1::3], points[2::3])), list(zip(faces[1::4], faces[2::4], faces[3::4]))


def read_stl(path):
    """Binary. Equal corners are one vertex, numbered by first appearance."""
    numbers, faces = {}, []
    for row in struct.iter_unpack("<12fH", path.read_bytes()[84:]):
        faces.append(tuple(numbers.setdefault(row[k:k + 3], len(numbers)) for k in (3, 6, 9)))
    return list(numbers), faces


def read_ply(path):
    mesh = Ply(path)
    faces = mesh.faces() if "face" in mesh.elements else []
    for strip in mesh.elements.get("tristrips", {}).get("vertex_indices", ()):
        flip = 0
        for k in range(len(strip) - 2):
            a, b, c = strip[k:k + 3]
            if a == -1:
                flip = 0
            elif -1 not in (b, c):
                faces.append((b, a, c) if flip else (a, b, c))
                flip = 1 - flip
    return mesh.points(), faces


READERS = {".off": read_off, ".stl": read_stl, ".ply": read_ply}


def main():
    generated, meshes, folder = sys.argv[1:]
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name in sorted({path.parent.name for path in HERE.glob("edits/*/*.json")}):
        path = next((path for path in (pathlib.Path(generated, name), pathlib.Path(meshes, name)) if path.exists()), None)
        if path is None:
            continue
        points, faces = READERS[path.suffix.lower()](path)
        header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
                  f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        (folder / f"{name}.ply").write_bytes(header.encode() + b"".join(struct.pack("<3f", *p) for p in points)
                                             + b"".join(struct.pack("<B3i", 3, *f) for f in faces))


if __name__ == "__main__":
    main()
