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
    """at: position of the handle; way: pixels; away: notches of the wheel, so that nothing is below the line of text."""

    def __init__(self, mesh, at, way, matrix=None, away=0):
        self.mesh, self.at, self.way, self.matrix, self.away = mesh, at, way, matrix, away


SCENES = {
    "nose": Scene("head", (0, -0.13, 1.21), (70, -10), rotated(0, 60)),
    "ear": Scene("head", (1.0, 0.33, -0.1), (75, -55), rotated(0, -25)),
    "horn": Scene("creature", (1.29, 1.93, 0.31), (17, -62), rotated(10, -20), away=1),
    "finger": Scene("hand", (-0.17, 1.44, 0.1), (-48, -36), away=1),
    "leg": Scene("creature", (0.8, -1.29, 0.41), (80, 25), rotated(5, -15)),
    "tail": Scene("creature", (-2.18, 0.58, 0.05), (-30, -100), rotated(5, -15)),
    "peak": Scene("terrain", (1.9, 2.04, 1.1), (0, -90), rotated(-62, 0)),
    "plate": Scene("plate", (79, 1, 2), (20, -110), rotated(-60, 0)),
    "letters": Scene("letters", (2.0, 1.0, 0.12), (10, -80), rotated(-50, 0)),
}


def figures(mesh, edit, work):
    """Of the first step, replayed by the program."""
    report = work / "report.json"
    subprocess.run([os.environ["LAPEDIT_COMMAND"], mesh, work / f"out{mesh.suffix}", edit, "--report", report, "--quality",
                    "-q"], check=True)
    return json.loads(report.read_text())["outputs"][0]["steps"][0]


def take(pictures, name, scene, folder):
    """@return  the row's picture"""
    mesh = folder / f"{scene.mesh}.ply"
    stages = [folder / f"{name}_{stage}.png" for stage in ("before", "during", "after")]
    with pictures.open(mesh) as window:
        window.resize(1280, 800)
        if scene.matrix:
            window.layer(matrix=scene.matrix)
        window.trigger("Front")
        if scene.away:
            window.wheel(400, 300, scene.away)
        window.trigger(TOOL)
        x, y = window.pixel(nearest(window.dump().triples(), scene.at))
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
    row = folder / f"{name}.png"
    with_caption(stages, caption, row)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, help="where the meshes are; the pictures are written there")
    parser.add_argument("names", nargs="*", default=[*SCENES], help="scenes, all by default")
    given = parser.parse_args()
    folder = given.folder.resolve()
    Pictures.made_by(lambda pictures: sheet([take(pictures, name, SCENES[name], folder) for name in given.names], 3,
                                            folder.with_suffix(".png")))


if __name__ == "__main__":
    main()
