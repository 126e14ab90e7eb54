# SPDX-License-Identifier: GPL-3.0-or-later
"""Small generated meshes, and measures on meshes."""
import math


def dome(rows=21, columns=21):
    """A curved sheet over [0, 1] x [0, 1], vertex number columns * i + j; open border."""
    points = []
    for i in range(rows):
        for j in range(columns):
            x, y = i / (rows - 1), j / (columns - 1)
            points.append((x, y, 0.3 * math.sin(math.pi * x) * math.sin(math.pi * y) + 0.01 * ((3 * i + 5 * j) % 7)))
    faces = []
    for i in range(rows - 1):
        for j in range(columns - 1):
            q = columns * i + j
            faces += [(q, q + columns, q + 1), (q + 1, q + columns, q + columns + 1)]
    return points, faces


def with_seam(mesh, at):
    """The mesh with a second vertex at each place on the border between the faces that `at` chooses by their centres and
    the others, as along a seam of texture coordinates. @return mesh, and pairs of vertices at the same place"""
    points, faces = mesh
    chosen = [at(*(sum(points[v][k] for v in face) / 3 for k in range(3))) for face in faces]
    both = ({v for f, c in zip(faces, chosen) if c for v in f} & {v for f, c in zip(faces, chosen) if not c for v in f})
    other = {v: len(points) + k for k, v in enumerate(sorted(both))}
    return ((points + [points[v] for v in sorted(both)],
             [tuple(other.get(v, v) if c else v for v in f) for f, c in zip(faces, chosen)]), sorted(other.items()))


def moved(mesh, scale=1.0, offset=(0, 0, 0)):
    points, faces = mesh
    return [tuple(scale * c + o for c, o in zip(p, offset)) for p in points], faces


def together(a, b):
    """Both meshes in one, the vertices of a first."""
    return a[0] + b[0], a[1] + [tuple(v + len(a[0]) for v in face) for face in b[1]]


def in_reach(points, seed, radius):
    """The vertices no farther from the seed in a straight line, than which no path is shorter: no others are in its region."""
    return {v for v, point in enumerate(points) if math.dist(point, points[seed]) <= radius * (1 + 1e-9)}
