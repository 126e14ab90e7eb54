#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plays an edit in the window, picture by picture: called by window_pictures.sh.

usage: window_tour.py FOLDER   where person.ply is; tour.gif is written there
"""
import math
import pathlib
import shutil
import sys

from pictures import TOOL, Pictures, convert, nearest, part, rotated

from shapes import neighbours, within

RATE = 8  # pictures per second
WIDTH = 720
HEIGHT = 600  # of the view, without MeshLab's figures below it
OVER_GIZMO = 9  # Qt::SizeAllCursor
HAND, NOSE = (1.0, -0.2, 0.15), (0, 1.39, 0.47)


class Tour:
    """Screenshots with a cursor and a caption, and how long each is seen."""

    def __init__(self, window, folder):
        self.window, self.folder = window, folder
        self.frames = []  # path, hundredths of a second
        self.position = (60, 420)
        self.caption = ""
        view = window.ask("project")
        self.corner = view["corner"]
        panel = window.widget(part("panel"))["rectangle"]
        left = min(panel[0], self.corner[0])
        self.size = self.corner[0] + view["width"] - left, HEIGHT
        self.crop = f"{self.size[0]}x{self.size[1]}+{left}+{self.corner[1]}"
        self.origin = self.corner[0] - left  # of the view in the picture

    def frame(self, seconds=1 / RATE, cursor=True):
        path = self.folder / f"tour{len(self.frames):03}.png"
        self.window.grab(path)
        x, y = self.position[0] + self.origin, self.position[1]
        corners = (0, 0), (0, 22), (5, 17), (9, 26), (13, 24), (9, 16), (16, 16)
        arrow = " ".join(f"{x + a:.0f},{y + b:.0f}" for a, b in corners)
        draw = ["-fill", "white", "-stroke", "black", "-draw", f"polygon {arrow}"] if cursor else []
        convert(path, "-crop", self.crop, "+repage", *draw, "-resize", f"{WIDTH}x", "-stroke", "none", "-gravity",
                "south", "-background", "#202028", "-fill", "white", "-pointsize", 17, "-splice", "0x30", "-annotate",
                "+0+6", self.caption, path)
        self.frames.append((path, round(100 * seconds)))

    def go(self, position, seconds, kind="move", modifiers=()):
        """Moves there smoothly, a picture each time."""
        start, count = self.position, max(1, round(RATE * seconds))
        for k in range(1, count + 1):
            t = (1 - math.cos(math.pi * k / count)) / 2
            self.position = tuple(a + t * (b - a) for a, b in zip(start, position))
            self.window.move(*self.position, modifiers=modifiers)
            self.frame()

    def press(self):
        self.window.mouse("press", *self.position)
        self.window.idle()

    def release(self):
        self.window.mouse("release", *self.position)
        self.window.idle()

    def wheel(self, notches, modifiers=()):
        for _ in range(abs(notches)):
            self.window.wheel(*self.position, math.copysign(1, notches), modifiers)
            self.window.move(*self.position)
            self.frame()

    def write(self, picture):
        arguments = []
        for path, hundredths in self.frames:
            arguments += ["-delay", hundredths, path]
        convert(*arguments, "-layers", "OptimizePlus", "+dither", "-colors", 128, "-loop", 0, picture)
        print(f"{sum(h for _, h in self.frames) / 100:.1f} s, {len(self.frames)} pictures, "
              f"{picture.stat().st_size / 1e6:.2f} MB")


def ring_position(window, centre, angle):
    """Where the gizmo's ring is, outwards from about its centre."""
    way = math.cos(angle), -math.sin(angle)
    found = []
    for pixels in range(50, 105):
        window.move(centre[0] + pixels * way[0], centre[1] + pixels * way[1])
        if window.cursor() == OVER_GIZMO:
            found.append(pixels)
    assert found, "no ring is found"
    middle = sum(found) / len(found)
    return centre[0] + middle * way[0], centre[1] + middle * way[1]


def middle_of_boundary(window, seed):
    """Of the region about a vertex: in pixels."""
    shape = window.dump()
    points = shape.triples()
    around = neighbours(len(points), shape.faces())
    region = within(points, around, seed, window.widget(part("radius"))["value"])
    boundary = [points[v] for v in region if not around[v] <= region]
    return window.project(points=[[sum(c) / len(boundary) for c in zip(*boundary)]])[0]


def raise_arm(tour, window, at):
    tour.caption = "The disc is what a press takes, the outline what follows it."
    tour.frame(0.6)
    tour.go(at(HAND), 1.2)
    tour.frame(0.8)
    tour.caption = "The wheel sets the radius, Shift+wheel the disc."
    tour.wheel(1)
    tour.wheel(4, ["shift"])
    tour.caption = "A click shows the region. The pivot: the middle of its boundary."
    tour.press()
    tour.release()
    window.set(part("gizmo"), "Axes of the view")
    window.set(part("pivot"), "Shoulder (edge)")
    tour.frame(1.6)
    tour.caption = "Drag the ring: the arm is raised in one motion."
    centre = middle_of_boundary(window, nearest(window.dump().triples(), HAND))
    start = ring_position(window, centre, math.radians(-45))
    tour.go(start, 0.8)
    tour.press()
    count = round(2.2 * RATE)
    for k in range(1, count + 1):
        angle = math.radians(-45 + 85 * (1 - math.cos(math.pi * k / count)) / 2)
        radius = math.dist(start, centre)
        tour.position = centre[0] + radius * math.cos(angle), centre[1] - radius * math.sin(angle)
        window.mouse("move", *tour.position)
        window.seen()
        tour.frame()
    tour.release()
    tour.frame(0.8)


def pull_nose(tour, window, at):
    tour.caption = "Press, drag, release."
    window.set(part("gizmo"), "Hidden")
    window.set(part("clear"), True)
    tour.go(at(NOSE), 0.9)
    window.set(part("radius"), 0.35)
    window.set(part("handle_fraction"), 10)
    window.move(*tour.position)
    tour.frame(0.8)
    tour.press()
    tour.go((tour.position[0] - 14, tour.position[1] + 2), 1.4)
    tour.release()
    tour.frame(0.8)


def keep(tour, window, pictures):
    tour.caption = "Undo and redo, exact to the bit."
    for modifiers in (["ctrl"], ["ctrl", "shift"]):
        window.key("Z", modifiers=modifiers)
        tour.frame(1)
    edited = window.dump()
    tour.caption = "Save the edit as JSON ..."
    path = pictures.folder / "edit.json"
    window.press_button(part("save"), wait=False)
    window.wait_dialog()
    tour.frame(1.3, cursor=False)
    window.answer(path=path)
    tour.caption = "... and replay it: on the original mesh ..."
    window.press_button(part("reset"))
    tour.frame(1.2, cursor=False)
    window.press_button(part("load"), wait=False)
    window.answer(path=path)
    window.idle()
    assert edited["positions"] == window.dump()["positions"]
    tour.caption = "... it gives the same coordinates, bit for bit."
    tour.frame(3, cursor=False)


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()

    def make(pictures):
        copy = pathlib.Path(shutil.copy(folder / "person.ply", pictures.folder))  # its folder is shown
        with pictures.open(copy) as window:
            window.resize(1280, 800)
            window.layer(matrix=rotated(0, -25))
            window.trigger("Front")
            window.wheel(400, 300, -1)
            window.close_widget("layerDialog")  # so that the panel is at the left
            window.trigger(TOOL)

            def at(position):
                points = window.dump().triples()
                return window.pixel(nearest(points, position))

            tour = Tour(window, pictures.folder)
            raise_arm(tour, window, at)
            pull_nose(tour, window, at)
            keep(tour, window, pictures)
        tour.write(folder / "tour.gif")

    Pictures.made_by(make)


if __name__ == "__main__":
    main()
