#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of edit_laplacian_drag/README.md, except the film, in build/window, from the real MeshLab window.

LAPEDIT_STAGE: a private copy of MeshLab with the plugins and the driver of the window's tests; made if it is not given.
"""
import contextlib
import math
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD, FOLDER = ROOT / "build", ROOT / "build/window"
sys.path[:0] = [str(ROOT / "tests/window"), str(ROOT / "tests/cli")]

NOSE, FOOT = (0, -0.13, 1.21), (0.8, -1.29, 0.41)
HAND = (1.0, -0.2, 0.15)  # of the person
DENT, MOUTH = (0.25, 0.85, 0.75), (0, -0.45, 1)  # of the head, about
TIPS = [(-0.5, 1.2, 0.1), (-0.17, 1.44, 0.1), (0.15, 1.5, 0.1), (0.46, 1.33, 0.1)]


def prepare():
    subprocess.run([ROOT / "common/scripts/install_dependencies.sh", "tests"], check=True)
    subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-DLAPEDIT_BUILD_TESTS=ON"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "--parallel", "--target", "edit_laplacian_drag", "filter_laplacian_edit", "gui_driver", "make_mesh"],
                   check=True, stdout=subprocess.DEVNULL)
    FOLDER.mkdir(parents=True, exist_ok=True)
    if "LAPEDIT_STAGE" not in os.environ:
        subprocess.run(["ctest", "--test-dir", BUILD, "-R", "^gui.stage$"], check=True, stdout=subprocess.DEVNULL)
        os.environ["LAPEDIT_STAGE"] = str(BUILD / "tests/window/stage")
    for mesh in ("head", "creature", "hand", "person"):
        subprocess.run([BUILD / "common/demo/make_mesh", mesh, FOLDER / f"{mesh}.ply"], check=True)


prepare()

from ply import Ply, write_ply  # noqa: E402
from tool import TOOL, ToolTest, part  # noqa: E402


class Pictures(ToolTest):
    """Opens windows outside of a test."""
    screen = "1600x1000"

    def __init__(self):
        super().__init__("run")


def rotated(about_x=0.0, about_y=0.0):
    """A layer's matrix: about Y, then about X, in degrees."""
    a, b = math.radians(about_x), math.radians(about_y)
    return [math.cos(b), 0, math.sin(b), 0, math.sin(a) * math.sin(b), math.cos(a), -math.sin(a) * math.cos(b), 0,
            -math.cos(a) * math.sin(b), math.sin(a), math.cos(a) * math.cos(b), 0, 0, 0, 0, 1]


def convert(*arguments):
    subprocess.run(["convert", *map(str, arguments)], check=True)


def cut(window, picture, centre, width, height):
    """Cuts a screenshot to a rectangle of the view, which is moved into it where it would reach beyond."""
    view = window.ask("project")
    left, top = view["corner"]
    x = round(min(max(centre[0] - width / 2, 0), view["width"] - width)) + left
    y = round(min(max(centre[1] - height / 2, 0), view["height"] - height)) + top
    convert(picture, "-crop", f"{width}x{height}+{x}+{y}", "+repage", picture)


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
        yield window, lambda position: window.pixel(min(range(len(points)), key=lambda v: math.dist(points[v], position)))


def worn_heads():
    """Writes a head with a dent and one with an open mouth. @return positions of the first, vertices of the lips"""
    head = Ply(FOLDER / "head.ply")
    points, faces = head.points(), head.faces()
    middle = min(points, key=lambda p: math.dist(p, DENT))
    inwards = [0.12 * math.exp(-(math.dist(p, middle) / 0.14) ** 4) for p in points]
    dented = [[c - by * m / math.hypot(*middle) for c, m in zip(p, middle)] for p, by in zip(points, inwards)]
    write_ply(FOLDER / "dented.ply", dented, faces)

    def is_open(p):
        return p[2] > 0.5 and abs(p[1] - MOUTH[1]) < 0.11 * (1 - (p[0] / 0.3) ** 2)

    kept = [f for f in faces if not all(is_open(points[v]) for v in f)]
    write_ply(FOLDER / "open.ply", points, kept)
    sides = {(f[k], f[k - 2]) for f in kept for k in range(3)}
    return dented, sorted({a for a, b in sides if (b, a) not in sides})


def trials(pictures):
    """Three tasks of a new user, each before and after: a raised arm, a flattened dent, a closed mouth."""
    mesh, rows = FOLDER / "person.ply", ([], [])

    def keep(window, centre, row, size=300):
        path = FOLDER / f"trial{row}{len(rows[row])}.png"
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
    dented, lips = worn_heads()
    with opened(pictures, FOLDER / "dented.ply") as (window, at):
        x, y = at(DENT)
        keep(window, (x, y + 60), 0, 330)
        window.click(x, y)
        window.set(part("detail"), 0)
        window.key("H")
        keep(window, (x, y + 60), 1, 330)
    with opened(pictures, FOLDER / "open.ply") as (window, at):
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
    subprocess.run(["montage", *rows[0], *rows[1], "-tile", "3x", "-geometry", "+2+2", FOLDER / "trials.png"], check=True)
    convert(FOLDER / "trials.png", "+dither", "-colors", 128, f"PNG8:{FOLDER / 'trials.png'}")


def make(pictures):
    def keep(window, name, centre):
        path = FOLDER / f"{name}.png"
        cut(window, window.grab(path), centre, 460, 330)
        convert(path, "+dither", "-colors", 200, f"PNG8:{path}")

    with opened(pictures, FOLDER / "head.ply", rotated(0, 40)) as (window, at):
        x, y = at(NOSE)
        window.move(x - 8, y)
        time.sleep(1)  # the outlines follow from a thread that idle() does not wait for
        keep(window, "hover", (x - 60, y))
    with opened(pictures, FOLDER / "creature.ply", rotated(5, -15), radius=1.0, handle_fraction=25) as (window, at):
        x, y = at(FOOT)
        window.click(x, y)
        window.set(part("gizmo"), 1)
        window.move(3, 300)
        keep(window, "gizmo", (x - 20, y - 70))
    with opened(pictures, FOLDER / "hand.ply", radius=1.2, handle_fraction=28, gizmo=False) as (window, at):
        window.click(*at(TIPS[0]))
        for tip in TIPS[1:]:
            window.key("G")
            window.click(*at(tip))
        x, y = at(TIPS[3])
        window.drag((x, y), (x + 40, y - 30), steps=8, release=False)
        keep(window, "groups", (x - 60, y + 75))
        window.mouse("release", x + 40, y - 30)
    trials(pictures)


if __name__ == "__main__":
    Pictures.setUpClass()
    try:
        make(Pictures())
    finally:
        Pictures.doClassCleanups()
