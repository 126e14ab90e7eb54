# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts that make pictures of the window share."""
import math
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "gui"))

from tool import TOOL, ToolTest, part  # noqa: E402, F401  (for the scripts, too)


class Pictures(ToolTest):
    """Opens windows outside of a test."""
    screen = "1280x800"

    def __init__(self):
        super().__init__("run")

    @classmethod
    def made_by(cls, make):
        """Calls make(pictures), and cleans up."""
        cls.setUpClass()
        try:
            make(cls())
        finally:
            cls.doClassCleanups()


def rotated(about_x=0.0, about_y=0.0):
    """A layer's matrix: about Y, then about X, in degrees."""
    a, b = math.radians(about_x), math.radians(about_y)
    rows = ((math.cos(b), 0, math.sin(b), 0),
            (math.sin(a) * math.sin(b), math.cos(a), -math.sin(a) * math.cos(b), 0),
            (-math.cos(a) * math.sin(b), math.sin(a), math.cos(a) * math.cos(b), 0), (0, 0, 0, 1))
    return [c for row in rows for c in row]


def nearest(points, position):
    return min(range(len(points)), key=lambda v: math.dist(points[v], position))


def convert(*arguments):
    subprocess.run(["convert", *map(str, arguments)], check=True)


def cut(window, picture, centre, width, height):
    """Cuts a screenshot to a rectangle of the view, which is moved into it where it would reach beyond."""
    view = window.ask("project")
    left, top = view["corner"]
    x = round(min(max(centre[0] - width / 2, 0), view["width"] - width)) + left
    y = round(min(max(centre[1] - height / 2, 0), view["height"] - height)) + top
    convert(picture, "-crop", f"{width}x{height}+{x}+{y}", "+repage", picture)
