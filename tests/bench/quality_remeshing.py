# SPDX-License-Identifier: GPL-3.0-or-later
"""The same surface, triangulated anew, for quality.py."""
import math

import numpy as np

BEND = 0.8  # least cosine between faces before and after


class Mesh:
    """With a mask for each vertex, in which lists of an edit it is, and numbers. What is between two vertices is in the lists of
    both, and has numbers between theirs."""

    def __init__(self, points, faces, masks, numbers):
        self.points, self.faces, self.made = list(points), [tuple(map(int, face)) for face in faces], {}
        self.masks, self.numbers, self.removed = list(map(int, masks)), list(numbers), np.zeros(len(points), bool)

    def between(self, a, b, fraction=0.5):
        """The vertex at a fraction of an edge, made at the first request."""
        key = min(a, b), max(a, b)
        if key not in self.made:
            self.made[key] = len(self.points)
            self.points.append((1 - fraction) * self.points[a] + fraction * self.points[b])
            self.numbers.append((1 - fraction) * self.numbers[a] + fraction * self.numbers[b])
            self.masks.append(self.masks[a] & self.masks[b])
        return self.made[key]

    def normal(self, face):
        a, b, c = (self.points[v] for v in face)
        n = np.cross(b - a, c - a)
        return n / max(np.linalg.norm(n), 1e-300)

    def result(self):
        """@return points, masks, numbers, faces, and for each vertex of the mesh before its number now, or -1"""
        stays = np.ones(len(self.points), bool)
        stays[:len(self.removed)] = ~self.removed
        now = np.where(stays, np.cumsum(stays) - 1, -1)
        return (*(np.array(rows)[stays] for rows in (self.points, self.masks, self.numbers)), now[np.array(self.faces)], now[:len(self.removed)])


def into_four(mesh, _stays):
    faces = []
    for a, b, c in mesh.faces:
        ab, bc, ca = mesh.between(a, b), mesh.between(b, c), mesh.between(c, a)
        faces += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    mesh.faces = faces


def cut(mesh, _stays):
    """By five planes through points near the middle, in directions that are no axes."""
    low, high = np.min(mesh.points, 0), np.max(mesh.points, 0)
    for plane in range(5):
        angle = 2.4 * plane + 0.3
        normal = np.array((math.cos(angle), math.sin(angle), 0.35 * math.cos(3 * angle)))
        side = list((np.array(mesh.points) - low - (0.35 + 0.07 * plane) * (high - low)) @ normal)
        faces = []
        for face in mesh.faces:
            above = sum(side[v] >= 0 for v in face)
            if above in (0, 3):
                faces.append(face)
                continue
            k = next(k for k in range(3) if (side[face[k]] >= 0) == (above == 1))  # the corner that is alone on its side
            a, b, c = face[k:] + face[:k]
            ab, ca = (mesh.between(min(p, q), max(p, q), side[min(p, q)] / (side[min(p, q)] - side[max(p, q)])) for p, q in ((a, b), (c, a)))
            faces += [(a, ab, ca), (ab, b, c), (ab, c, ca)]
        mesh.faces = faces


def dice(seed):
    """The numbers of std::mt19937."""
    made = np.random.MT19937()
    made._legacy_seeding(seed)
    return lambda: int(made.random_raw())


def flipped(mesh, _stays):
    """A quarter of the edges, where that bends nothing."""
    around = {}
    for f, face in enumerate(mesh.faces):
        for k in range(3):
            around.setdefault(frozenset((face[k], face[k - 2])), []).append(f)
    edges, random = sorted(tuple(sorted(edge)) for edge in around), dice(7)
    for _ in range(len(edges) // 4):
        a, b = edges[random() % len(edges)]
        two = list(around.get(frozenset((a, b)), []))
        if len(two) != 2:
            continue
        first, second = (mesh.faces[f] for f in two)
        start, end = (a, b) if first[(first.index(a) + 1) % 3] == b else (b, a)
        c, at = first[(first.index(end) + 1) % 3], second.index(end)
        d = second[(at + 2) % 3]
        if second[(at + 1) % 3] != start or c == d or around.get(frozenset((c, d))):
            continue
        now = (start, d, c), (d, end, c)
        normal = (mesh.normal(first) + mesh.normal(second)) / 2
        if np.linalg.norm(normal) > BEND and all(normal @ mesh.normal(face) > BEND for face in now):
            for f, face in zip(two, now):
                for k in range(3):
                    around[frozenset((mesh.faces[f][k], mesh.faces[f][k - 2]))].remove(f)
                mesh.faces[f] = face
            for f, face in zip(two, now):
                for k in range(3):
                    around.setdefault(frozenset((face[k], face[k - 2])), []).append(f)


def half_decimated(mesh, stays):
    """Half of the vertices on one side are merged into a neighbour of the same lists, in random order. @param stays  vertices of
    which none is merged"""
    around = [[] for _ in mesh.points]
    for f, face in enumerate(mesh.faces):
        for v in face:
            around[v].append(f)
    low, high = np.min(mesh.points, 0), np.max(mesh.points, 0)
    axis = int((high - low).argmax())
    order, random = [v for v, p in enumerate(mesh.points) if p[axis] > (low + high)[axis] / 2 and v not in stays], dice(11)
    for k in range(len(order), 1, -1):
        other = random() % k
        order[k - 1], order[other] = order[other], order[k - 1]
    left = len(order) // 2

    def ring_of(v):
        return {w for f in around[v] for w in mesh.faces[f]} - {v}

    for v in order:
        ring = ring_of(v)
        if left == 0 or not ring or len(ring) != len(around[v]):  # at a border, or no manifold
            continue
        to = min(sorted(ring), key=lambda w: np.linalg.norm(mesh.points[w] - mesh.points[v]))
        moved = [(f, tuple(to if w == v else w for w in mesh.faces[f])) for f in around[v] if to not in mesh.faces[f]]
        if len(ring & ring_of(to)) != 2 or mesh.masks[v] != mesh.masks[to] or any(mesh.normal(face) @ mesh.normal(mesh.faces[f]) <= BEND for f, face in moved):
            continue
        for f in around[v]:
            if to in mesh.faces[f]:
                for w in mesh.faces[f]:
                    if w != v:
                        around[w].remove(f)
                mesh.faces[f] = None
        for f, face in moved:
            mesh.faces[f] = face
            around[to].append(f)
        around[v], mesh.removed[v] = [], True
        left -= 1
    mesh.faces = [face for face in mesh.faces if face]


KINDS = {"into four": into_four, "cut": cut, "flipped": flipped, "half decimated": half_decimated}
