#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the method on curves in the plane, as SVG: the pictures of the idea in common/docs/method.md.

usage: idea.py FOLDER
"""
import pathlib
import sys

import numpy

COUNT, WEIGHT = 121, 10.0  # vertices, and the weight of the constraints
ENDS = numpy.r_[0:9, COUNT - 9:COUNT]  # held, moved
GREY, RED, BLUE, BLACK = "#999999", "#d55e00", "#0072b2", "#000000"


def turn(angle):
    return numpy.array([[numpy.cos(angle), -numpy.sin(angle)], [numpy.sin(angle), numpy.cos(angle)]])


def operator():
    """The umbrella: each vertex minus the mean of its neighbours."""
    m = numpy.eye(COUNT)
    for i in range(COUNT):
        around = [j for j in (i - 1, i + 1) if 0 <= j < COUNT]
        m[i, around] = -1 / len(around)
    return m


M = operator()


def solved(delta, targets):
    """The least-squares solution of M x = delta and, at the ends, WEIGHT x = WEIGHT targets."""
    rows = WEIGHT * numpy.eye(COUNT)[ENDS]
    return numpy.linalg.lstsq(numpy.vstack([M, rows]), numpy.vstack([delta, WEIGHT * targets]), rcond=None)[0]


def averaged(values, rounds):
    for _ in range(rounds):
        padded = numpy.concatenate([values[:1], values, values[-1:]])
        values = (padded[:-2] + padded[1:-1] + padded[2:]) / 3
    return values


def tangents(curve):
    """The angles of the smoothed curve's tangents."""
    along = numpy.gradient(averaged(curve, 150), axis=0)
    return numpy.unwrap(numpy.arctan2(along[:, 1], along[:, 0]))


def fitted(before, after):
    """Per vertex the angle of the rotation that fits its two edges best, averaged as in the method default."""
    p, x = numpy.diff(before, axis=0), numpy.diff(after, axis=0)
    along, across = (p * x).sum(1), p[:, 0] * x[:, 1] - p[:, 1] * x[:, 0]
    sums = [averaged(numpy.r_[0, v] + numpy.r_[v, 0], 8) for v in (along, across)]
    return numpy.unwrap(numpy.arctan2(sums[1], sums[0]))


def rotated_coordinates(before, angles):
    return numpy.array([turn(a) @ d for a, d in zip(angles, M @ before)])


def rotated_edges(before, angles):
    sums = numpy.zeros((COUNT, 2))
    for i, j in numpy.argwhere(M < 0):
        sums[i] -= M[i, j] * (turn(angles[i]) + turn(angles[j])) / 2 @ (before[i] - before[j])
    return sums


class Drawing:
    """Panels of equal size, side by side."""
    WIDTH = 420

    def __init__(self, panels, low, height):
        self.left, self.low, self.height, self.scale = -0.5, low, height, self.WIDTH / 13.5
        self.text = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {panels * self.WIDTH} {self.height + 30}" '
                     'font-family="sans-serif" font-size="15"><rect width="100%" height="100%" fill="white"/>']

    def at(self, panel, point):
        return self.WIDTH * panel + self.scale * (point[0] - self.left), self.height - self.scale * (point[1] - self.low)

    def line(self, panel, points, colour, width=1.5):
        corners = " ".join("{:.1f},{:.1f}".format(*self.at(panel, p)) for p in points)
        self.text.append(f'<polyline points="{corners}" fill="none" stroke="{colour}" stroke-width="{width}"/>')

    def dot(self, panel, point, colour, fill):
        x, y = self.at(panel, point)
        self.text.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{fill}" stroke="{colour}" stroke-width="1.5"/>')

    def arrow(self, panel, start, way):
        tip, side = start + way, turn(numpy.pi / 2) @ way / numpy.linalg.norm(way) * 8 / self.scale
        back = tip - way / numpy.linalg.norm(way) * 11 / self.scale
        self.line(panel, [start, tip], BLACK, 1.8)
        self.line(panel, [back + side / 2, tip, back - side / 2], BLACK, 1.8)

    def words(self, panel, point, words, anchor="start"):
        x, y = self.at(panel, point)
        self.text.append(f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}">{words}</text>')

    def caption(self, panel, words):
        self.text.append(f'<text x="{self.WIDTH * (panel + 0.5):.0f}" y="{self.height + 18}" text-anchor="middle">{words}</text>')

    def write(self, path):
        path.write_text("\n".join(self.text) + "\n</svg>\n")


def bent(before, degrees):
    """Targets of the ends: the first stays, the last moves as if the curve became an arc."""
    angle, length = numpy.radians(degrees), before[-1, 0] - before[0, 0]
    centre = before[-9:].mean(0) * [1, 0]
    moved = numpy.array([numpy.sin(angle), 1 - numpy.cos(angle)]) * 0.93 * length / angle
    return numpy.vstack([before[:9], (before[-9:] - centre) @ turn(angle).T + moved])


def idea(path):
    x = numpy.linspace(0, 12, COUNT)
    before = numpy.stack([x, 0.4 * numpy.maximum(0, numpy.sin(2 * numpy.pi * x / 1.8))], axis=1)
    targets, delta = bent(before, 85), M @ before
    rough = solved(delta, targets)
    angles = tangents(rough) - tangents(before)
    after = solved(rotated_coordinates(before, angles), targets)
    drawing = Drawing(3, -0.7, 270)
    few = numpy.array([[0.5, 1], [2.5, 1.2], [4.5, 2.2], [6.2, 5.6], [8, 2.4], [10, 1.3], [12, 1]])
    drawing.line(0, few, BLUE)
    drawing.line(0, few[[2, 4]], GREY)
    for point in few:
        drawing.dot(0, point, BLUE, BLUE)
    mean = (few[2] + few[4]) / 2
    drawing.dot(0, mean, BLACK, "white")
    drawing.arrow(0, mean, few[3] - mean)
    drawing.words(0, few[3] + [0.4, 0.1], "vertex")
    drawing.words(0, (few[3] + mean) / 2 + [0.25, -0.3], "δ")
    drawing.words(0, mean - [0, 1.7], "mean of the neighbours", "middle")
    drawing.caption(0, "differential coordinate δ of a vertex")
    tops = [i for i in range(15, COUNT - 12) if before[i, 1] > max(before[i - 1, 1], before[i + 1, 1])]
    for panel, curve, colour, angle, words in ((1, rough, RED, 0 * angles, "δ kept: bumps lean"),
                                               (2, after, BLUE, angles, "δ rotated: bumps stand upright")):
        drawing.line(panel, before, GREY)
        drawing.line(panel, curve, colour)
        for i in tops:
            drawing.arrow(panel, curve[i], 0.9 * turn(angle[i]) @ delta[i] / numpy.linalg.norm(delta[i]))
        drawing.caption(panel, words)
    drawing.write(path)


def edges(path):
    x = numpy.linspace(0, 12, COUNT)
    before = numpy.stack([x, 0 * x], axis=1)
    targets = before[ENDS] + numpy.repeat([[0.0, 0.0], [-4.0, 3.0]], len(ENDS) // 2, axis=0)
    whole = solved(M @ before, targets)
    each = whole
    for _ in range(60):
        each = solved(rotated_edges(before, fitted(before, each)), targets)
    drawing = Drawing(2, -1, 160)
    for panel, curve, colour, words in ((0, whole, RED, "coordinates rotated"), (1, each, BLUE, "edges rotated")):
        stretch = numpy.linalg.norm(numpy.diff(curve, axis=0), axis=1) / (x[1] - x[0]) - 1
        drawing.line(panel, before, GREY)
        drawing.line(panel, curve, colour)
        for point in curve[::6]:
            drawing.dot(panel, point, colour, colour)
        drawing.caption(panel, f"{words}: edges become up to {-100 * stretch.min():.0f} % shorter")
    drawing.write(path)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    idea(pathlib.Path(sys.argv[1]) / "method_idea.svg")
    edges(pathlib.Path(sys.argv[1]) / "method_edges.svg")
