#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints how long MeshLab's window handles each event of the tool: called by window_frames.sh events.

usage: window_events.py [SIDE]   SIDE: vertices along a side of each of the four sheets, 895 by default
"""
import statistics
import sys

from pictures import TOOL, Pictures, part

from ply import write_ply
from shapes import dome

LAYERS = 4
ROUNDS = 5


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 895
    centre = side * (side // 2) + side // 2
    times = {}

    def timed(window, name, command, **arguments):
        times.setdefault(name, []).append(window.ask(command, **arguments)["milliseconds"])

    def measure(pictures):
        mesh = write_ply(pictures.folder / "sheet.ply", *dome(side, side))
        with pictures.open(*LAYERS * [mesh]) as window:
            window.resize(1280, 800)
            for layer in window.layers()[1:]:
                window.layer(layer["id"], matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 1])
            window.layer(0, current=True)
            window.trigger("Front")
            window.trigger(TOOL)
            window.idle()
            x, y = window.pixel(centre)
            for _ in range(ROUNDS):
                for dx in range(0, 30, 10):
                    timed(window, "hover", "mouse", type="move", x=x + dx, y=y + 3 * dx, button="left", modifiers=[])
                    window.idle()
                for kind, name in (("press", "press on the background"), ("release", "release there")):
                    timed(window, name, "mouse", type=kind, x=5, y=300, button="left", modifiers=[])
                    window.idle()
                timed(window, "press on the mesh", "mouse", type="press", x=x, y=y, button="left", modifiers=[])
                window.idle()
                for k in range(1, 6):
                    timed(window, "first move of a drag" if k == 1 else "move of a drag", "mouse", type="move", x=x + 4 * k,
                          y=y, button="left", modifiers=[])
                    window.seen()
                timed(window, "release of a drag", "mouse", type="release", x=x + 20, y=y, button="left", modifiers=[])
                window.idle()
                for kind, away in (("press", 0), ("move", 5), ("move", 10), ("release", 10)):
                    timed(window, f"brush: {kind}", "mouse", type=kind, x=x + 30 + away, y=y, button="left", modifiers=["ctrl"])
                    window.idle()
                timed(window, "wheel", "wheel", x=x, y=y, delta=120, modifiers=[])
                window.idle()
                window.key("Z", "Z", modifiers=["ctrl"])
                window.set(part("clear"), True)
                window.press_button(part("defaults"))  # the radius is again that of what is pressed
    Pictures.made_by(measure)
    print(f"| event ({LAYERS} layers of {side * side:,} vertices) | median ms | largest ms |\n|---|---:|---:|")
    for name, values in times.items():
        print(f"| {name} | {statistics.median(values):.1f} | {max(values):.1f} |")


if __name__ == "__main__":
    main()
