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
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "cli"), str(HERE.parent)]

import mesh_files  # noqa: E402
from mesh_bytes import MeshBytes  # noqa: E402


def read(path):
    """@return points, triangles"""
    mesh = MeshBytes(path.name, path.read_bytes())
    return mesh.points, mesh.triangles


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
