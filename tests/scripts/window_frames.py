#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drags the nose of igea (134,345 vertices) with regions of several sizes: called by window_frames.sh.

usage: window_frames.py MESH [NAME=STAGE...]
       window_frames.py handles   drags handles of several kinds on a generated sheet
Each stage is a version with a name; they take turns, a MeshLab each, and the table has the medians.
"""
import json
import math
import os
import re
import statistics
import subprocess
import sys
import time

from pictures import PANEL, TOOL, Pictures, part

from ply import write_ply
from shapes import dome

NOSE = 31536
RADII = (0.02, 0.0374, 0.1345)  # the last one is all of the mesh, held at the far end
RATE = 60  # moves of the mouse per second
MOVES = 90  # after the first picture
PATIENCE = 120
PARTS = ("solve", "write", "upload", "draw")


class Mouse:
    """Moves to and fro from where it was pressed, RATE times a second."""

    def __init__(self, window, start):
        self.window, self.start, self.moves = window, start, 0
        window.mouse("press", *start)
        self.begin = time.monotonic()

    def move(self):
        self.moves += 1
        time.sleep(max(0.0, self.begin + self.moves / RATE - time.monotonic()))
        self.begin = max(self.begin, time.monotonic() - (self.moves + 1) / RATE)  # none are made up for
        way = 10 + abs((self.moves + 40) % 80 - 40)
        self.position = self.start[0] + 1.5 * way, self.start[1] - way
        self.window.mouse("move", *self.position)


def new_frames(before, after):
    """What has come since; the tool keeps the last hundred."""
    return after[after.index(before[-1]) + 1:] if before and before[-1] in after else after


def follow(window, start):
    """Presses and moves until the surface follows, then on for MOVES more.
    @return  the mouse; seconds from the press to the first moved picture; the frames after it and their seconds"""
    def frames():
        return window.widget(PANEL).get("laplacian_drag_frames", [])

    before = frames()
    pressed = time.monotonic()
    mouse = Mouse(window, start)
    moving = time.monotonic()
    first = []
    while not first:
        if time.monotonic() > pressed + PATIENCE:
            sys.exit("window_frames.py: the surface does not follow")
        mouse.move()
        first = new_frames(before, frames())
    # The tool's clock starts with the first move.
    waited = moving - pressed + first[0]["total"] / 1000
    seen, since = frames(), time.monotonic()
    for _ in range(MOVES):
        mouse.move()
    return mouse, waited, new_frames(seen, frames()), time.monotonic() - since


def measure(window, radius):
    window.trigger(TOOL)
    window.set(part("radius"), radius)
    mouse, waited, frames, seconds = follow(window, window.pixel(NOSE))
    window.idle()
    prepared = float(re.search(r"[Pp]repared in ([\d.]+)", window.widget(part("times"))["text"])[1])
    window.mouse("release", *mouse.position)
    released = time.monotonic()
    window.idle()
    line = [line for line in window.log() if line.startswith(TOOL)][-1]
    settled = time.monotonic() - released
    mouse, again, _, _ = follow(window, window.pixel(NOSE))
    window.mouse("release", *mouse.position)
    window.idle()
    window.press_button(part("reset"))
    window.trigger(TOOL)
    result = {"region": int(re.search(r"region of (\d+)", line)[1]), "prepared": prepared, "first": 1000 * waited,
              "again": 1000 * (settled + again), "rate": len(frames) / seconds,
              "frame": statistics.median(f["total"] for f in frames) if frames else float("nan")}
    result.update({c: statistics.median(f[c] for f in frames) if frames else float("nan") for c in PARTS})
    return result


def at(row, column):
    return SHEET * row + column


def curve(vertices):
    """A curve through these, of which the last is dragged."""
    def choose(window):
        window.set(part("mode"), 1)
        for vertex in vertices:
            window.click(*window.pixel(vertex))
    return choose, vertices[-1]


def groups(vertices, component=False):
    """Handles, of which the last is dragged."""
    def choose(window):
        for number, vertex in enumerate(vertices):
            if number:
                window.key("G")
            window.click(*window.pixel(vertex))
        if component:
            window.set(part("component"), True)
    return choose, vertices[-1]


SHEET = 141  # vertices along a side
HANDLES = {
    "a curve of 40 points, one dragged": curve([at(70, 31 + 2 * k) for k in range(40)]),
    "five groups, one dragged": groups([at(70 + i, 70 + j) for i, j in ((-30, 0), (0, -30), (30, 0), (0, 30), (0, 0))]),
    "two groups, a component without anchors": groups([at(70, 20), at(70, 110)], component=True),
    "a curve of 320 vertices, each with its target": curve(
        [at(i, j) for i, j in ((50, 20), (50, 120), (70, 120), (70, 20), (90, 20), (90, 100))])}


def measure_handles(window):
    print("| handle | its vertices | region vertices | frame | " + " | ".join(PARTS) + " | pictures per second |")
    print("|---|---:|---:|---:|" + "---:|" * (len(PARTS) + 1))
    for name, (choose, vertex) in HANDLES.items():
        window.trigger(TOOL)
        window.set(part("radius"), 0.25)
        choose(window)
        window.set(part("group_statistics"), True)
        handle, *others = map(int, re.findall(r"\d+", window.widget(part("region"))["text"])[:3])
        rates, frames = [], []
        for _ in range(int(os.environ.get("WINDOW_ROUNDS", "3"))):
            mouse, _, found, seconds = follow(window, window.pixel(vertex))
            window.mouse("release", *mouse.position)
            window.idle()
            window.key("Z", modifiers=["ctrl"])
            rates.append(len(found) / seconds)
            frames += found
        cells = [statistics.median(f[c] for f in frames) for c in ("total",) + PARTS]
        print(f"| {name} | {handle} | {handle + sum(others):,} | " + " | ".join(f"{c:.1f}" for c in cells)
              + f" | {statistics.median(rates):.0f} |", flush=True)
        window.trigger(TOOL)
        window.trigger(TOOL)
        window.press_button(part("defaults"))
        window.set(part("clear"), True)
        window.set(part("mode"), 0)
        window.trigger(TOOL)


def one_version(mesh=None):
    """Of the stage in the environment: one JSON object per radius, or the table of handles."""
    def measure_all(pictures):
        points, faces = dome(SHEET, SHEET)
        smooth = [(x, y, 0.3 * math.sin(math.pi * x) * math.sin(math.pi * y)) for x, y, _ in points]
        with pictures.open(mesh or write_ply(pictures.folder / "sheet.ply", smooth, faces)) as window:
            window.resize(1280, 800)
            window.trigger("Front")
            if mesh is None:
                measure_handles(window)
            for radius in RADII if mesh else ():
                print(json.dumps(measure(window, radius)), flush=True)

    Pictures.screen = "1280x900"
    Pictures.made_by(measure_all)


def main():
    mesh, *versions = sys.argv[1:]
    if not versions:
        return one_version(None if mesh == "handles" else mesh)
    rounds = int(os.environ.get("WINDOW_ROUNDS", "3"))
    found = {}  # (radius's number, version) -> results
    for _ in range(rounds):
        for version in versions:
            name, stage = version.split("=", 1)
            done = subprocess.run([sys.executable, __file__, mesh], env=dict(os.environ, LAPEDIT_STAGE=stage), check=True,
                                  stdout=subprocess.PIPE, text=True)
            for k, line in enumerate(done.stdout.splitlines()):
                found.setdefault((k, name), []).append(json.loads(line))
    columns = ("first", "again", "prepared", "frame") + PARTS
    print("| region vertices | version | press to first picture | release to the next | prepare | frame | "
          + " | ".join(PARTS) + " | pictures per second |")
    print("|---" * (len(columns) + 3) + "|")
    for (_, name), results in sorted(found.items(), key=lambda entry: entry[0][0]):
        median = {c: statistics.median(r[c] for r in results) for c in results[0]}
        cells = [f"{int(median['region']):,}", name] + [f"{median[c]:.0f}" if median[c] >= 100 else f"{median[c]:.1f}"
                                                   for c in columns]
        print("| " + " | ".join(cells + [f"{median['rate']:.0f}"]) + " |")
    return None


if __name__ == "__main__":
    main()
