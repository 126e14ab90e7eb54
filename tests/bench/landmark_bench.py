#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks on a generated head: the program, CGAL's ARAP and SciPy's thin-plate spline; see tests/scripts/landmarks.sh.

usage: landmark_bench.py BUILD [LANDMARKS]
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.interpolate import RBFInterpolator

BUILD = pathlib.Path(sys.argv[1]).resolve()
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 300
NOISE = 0.01  # of the diagonal, root mean square


def smooth(t):
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


def turned(points, weights, axis, degrees, centre):
    """Each point turned by its share of the angle."""
    angle = np.radians(degrees) * weights
    off = points - centre
    along = np.outer(off @ axis, axis) * (1 - np.cos(angle))[:, None]
    return centre + off * np.cos(angle)[:, None] + np.cross(axis, off) * np.sin(angle)[:, None] + along


def opened_jaw(p):
    """About an axis through the ears, from the lips down to the neck."""
    jaw = smooth((-0.46 - p[:, 1]) / 0.08) * smooth((p[:, 2] + 0.1) / 0.5) * smooth((p[:, 1] + 1.25) / 0.3)
    return turned(p, jaw, np.array([1.0, 0, 0]), 15, np.array([0, -0.2, 0.1]))


def raised_brow(p):
    off = (p - [0.33, 0.42, 0.85]) / [1.2, 0.8, 1]
    return p + np.outer(0.18 * np.exp(-(off**2).sum(1) / 0.0625), [0, 1, 0.15])


def turned_head(p):
    """To the side, on the neck."""
    return turned(p, smooth((p[:, 1] + 1.5) / 0.6), np.array([0, 1.0, 0]), 40, np.zeros(3))


def growth(p):
    """All of space, more at the top."""
    return p * (1 + 0.25 * smooth((p[:, 1] + 1.5) / 3))[:, None]


def waves(p):
    """All of space."""
    return p + 0.1 * np.column_stack(
        [np.sin(1.3 * p[:, 1] + 0.2), np.sin(1.1 * p[:, 2] + 0.4 * p[:, 0]), np.sin(1.2 * p[:, 0] + 0.7)])


def read_ply(path):
    """@return vertices, faces; of what the program and make_mesh write"""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + 11
    header = data[:end].decode().splitlines()
    count = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
    if "format ascii 1.0" in header:
        rows = data[end:].decode().splitlines()
        return (np.loadtxt(rows[:count["vertex"]]),
                np.loadtxt(rows[count["vertex"]:count["vertex"] + count["face"]], dtype=int)[:, 1:])
    kinds = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
    of_vertex = "\n".join(header).split("element face")[0].splitlines()
    rows = np.frombuffer(data, [(line.split()[2], kinds[line.split()[1]]) for line in of_vertex
                                if line.startswith("property")], count["vertex"], end)
    return np.column_stack([rows["x"], rows["y"], rows["z"]]).astype(float), None


def spread(points, count):
    """Numbers of points that are far from one another."""
    chosen = [0]
    distance = np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < count:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


class Bench:
    def __init__(self, folder):
        self.folder = folder
        subprocess.run([BUILD / "common/demo/make_mesh", "fine_head", folder / "head.ply"], check=True)
        self.points, self.faces = read_ply(folder / "head.ply")
        self.marks = spread(self.points, COUNT)
        self.diagonal = np.linalg.norm(np.ptp(self.points, axis=0))

    def write_marks(self, name, positions):
        (self.folder / name).write_text("".join(f"p{k},{x:.9g},{y:.9g},{z:.9g}\n" for k, (x, y, z) in enumerate(positions)))

    def ours(self, targets, weight=None):
        """The whole program, files included. @return positions, seconds"""
        self.write_marks("from.csv", self.points[self.marks])
        self.write_marks("to.csv", targets)
        edit = ["--landmarks", "from.csv", "to.csv"]
        if weight is not None:
            step = {"region": {"component": True}, "handles": [{"landmarks": {"from": "from.csv", "to": "to.csv"}}],
                    "method": "linear", "laplacian": "cotangent", "handle_weight": weight}
            (self.folder / "edit.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [step]}))
            edit = ["edit.json"]
        begin = time.perf_counter()
        subprocess.run([BUILD / "filter_laplacian_edit/laplacian-edit", "--quiet", "head.ply", "out.ply", *edit],
                       cwd=self.folder, check=True)
        seconds = time.perf_counter() - begin
        return read_ply(self.folder / "out.ply")[0], seconds

    def arap(self, targets):
        lines = [f"{len(self.points)} {len(self.faces)} {COUNT}"]
        lines += [f"{x!r} {y!r} {z!r}" for x, y, z in self.points.tolist()]
        lines += [f"{a} {b} {c}" for a, b, c in self.faces.tolist()]
        lines += [f"{v} {x!r} {y!r} {z!r}" for v, (x, y, z) in zip(self.marks.tolist(), targets.tolist())]
        done = subprocess.run([BUILD / "tests/bench/landmark_peer"], input="\n".join(lines), check=True, text=True,
                              stdout=subprocess.PIPE)
        seconds, *rows = done.stdout.splitlines()
        return np.loadtxt(rows), float(seconds)

    def spline(self, targets):
        begin = time.perf_counter()
        positions = RBFInterpolator(self.points[self.marks], targets, kernel="thin_plate_spline")(self.points)
        return positions, time.perf_counter() - begin

    def row(self, warp, noise):
        truth = warp(self.points)
        dice = np.random.default_rng(26).normal(size=(COUNT, 3))
        targets = truth[self.marks] + noise * self.diagonal / np.sqrt(3) * dice
        methods = {"ours": lambda: self.ours(targets), "ours 0.1": lambda: self.ours(targets, 0.1),
                   "ARAP": lambda: self.arap(targets), "spline": lambda: self.spline(targets)}
        cells = [warp.__name__.replace("_", " ") + (", noise" if noise else "")]
        for run in methods.values():
            positions, seconds = run()
            size = 100 / self.diagonal
            error = size * np.sqrt(((positions - truth)**2).sum(1).mean())
            residual = size * np.sqrt(((positions[self.marks] - targets)**2).sum(1).mean())
            cells.append(f"{error:.3f}, {residual:.3f}, {seconds:.1f}")
        return cells

    def table(self):
        print(f"{len(self.points)} vertices, {COUNT} landmarks. Error over all vertices and residual of the landmarks, RMS in % of "
              "the diagonal; seconds.\n")
        print("|warp|ours|ours, `handle_weight` 0.1|ARAP|thin-plate spline|\n|---|---|---|---|---|")
        for warp in (opened_jaw, raised_brow, turned_head, growth, waves):
            for noise in (0, NOISE):
                print("|" + "|".join(self.row(warp, noise)) + "|", flush=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="landmarks-") as name:
        Bench(pathlib.Path(name)).table()
