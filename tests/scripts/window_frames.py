#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drags the nose of igea (134,345 vertices) with regions of several sizes: called by window_frames.sh."""
import pathlib
import re
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "gui"))

from gui import GuiTest  # noqa: E402
from tool import PANEL, TOOL, part  # noqa: E402

NOSE = 31536
FRAMES = 40
COLUMNS = ("total", "solve", "write", "upload", "draw")


class Frames(GuiTest):
    screen = "1280x900"


def measure(window, prepare):
    """@param prepare  chooses handle and region. @return region size, milliseconds to prepare, frames"""
    window.trigger(TOOL)
    prepare()
    x, y = window.pixel(NOSE)
    window.mouse("press", x, y)
    window.idle()
    for i in range(1, FRAMES + 1):
        window.mouse("move", x + 1.5 * i, y - i)
        window.idle()
    frames = window.widget(PANEL)["laplacian_drag_frames"]
    prepared = float(re.search(r"prepared in ([\d.]+)", window.widget(part("times"))["text"])[1])
    window.mouse("release", x + 1.5 * FRAMES, y - FRAMES)
    window.idle()
    line = [line for line in window.log() if line.startswith(TOOL)][-1]
    window.press_button(part("reset"))
    window.trigger(TOOL)
    return int(re.search(r"region of (\d+)", line)[1]), prepared, frames


def main():
    Frames.setUpClass()
    try:
        with Frames().open(sys.argv[1]) as window:
            window.resize(1280, 800)
            window.trigger("Front")

            def grown(radius):
                def prepare():
                    window.set(part("radius"), radius)
                    window.click(*window.pixel(NOSE))

                return prepare

            def whole():
                window.set(part("radius"), 0.02)
                window.click(*window.pixel(NOSE))
                window.press_button(part("component"))

            print("| region vertices | prepare | frame | solve | write | upload | draw | frames per second |")
            print("|---|---|---|---|---|---|---|---|")
            for prepare in (grown(0.02), grown(0.0374), whole):
                size, prepared, frames = measure(window, prepare)
                median = {c: statistics.median(frame[c] for frame in frames) for c in COLUMNS}
                cells = [f"{size:,}", f"{prepared:.0f}"] + [f"{median[c]:.1f}" for c in COLUMNS]
                print("| " + " | ".join(cells + [f"{1000 / median['total']:.0f}"]) + " |")
    finally:
        Frames.doClassCleanups()


if __name__ == "__main__":
    main()
