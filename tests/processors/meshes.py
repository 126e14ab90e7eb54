#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of the recorded edits as plain numbers, and a list for core_edit.

usage: meshes.py RESULTS FOLDER     RESULTS: what hosts/write_results.sh made; FOLDER: for meshes and list
"""
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "batch"))

from ply import Ply  # noqa: E402


def main():
    results, folder = map(pathlib.Path, sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    written = {}
    lines = []
    for edit in sorted((HERE.parent / "hosts" / "edits").glob("*/*.json")):
        # The pose of fraction 0 is the mesh as it was read.
        mesh = results / edit.parent.name / edit.stem / "pose-0001.ply"
        if not mesh.exists():
            continue
        if edit.parent.name not in written:
            ply = Ply(mesh)
            points, faces = ply.points(), ply.faces()
            path = folder / f"{edit.parent.name}.raw"
            path.write_bytes(struct.pack("<ii", len(points), len(faces)) +
                             b"".join(struct.pack("<3d", *p) for p in points) +
                             b"".join(struct.pack("<3i", *f) for f in faces))
            written[edit.parent.name] = path
        lines.append(f"{written[edit.parent.name].name}\tedits/{edit.parent.name}/{edit.name}\n")
    if not lines:
        sys.exit(f"There are no results in {results}: run the test host.edits first.")
    (folder / "list").write_text("".join(lines), encoding="utf-8")
    link = folder / "edits"
    if not link.exists():
        link.symlink_to(HERE.parent / "hosts" / "edits")


if __name__ == "__main__":
    main()
