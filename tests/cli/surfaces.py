# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated surfaces, measures on them, and their files, with NumPy. A mesh is points (n x 3) and faces (m x 3)."""
import math

import numpy as np

X, Y, Z = np.eye(3)


def write(path, points, faces, normals=None):
    """Without faces: a cloud of points with normals."""
    rows = np.zeros(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, np.reshape(faces, (-1, 3))
    names, columns = ("x", "y", "z"), points
    if normals is not None:
        names, columns = (*names, "nx", "ny", "nz"), np.hstack([points, normals])
    header = "".join(f"property double {name}\n" for name in names)
    path.write_bytes(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{header}element face {len(faces)}\nproperty "
                     "list uchar int vertex_indices\nend_header\n".encode() + np.asarray(columns, "<f8").tobytes() + rows.tobytes())


def read(path, count):
    data = path.read_bytes()
    return np.frombuffer(data, "<f8", 3 * count, data.index(b"end_header\n") + 11).reshape(-1, 3)


def rotation(axis, degrees):
    a, k = math.radians(degrees), np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + math.sin(a) * cross + (1 - math.cos(a)) * cross @ cross


def fitted(before, after):
    """The rotation that fits best."""
    u, _, vt = np.linalg.svd((after - after.mean(0)).T @ (before - before.mean(0)))
    return u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt


def degrees_between(a, b):
    return math.degrees(2 * math.asin(min(1, np.linalg.norm(a - b) / math.sqrt(8))))


def grid(rows, columns):
    points = np.stack([*np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"), np.zeros((rows, columns))], 2).reshape(-1, 3)
    q = (columns * np.arange(rows - 1)[:, None] + np.arange(columns - 1)).ravel()
    return points, np.vstack([np.stack([q, q + columns, q + 1], 1), np.stack([q + 1, q + columns, q + columns + 1], 1)])


def ball(levels):
    t = (1 + 5**0.5) / 2
    points = [p / np.linalg.norm(p) for a in (-1, 1) for b in (-t, t) for p in np.array([(0, a, b), (a, b, 0), (b, 0, a)])]
    near = min(np.linalg.norm(points[0] - p) for p in points[1:]) + 1e-9
    faces = [(i, j, k) for i in range(12) for j in range(12) for k in range(12) if i < j and i < k and j != k
             and max(np.linalg.norm(points[a] - points[b]) for a, b in ((i, j), (j, k), (k, i))) < near
             and np.linalg.det([points[i], points[j], points[k]]) > 0]
    for _ in range(levels):
        middles, finer = {}, []
        for face in faces:
            made = []
            for a, b in zip(face, face[1:] + face[:1]):
                key = min(a, b), max(a, b)
                if key not in middles:
                    middles[key] = len(points)
                    points.append((points[a] + points[b]) / np.linalg.norm(points[a] + points[b]))
                made.append(middles[key])
            (a, b, c), (ab, bc, ca) = face, made
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    return np.array(points), np.array(faces)


def tube(around, rings, length, spacing=lambda t: t, closed=True):
    """Of radius 1 along x; with caps, whose middles come last."""
    angle = 2 * np.pi * np.arange(around) / around
    points = [(length * spacing(r / (rings - 1)), math.cos(a), math.sin(a)) for r in range(rings) for a in angle]
    faces = [f for r in range(rings - 1) for a in range(around) for h, n in [(r * around + a, r * around + (a + 1) % around)]
             for f in ((h, n, h + around), (n, n + around, h + around))]
    if closed:
        first, last = len(points), (rings - 1) * around
        points += [(0, 0, 0), (length, 0, 0)]
        faces += [(first, (a + 1) % around, a) for a in range(around)]
        faces += [(first + 1, last + a, last + (a + 1) % around) for a in range(around)]
    return np.array(points, float), np.array(faces)


def together(a, b, offset):
    return np.vstack([a[0], b[0] + offset]), np.vstack([a[1], b[1] + len(a[0])])


def nearest(mesh, point):
    return int(np.linalg.norm(mesh[0] - point, axis=1).argmin())


def near(mesh, point, radius):
    return np.flatnonzero(np.linalg.norm(mesh[0] - point, axis=1) <= radius)


def between(mesh, low, high, inner=0.1):
    """The vertices of a tube's wall with x in a range."""
    return np.flatnonzero((mesh[0][:, 0] > low) & (mesh[0][:, 0] < high) & (np.hypot(*mesh[0][:, 1:].T) > inner))


def normals_of(points, faces):
    """Unit normals of vertices, by area."""
    sums, cross = np.zeros_like(points), crosses(points, faces)
    for k in range(3):
        np.add.at(sums, faces[:, k], cross)
    return sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)[:, None]


def crosses(points, faces):
    """Twice the area, along the normal."""
    a = points[faces[:, 0]]
    return np.cross(points[faces[:, 1]] - a, points[faces[:, 2]] - a)
