#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A newcomer's first drag, with untouched defaults, on nine meshes: called by first_drag.sh."""
import argparse
import json
import os
import pathlib
import subprocess
import time

from pictures import TOOL, Pictures, cut, nearest, part, rotated, sheet, with_caption

SIDE = 330  # pixels of a picture


class Scene:
    """at: of the generated meshes a position, of real ones a vertex; way: pixels; away: notches of the wheel, so that
    nothing is below the line of text."""

    def __init__(self, mesh, at, way, matrix=None, view="Front", away=0):
        self.mesh, self.at, self.way, self.matrix, self.view, self.away = mesh, at, way, matrix, view, away


GENERATED = {
    "nose": Scene("head.ply", (0, -0.13, 1.21), (70, -10), rotated(0, 60)),
    "ear": Scene("head.ply", (1.0, 0.33, -0.1), (75, -55), rotated(0, -25)),
    "horn": Scene("creature.ply", (1.29, 1.93, 0.31), (17, -62), rotated(10, -20), away=1),
    "finger": Scene("hand.ply", (-0.17, 1.44, 0.1), (-48, -36), away=1),
    "leg": Scene("creature.ply", (0.8, -1.29, 0.41), (80, 25), rotated(5, -15)),
    "tail": Scene("creature.ply", (-2.18, 0.58, 0.05), (-30, -100), rotated(5, -15)),
    "peak": Scene("terrain.ply", (1.9, 2.04, 1.1), (0, -90), rotated(-62, 0)),
    "plate": Scene("plate.ply", (79, 1, 2), (20, -110), rotated(-60, 0)),
    "letters": Scene("letters.ply", (2.0, 1.0, 0.12), (10, -80), rotated(-50, 0)),
}
REAL = {
    "nose (mannequin)": Scene("mannequin.off", 8624, (100, 15), view="Left (Z is up)"),
    "tentacle (octopus)": Scene("octopus.off", 3175, (30, -110), view="Front (Z is up)"),
    "ear (bunny)": Scene("bunny.ply", 23637, (50, -58), away=1),
    "nose (igea)": Scene("igea.ply", 31536, (80, 10), view="Left"),
    "nose (Laurana)": Scene("Laurana50k.ply", 25805, (60, 10), rotated(0, 50)),
    "crown (mannequin)": Scene("mannequin.off", 2482, (-25, -75), view="Left (Z is up)", away=1),
    "bump (plane)": Scene("bumpy_plane.off", 20200, (0, -90), rotated(-60, 0)),
    "knot": Scene("texturedknot.ply", 0, (50, -70)),
    "tooth (scan)": Scene("busted.STL", None, (25, -58), away=1),
}


def figures(mesh, edit, work):
    """Of the first step, replayed by the program."""
    report = work / "report.json"
    subprocess.run([os.environ["LAPEDIT_COMMAND"], mesh, work / f"out{mesh.suffix}", edit, "--report", report, "--quality",
                    "-q"], check=True)
    return json.loads(report.read_text())["outputs"][0]["steps"][0]


def take(pictures, name, scene, folder, output):
    """@return  the row's picture, its figures"""
    mesh = (folder / scene.mesh).resolve()
    base = output / "first_drag" / name.replace(" ", "_").strip("()").replace("(", "")
    stages = [base.with_name(f"{base.name}_{stage}.png") for stage in ("before", "during", "after")]
    with pictures.open(mesh) as window:
        window.resize(1280, 800)
        if scene.matrix:
            window.layer(matrix=scene.matrix)
        window.trigger(scene.view)
        if scene.away:
            window.wheel(400, 300, scene.away)
        window.trigger(TOOL)
        points = window.dump().triples()
        handle = (scene.at if isinstance(scene.at, int) else max(range(len(points)), key=lambda v: points[v][1])
                  if scene.at is None else nearest(points, scene.at))
        x, y = window.pixel(handle)
        middle = x + scene.way[0] / 2, y + scene.way[1] / 2
        window.move(x, y)
        time.sleep(0.5)  # what a press would take is shown when the search for it is ready
        window.idle()
        cut(window, window.grab(stages[0]), middle, SIDE, SIDE)
        window.drag((x, y), (x + scene.way[0], y + scene.way[1]), steps=12, release=False)
        cut(window, window.grab(stages[1]), middle, SIDE, SIDE)
        window.mouse("release", x + scene.way[0], y + scene.way[1])
        window.idle()
        window.set(part("clear"), True)  # nothing over what is to be looked at
        window.move(3, 300)
        cut(window, window.grab(stages[2]), middle, SIDE, SIDE)
        edit = pictures.saved_edit(window)
        found = figures(mesh, edit, pictures.folder)
    caption = (f"{name}: handle {found['handle']:,} of {found['handle'] + found['free']:,}, stretch "
               f"{100 * found['stretch_max']:.0f} %, flipped {found['flipped']}, folded {found['folded']}, crossing {found['new_intersections']}")
    print(caption, flush=True)
    row = base.with_suffix(".png")
    with_caption(stages, caption, row)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--generated", type=pathlib.Path, required=True, help="folder of the generated meshes")
    parser.add_argument("--meshes", type=pathlib.Path, required=True, help="folder of the real ones")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("names", nargs="*", help="scenes, all by default")
    given = parser.parse_args()
    given.output = given.output.resolve()
    (given.output / "first_drag").mkdir(parents=True, exist_ok=True)

    def make(pictures):
        for scenes, folder, name in ((GENERATED, given.generated, "first_drag.png"),
                                     (REAL, given.meshes, "first_drag_real.png")):
            rows = [take(pictures, scene, scenes[scene], folder, given.output) for scene in scenes
                    if (not given.names or scene in given.names) and (folder / scenes[scene].mesh).exists()]
            if rows:
                sheet(rows, 3 if len(rows) > 2 else 1, given.output / name)

    Pictures.made_by(make)


if __name__ == "__main__":
    main()
