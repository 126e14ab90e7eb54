#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""One picture for each edit that quality_bench --out has written: the methods side by side, with their figures.

Needs an X server (xvfb-run) and the Debian package python3-vtk9.
"""
import argparse
import json
import pathlib
import subprocess

import numpy

RENDER = pathlib.Path(__file__).resolve().parents[2] / "common/demo/render.py"
MOST_BYTES = 200_000
METHODS = ["default", "ARAP", "ARAP100", "SR-ARAP", "libigl", "biharmonic", "Blender", "MeshLab"]


def caption(method, figures):
    if not figures or "failed" in figures:
        return method
    return f"{method}: {100 * figures['rms']:.0f} % / {figures['flipped']} / {figures['pairs']}"


def show(folder, output, figures, methods, height, columns):
    view = json.loads((folder / "view.json").read_text(encoding="utf-8"))
    low, high = numpy.array(view["low"]), numpy.array(view["high"])
    # argparse takes numbers with exponents for options.
    around = [f"{number:.9f}" for number in (*((low + high) / 2), 0.55 * max(high - low))]
    panels = [[folder / "rest.ply", "rest", folder / "classes.txt"]]
    panels += [[folder / f"{method}.ply", caption(method, figures.get(method))] for method in methods
               if (folder / f"{method}.ply").exists()]
    while True:
        command = [RENDER, output, "--toward", *view["toward"], "--up", *view["up"], "--around", *around,
                   "--height", height, "--columns", columns]
        command += [word for panel in panels for word in ("--panel", *panel)]
        subprocess.run(list(map(str, command)), check=True)
        size = output.stat().st_size
        if size < MOST_BYTES:
            return
        height = int(height * min(0.95, (MOST_BYTES / size) ** 0.5))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, help="as given to quality_bench --out")
    parser.add_argument("--json", type=pathlib.Path, help="as given to quality_bench --json, for the captions")
    parser.add_argument("--output", type=pathlib.Path, help="folder of the pictures; by default the same")
    parser.add_argument("--methods", default=",".join(METHODS), help="to be shown beside the rest pose")
    parser.add_argument("--height", type=int, default=210)
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--edits", default="", help="all by default")
    given = parser.parse_args()
    figures = json.loads(given.json.read_text(encoding="utf-8")) if given.json else {}
    output = given.output or given.folder
    output.mkdir(parents=True, exist_ok=True)
    for folder in sorted(path.parent for path in given.folder.glob("*/view.json")):
        if not given.edits or folder.name in given.edits.split(","):
            picture = output / f"{folder.name}.png"
            show(folder, picture, figures.get(folder.name, {}), given.methods.split(","), given.height,
                 given.columns)
            print(picture, flush=True)


if __name__ == "__main__":
    main()
