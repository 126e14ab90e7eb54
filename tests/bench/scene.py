# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the mesh of speed_bench: a disc of radius 1, irregular in position and valence, with smooth bumps and ripples a few edges long;
numbered in coherent strips in random order.

usage: scene.py VERTICES FOLDER     writes points (doubles) and faces (ints); needs SciPy
"""
import math
import pathlib
import sys

import numpy as np
from scipy.spatial import Delaunay

BUMPS = [(0.1, 0.2, 0.35, 0.12), (-0.5, 0.3, 0.2, 0.1), (0.4, -0.5, 0.25, -0.08), (-0.3, -0.5, 0.15, 0.07), (0.6, 0.4, 0.2, -0.06),
         (-0.05, -0.1, 0.12, 0.05)]  # x, y, width, height


def disc(count, random):
    """Points near those of a triangular lattice of edge length 1, row by row, and their Delaunay triangles."""
    reach = 2 * int(math.sqrt(count / math.pi)) + 4
    row, column = np.mgrid[-reach:reach + 1, -reach:reach + 1].reshape(2, -1)
    points = np.stack([column + 0.5 * (row % 2) + 0.137, math.sqrt(0.75) * row + 0.071], 1)
    points = points[np.sort(np.argsort(np.linalg.norm(points, axis=1))[:count])]
    angle, way = 2 * np.pi * random.random(count), 0.45 * np.sqrt(random.random(count))
    points += way[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)
    faces = Delaunay(points).simplices
    lengths = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2)
    return points, faces[lengths.max(1) < 2]  # slivers along the hull are longer


def main():
    count, folder = int(sys.argv[1]), pathlib.Path(sys.argv[2])
    random = np.random.default_rng(20040607)
    flat, faces = disc(count, random)
    edge = 1 / np.linalg.norm(flat, axis=1).max()
    flat *= edge
    x, y = flat.T * (2 * np.pi / (6 * edge))
    height = 0.25 * edge * (np.sin(x) * np.cos(0.8 * y) + np.sin(0.45 * (x + y)))
    for *middle, width, top in BUMPS:
        height += top * np.exp(-((flat - middle) ** 2).sum(1) / width**2)
    strips = np.split(np.arange(count), range(256, count, 256))
    order = np.concatenate([strips[k] for k in random.permutation(len(strips))])
    number = np.argsort(order).astype(np.int32)
    faces = number[faces]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "points").write_bytes(np.column_stack([flat, height])[order].tobytes())
    (folder / "faces").write_bytes(faces[np.argsort(faces.min(1), kind="stable")].tobytes())


if __name__ == "__main__":
    main()
