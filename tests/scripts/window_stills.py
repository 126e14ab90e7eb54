#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of hover, gizmo and handle groups in edit_laplacian_drag/in-the-window.md: called by window_stills.sh.

usage: window_stills.py FOLDER   where the generated meshes are; the pictures are written there
"""
import contextlib
import pathlib
import sys

from pictures import TOOL, Pictures, convert, cut, nearest, part, turned

NOSE, FOOT = (0, -0.13, 1.21), (0.8, -1.29, 0.41)
TIPS = [(-0.5, 1.2, 0.1), (-0.17, 1.44, 0.1), (0.15, 1.5, 0.1), (0.46, 1.33, 0.1)]


@contextlib.contextmanager
def opened(pictures, mesh, matrix=None, **settings):
    """@return the window with the tool, and the pixel of a place of the mesh"""
    with pictures.open(mesh) as window:
        window.resize(1280, 800)
        if matrix:
            window.layer(matrix=matrix)
        window.trigger("Front")
        window.trigger(TOOL)
        for name, value in settings.items():
            window.set(part(name), value)
        points = window.dump().triples()
        yield window, lambda place: window.pixel(nearest(points, place))


def make(pictures):
    folder = pathlib.Path(sys.argv[1]).resolve()

    def keep(window, name, centre):
        path = folder / f"{name}.png"
        cut(window, window.grab(path), centre, 460, 330)
        convert(path, "+dither", "-colors", 200, f"PNG8:{path}")

    with opened(pictures, folder / "head.ply", turned(0, 40)) as (window, at):
        x, y = at(NOSE)
        window.move(x - 8, y)
        keep(window, "hover", (x - 60, y))
    with opened(pictures, folder / "creature.ply", turned(5, -15), radius=1.0, handle_share=25) as (window, at):
        x, y = at(FOOT)
        window.click(x, y)
        window.set(part("gizmo"), True)
        window.move(3, 300)
        keep(window, "gizmo", (x - 20, y - 70))
    with opened(pictures, folder / "hand.ply", radius=1.2, handle_share=14, gizmo=False) as (window, at):
        window.click(*at(TIPS[0]))
        for tip in TIPS[1:]:
            window.key("G")
            window.click(*at(tip))
        x, y = at(TIPS[3])
        window.drag((x, y), (x + 40, y - 30), steps=8, release=False)
        keep(window, "groups", (x - 60, y + 75))
        window.mouse("release", x + 40, y - 30)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    Pictures.screen = "1600x1000"
    Pictures.made_by(make)
