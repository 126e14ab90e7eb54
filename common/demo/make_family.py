#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes many small meshes with the same connectivity, mesh-0001.off and so on, an edit, and a list jobs.tsv with the names of
mesh, output and edit in each line.

usage: make_family.py COUNT FOLDER
"""
import json
import math
import pathlib
import sys

SIDE = 15  # vertices along each border


def height(x, y, k):
    """Of mesh number k over a position in the unit square: a hill, with waves of its own."""
    hill = (0.2 + 0.01 * (k % 17)) * math.sin(math.pi * x) * math.sin(math.pi * y)
    return hill + 0.01 * math.sin(7 * x + k) * math.cos(9 * y - 2 * k)


def write(path, k):
    grid = [(i / (SIDE - 1), j / (SIDE - 1)) for i in range(SIDE) for j in range(SIDE)]
    lines = [f"{x:.9g} {y:.9g} {height(x, y, k):.9g}" for x, y in grid]
    for corner in (SIDE * i + j for i in range(SIDE - 1) for j in range(SIDE - 1)):
        lines += [f"3 {corner} {corner + SIDE} {corner + 1}", f"3 {corner + 1} {corner + SIDE} {corner + SIDE + 1}"]
    path.write_text(f"OFF\n{len(grid)} {len(lines) - len(grid)} 0\n" + "\n".join(lines) + "\n", encoding="ascii")


def main(count, folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "edit.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [
        {"region": {"radius": 0.35}, "handles": [{"vertices": str(SIDE * SIDE // 2), "translation": [0, 0, 0.2]}]}]}),
        encoding="ascii")
    for k in range(1, count + 1):
        write(folder / f"mesh-{k:04}.off", k)
    (folder / "jobs.tsv").write_text("".join(f"{folder}/mesh-{k:04}.off\t{folder}/edited-{k:04}.off\t{folder}/edit.json\n"
                                             for k in range(1, count + 1)), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[1].isdigit():
        sys.exit(__doc__)
    main(int(sys.argv[1]), pathlib.Path(sys.argv[2]))
