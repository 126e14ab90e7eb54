#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of the recorded edits and their scans as binary PLY files of triangles.

usage: ply_meshes.py SCALAR GENERATED MESHES FOLDER
  SCALAR     float or double
  GENERATED  folder of the generated meshes and scans
  MESHES     folder of the real meshes, may be empty
  FOLDER     where to write <mesh>.ply
"""
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from ply import Ply, mesh_files  # noqa: E402


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


def read(path):
    """@return points, triangles"""
    return {".off": read_off, ".stl": read_stl, ".ply": read_ply}[path.suffix.lower()](path)


def write(path, points, faces, scalar="float"):
    path.write_bytes(mesh_files.ply_plain((points, faces), scalar, "binary_little_endian"))


def main():
    scalar, generated, meshes, folder = sys.argv[1:]
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name in sorted({path.parent.name for path in HERE.glob("edits/*/*.json")}):
        path = pathlib.Path(generated, name)
        if not path.exists() and meshes:
            path = pathlib.Path(meshes, name)
        if path.exists():
            write(folder / f"{name}.ply", *read(path), scalar)


if __name__ == "__main__":
    main()
