#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drags in the real MeshLab window and keeps what it looks like: called by window_pictures.sh.

For each scene three screenshots: <scene>_region.png, <scene>_drag.png and <scene>_result.png; of the generated limb also an
animation, drag.gif.
"""
import argparse
import math
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "gui"))

from gui import GuiTest  # noqa: E402
from tool import TOOL, part  # noqa: E402


class Scene:
    """handle: vertex; way: pixels; view: MeshLab's name; zoom: notches of the wheel."""

    def __init__(self, mesh, handle, radius, way, view="Front", matrix=None, zoom=0, dark=False, group=0.0):
        self.mesh, self.handle, self.radius, self.way, self.view = mesh, handle, radius, way, view
        self.matrix, self.zoom, self.dark, self.group = matrix, zoom, dark, group


SCENES = {
    "mannequin": Scene("mannequin.off", 8624, 1.2155, (110, 20), "Left (Z is up)"),
    "octopus": Scene("octopus.off", 3175, 0.8, (10, -150), "Front (Z is up)"),
    "dark": Scene("octopus.off", 3175, 0.8, (10, -150), "Front (Z is up)", dark=True),
    "coloured": Scene("Laurana50k.ply", 25805, 120, (20, -30), "Front"),
    "textured": Scene("texturedknot.ply", 0, 110, (50, -70), "Front"),
    "igea": Scene("igea.ply", 31536, 0.0374, (90, 20), "Left"),
}
# Turned so that the rings on its underside are seen.
TURNED = [1, 0, 0, 0, 0, -0.82, 0.57, 0, 0, -0.57, -0.82, 0, 0, 0, 0, 1]
GENERATED = Scene("limb.ply", None, 7.5, (-160, -225), "Front", TURNED, zoom=1)


CROP = ["-crop", "862x766+0+0", "+repage"]


class Pictures(GuiTest):
    screen = "1280x800"


def darkened(source, path):
    """The mesh with vertex colours that are nearly black, as PLY."""
    lines = [line for line in source.read_text().split("\n") if line and not line.startswith("#")]
    vertices, faces, _ = map(int, lines[1].split())
    points, corners = lines[2:2 + vertices], lines[2 + vertices:2 + vertices + faces]
    header = ["ply", "format ascii 1.0", f"element vertex {vertices}"]
    header += [f"property float {axis}" for axis in "xyz"] + [f"property uchar {c}" for c in ("red", "green", "blue")]
    header += [f"element face {faces}", "property list uchar int vertex_indices", "end_header"]
    path.write_text("\n".join(header + [f"{point} 18 20 26" for point in points] + corners) + "\n")
    return path


def take(pictures, name, scene, mesh, output, animate=False):
    frames = []
    with pictures.open(mesh) as window:
        window.resize(1280, 800)
        if scene.matrix:
            window.layer(matrix=scene.matrix)
        window.trigger(scene.view)
        if scene.zoom:
            window.wheel(500, 400, scene.zoom)
        window.trigger(TOOL)
        window.set(part("radius"), scene.radius)
        if scene.group:
            window.set(part("handle_radius"), scene.group)
        handle = scene.handle
        if handle is None:
            triples = window.dump().triples()
            handle = max(range(len(triples)), key=lambda v: triples[v][0])
        x, y = window.pixel(handle)
        window.click(x, y)
        window.grab(output / f"{name}_region.png")
        count = 24 if animate else 6

        def frame():
            if animate:
                frames.append(window.grab(output / f"frame{len(frames):03}.png"))

        window.mouse("press", x, y)
        window.idle()
        for i in range(1, count + 1):
            # Slower at the ends, as a hand is.
            t = (1 - math.cos(math.pi * i / count)) / 2
            window.mouse("move", x + t * scene.way[0], y + t * scene.way[1] + 40 * math.sin(math.pi * t) * animate)
            window.idle()
            frame()
        window.grab(output / f"{name}_drag.png")
        window.mouse("release", x + scene.way[0], y + scene.way[1])
        window.idle()
        frame()
        window.grab(output / f"{name}_result.png")
        print(f"{name}: " + [line for line in window.log() if line.startswith(TOOL)][-1])
    if animate:
        subprocess.run(["convert", "-delay", "7", *frames, "-delay", "120", frames[-1], *CROP, "-resize", "640x", "-layers",
                        "OptimizePlus", "+dither", "-colors", "96", "-loop", "0", output / "drag.gif"], check=True)
        for path in frames:
            path.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--limb", type=pathlib.Path, required=True, help="the generated limb")
    parser.add_argument("--meshes", type=pathlib.Path, help="folder of the real meshes")
    parser.add_argument("names", nargs="*", help="scenes, all by default")
    given = parser.parse_args()
    Pictures.setUpClass()
    try:
        pictures = Pictures()
        if not given.names or "limb" in given.names:
            take(pictures, "limb", GENERATED, given.limb, given.output, animate=True)
        for name, scene in SCENES.items():
            if given.meshes is None or (given.names and name not in given.names):
                continue
            mesh = given.meshes / scene.mesh
            if scene.dark:
                mesh = darkened(mesh, given.output / "dark.ply")
            take(pictures, name, scene, mesh, given.output)
    finally:
        Pictures.doClassCleanups()


if __name__ == "__main__":
    main()
