#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of edit_laplacian_drag/README.md but the film: called by window_pictures.sh.

usage: window_stills.py FOLDER   where the generated meshes are; the pictures are written there
"""
import contextlib
import math
import pathlib
import subprocess
import sys
import time

from pictures import TOOL, Pictures, convert, cut, nearest, part, rotated
from ply import Ply, write_ply

NOSE, FOOT = (0, -0.13, 1.21), (0.8, -1.29, 0.41)
HAND = (1.0, -0.2, 0.15)  # of the person
DENT, MOUTH = (0.25, 0.85, 0.75), (0, -0.45, 1)  # of the head, about
TIPS = [(-0.5, 1.2, 0.1), (-0.17, 1.44, 0.1), (0.15, 1.5, 0.1), (0.46, 1.33, 0.1)]


@contextlib.contextmanager
def opened(pictures, mesh, matrix=None, **settings):
    """@return the window with the tool, and the pixel of a position of the mesh"""
    with pictures.open(mesh) as window:
        window.resize(1280, 800)
        if matrix:
            window.layer(matrix=matrix)
        window.trigger("Front")
        window.trigger(TOOL)
        for name, value in settings.items():
            window.set(part(name), value)
        points = window.dump().triples()
        yield window, lambda position: window.pixel(nearest(points, position))


def worn_heads(folder):
    """Writes a head with a dent and one with an open mouth. @return positions of the first, vertices of the lips"""
    head = Ply(folder / "head.ply")
    points, faces = head.points(), head.faces()
    middle = points[nearest(points, DENT)]
    inwards = [0.12 * math.exp(-(math.dist(p, middle) / 0.14) ** 4) for p in points]
    dented = [[c - by * m / math.hypot(*middle) for c, m in zip(p, middle)] for p, by in zip(points, inwards)]
    write_ply(folder / "dented.ply", dented, faces)

    def is_open(p):
        return p[2] > 0.5 and abs(p[1] - MOUTH[1]) < 0.11 * (1 - (p[0] / 0.3) ** 2)

    kept = [f for f in faces if not all(is_open(points[v]) for v in f)]
    write_ply(folder / "open.ply", points, kept)
    sides = {(f[k], f[k - 2]) for f in kept for k in range(3)}
    return dented, sorted({a for a, b in sides if (b, a) not in sides})


def trials(pictures, folder):
    """Three tasks of a new user, each before and after: a raised arm, a flattened dent, a closed mouth."""
    mesh, rows = folder / "person.ply", ([], [])

    def keep(window, centre, row, size=300):
        path = folder / f"trial{row}{len(rows[row])}.png"
        window.move(3, 300)
        cut(window, window.grab(path), centre, size, size)
        convert(path, "-resize", "300x300", path)
        rows[row].append(path)

    with opened(pictures, mesh, radius=1.15, handle_fraction=35) as (window, at):
        hand, middle = at(HAND), at((0.45, 0.6, 0))
        window.click(*hand)
        window.set(part("pivot"), 1)
        window.click(*hand)  # shows the gizmo
        keep(window, middle, 0)
        window.move(*hand)
        window.key("R", "7", "0", "Return")
        keep(window, middle, 1)
    dented, lips = worn_heads(folder)
    with opened(pictures, folder / "dented.ply") as (window, at):
        x, y = at(DENT)
        keep(window, (x, y + 60), 0, 330)
        window.click(x, y)
        window.set(part("detail"), 0)
        window.key("H")
        keep(window, (x, y + 60), 1, 330)
    with opened(pictures, folder / "open.ply") as (window, at):
        pixels = [window.pixel(v) for v in lips]
        middle = [sum(p[k] for p in pixels) / len(pixels) for k in (0, 1)]
        keep(window, middle, 0, 430)
        window.set(part("brush_target"), "Handle")
        radii = [16 + max(abs(p[k] - middle[k]) for p in pixels) for k in (0, 1)]
        ring = [[m + r * f(k * math.pi / 12) for m, r, f in zip(middle, radii, (math.cos, math.sin))] for k in range(25)]
        window.mouse("press", *ring[0], modifiers=["ctrl", "alt"])
        for pixel in ring[1:]:
            window.mouse("move", *pixel, modifiers=["ctrl", "alt"])
        window.mouse("release", *ring[0], modifiers=["ctrl", "alt"])
        window.set(part("brush_target"), "Off")
        window.move(*middle)
        window.key("S", "Y", "1", "%", "Return")
        window.key("H")
        keep(window, middle, 1, 430)
    subprocess.run(["montage", *rows[0], *rows[1], "-tile", "3x", "-geometry", "+2+2", folder / "trials.png"], check=True)
    convert(folder / "trials.png", "+dither", "-colors", 128, f"PNG8:{folder / 'trials.png'}")


def make(pictures):
    folder = pathlib.Path(sys.argv[1]).resolve()

    def keep(window, name, centre):
        path = folder / f"{name}.png"
        cut(window, window.grab(path), centre, 460, 330)
        convert(path, "+dither", "-colors", 200, f"PNG8:{path}")

    with opened(pictures, folder / "head.ply", rotated(0, 40)) as (window, at):
        x, y = at(NOSE)
        window.move(x - 8, y)
        time.sleep(1)  # the outlines follow from a thread that idle() does not wait for
        keep(window, "hover", (x - 60, y))
    with opened(pictures, folder / "creature.ply", rotated(5, -15), radius=1.0, handle_fraction=25) as (window, at):
        x, y = at(FOOT)
        window.click(x, y)
        window.set(part("gizmo"), 1)
        window.move(3, 300)
        keep(window, "gizmo", (x - 20, y - 70))
    with opened(pictures, folder / "hand.ply", radius=1.2, handle_fraction=28, gizmo=False) as (window, at):
        window.click(*at(TIPS[0]))
        for tip in TIPS[1:]:
            window.key("G")
            window.click(*at(tip))
        x, y = at(TIPS[3])
        window.drag((x, y), (x + 40, y - 30), steps=8, release=False)
        keep(window, "groups", (x - 60, y + 75))
        window.mouse("release", x + 40, y - 30)
    trials(pictures, folder)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    Pictures.screen = "1600x1000"
    Pictures.made_by(make)
