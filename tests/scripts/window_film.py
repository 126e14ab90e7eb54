#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Films a drag in the window in real time: called by window_film.sh with a mesh and the picture to make.

The film begins half a second before the press. From the press on the mouse moves 60 times a second, whether the window
keeps up or not.
"""
import math
import pathlib
import re
import subprocess
import sys
import time

from pictures import PANEL, TOOL, Pictures, nearest, part

RADIUS = 2.15  # nearly to the corners of a field of 4 x 2
SECONDS = 12
RATE = 60  # moves of the mouse per second
PICTURES = 6  # per second, in the film


def drag(window, start):
    """@return  seconds from the press to the first picture of a moved surface, by the tool's clock"""
    def frames():
        return window.widget(PANEL).get("laplacian_drag_frames", [])

    window.mouse("press", *start)
    begin, waited, position = time.monotonic(), None, start
    while time.monotonic() < begin + SECONDS:
        t = (time.monotonic() - begin) / SECONDS
        position = start[0] + 60 * math.sin(4 * math.pi * t), start[1] - 120 * (1 - math.cos(2 * math.pi * t)) / 2 - 20
        window.mouse("move", *position)
        if waited is None and frames():
            waited = time.monotonic() - begin
        time.sleep(1 / RATE)
    window.mouse("release", *position)
    return waited


def film(pictures, mesh, raw):
    with pictures.open(mesh) as window:
        window.resize(1280, 800)
        window.layer(matrix=[1, 0, 0, 0, 0, 0.5, 0.87, 0, 0, -0.87, 0.5, 0, 0, 0, 0, 1])
        window.trigger("Front")
        window.trigger(TOOL)
        window.set(part("radius"), RADIUS)
        start = window.pixel(nearest(window.dump().triples(), (2, 1, 0)))
        camera = subprocess.Popen(
            ["ffmpeg", "-y", "-loglevel", "error", "-f", "x11grab", "-framerate", str(PICTURES), "-video_size", "1280x800",
             "-i", window.environment["DISPLAY"], "-c:v", "ffv1", str(raw)], stdin=subprocess.PIPE)
        time.sleep(0.5)
        waited = drag(window, start)
        camera.communicate(b"q")
        window.idle()
        print([line for line in window.log() if line.startswith(TOOL)][-1])
        print(f"first picture of a moved surface after {waited:.1f} s")
        print(re.sub(r"\s+", " ", window.widget(part("times"))["text"]))


def main():
    mesh, picture = sys.argv[1:]
    raw = pathlib.Path(picture).with_suffix(".mkv")
    Pictures.made_by(lambda pictures: film(pictures, mesh, raw))
    subprocess.run(["ffmpeg", "-y", "-loglevel", "error", "-i", str(raw), "-vf",
                    f"crop=862:766:0:0,scale=480:-1,fps={PICTURES},split[a][b];[a]palettegen=max_colors=64[p];[b][p]paletteuse"
                    "=dither=none", picture], check=True)
    raw.unlink()


if __name__ == "__main__":
    main()
