# SPDX-License-Identifier: GPL-3.0-or-later
"""How good an edit's shape is, measured on positions alone, so that every method is measured alike: README.md defines each
figure. Arrays: points n x 3, of the whole mesh before and after; faces m x 3."""
import math

import numpy as np
from scipy.sparse import coo_array, identity

from quality_edits import neighbours
from surfaces import crosses


def polar_rotations(matrices):
    u, _, vt = np.linalg.svd(matrices)
    u[..., 2] *= np.sign(np.linalg.det(u @ vt))[..., None]
    return u @ vt


class Rings:
    """The faces within two rings of each vertex."""

    def __init__(self, count, faces):
        self.faces = faces
        corners = coo_array((np.ones(faces.size), (faces.ravel(), np.repeat(np.arange(len(faces)), 3))), shape=(count, len(faces))).tocsr()
        self.around = neighbours(count, faces)
        self.rings = ((self.around + identity(count, format="csr")) @ corners > 0).astype(float)

    def rotations(self, before, after):
        """For each vertex the rotation that fits its faces and their normals best, by area. Normals make it well defined where the
        surroundings are flat."""
        p, q = before - before.mean(0), after - after.mean(0)
        normals, now = crosses(p, self.faces), crosses(q, self.faces)
        weights = np.linalg.norm(normals, axis=1)
        now /= np.maximum(np.linalg.norm(now, axis=1), 1e-300)[:, None]

        def summed(values):
            return (self.rings @ (values.reshape(len(values), -1))).reshape(-1, *values.shape[1:])

        def spread(a, b):
            """The sum of a b^T over corners about the means, by weights."""
            products = sum(a[self.faces[:, k], :, None] * b[self.faces[:, k], None] for k in range(3)) * (weights / 3)[:, None, None]
            means = [summed(weights[:, None] * x[self.faces].mean(1)) / np.maximum(area, 1e-300)[:, None] for x in (a, b)]
            return summed(products) - area[:, None, None] * means[0][:, :, None] * means[1][:, None]

        area = summed(weights[:, None])[:, 0]
        sizes = [np.maximum(np.trace(spread(x, x), axis1=1, axis2=2), 0) for x in (p, q)]
        size = np.sqrt(sizes[0] * sizes[1])
        scale = np.where(size > 0, area / np.where(size > 0, size, 1), 0)[:, None, None]
        total = summed(now[:, :, None] * normals[:, None]) + scale * spread(q, p)
        return polar_rotations(np.where((area > 0)[:, None, None], total, np.eye(3)))


def area_stretch(faces, before, after):
    """RMS of the logarithms of the principal stretches by area, of their ratios', and the mean of the worst hundredth."""
    e, g = (before[faces[:, k]] - before[faces[:, 0]] for k in (1, 2))
    area, length = np.linalg.norm(np.cross(e, g), axis=1) / 2, np.linalg.norm(e, axis=1)
    good = area > 0
    faces, e, g, area, length = faces[good], e[good], g[good], area[good], length[good][:, None]
    # The metric of the face after, in an orthonormal basis of the face before.
    along, height = (e * g).sum(1)[:, None] / length, 2 * area[:, None] / length
    u = (after[faces[:, 1]] - after[faces[:, 0]]) / length
    v = (after[faces[:, 2]] - after[faces[:, 0]] - along * u) / height
    uu, vv = (u * u).sum(1), (v * v).sum(1)
    middle, radius = (uu + vv) / 2, np.hypot((uu - vv) / 2, (u * v).sum(1))
    large, small = (np.log(np.maximum(x, 1e-12)) / 2 for x in (middle + radius, middle - radius))
    most = np.maximum(np.abs(large), np.abs(small))
    order = np.argsort(-most, kind="stable")
    looked = np.cumsum(area[order])
    worst = order[:int(np.searchsorted(looked, 0.01 * looked[-1])) + 1]
    total = area.sum()
    return {"area_rms": math.sqrt((area * (large**2 + small**2)).sum() / 2 / total), "shear": math.sqrt((area * (large - small)**2).sum() / total),
            "worst": (most * area)[worst].sum() / area[worst].sum()}


def tilt(rings, vertices, before, after):
    """Mean angle in degrees by which details are tilted against the smooth surface below them; each weighs its squared length."""
    def smoothed(points):
        for _ in range(20):
            points = (points + rings.around @ points) / (1 + rings.around.sum(1).reshape(-1, 1))
        return points
    smooth = smoothed(before), smoothed(after)
    old = np.einsum("vij,vj->vi", rings.rotations(*smooth)[vertices], (before - smooth[0])[vertices])
    now, weights = (after - smooth[1])[vertices], (old**2).sum(1)
    angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(old, now), axis=1), (old * now).sum(1)))
    return (weights * angles).sum() / weights.sum() if weights.any() else 0


def evenness(spine, before, after):
    """From twelve slices across a line: the largest difference of a slice's rotation against the one before from their mean, and
    the largest distance of a slice's centroid from the half-turn of its counterpart, over that of the first from the last."""
    along, low, high = spine
    slices = np.floor(12 * (before @ along - low) / (high - low))
    parts = [np.flatnonzero(slices == k) for k in range(12)]
    centres = np.array([after[part].mean(0) for part in parts])
    turns = polar_rotations(np.array([(after[part] - centre).T @ (before[part] - before[part].mean(0)) for part, centre in zip(parts, centres)]))
    angles = np.arccos(np.clip((np.einsum("kij,kij->k", turns[1:], turns[:-1]) - 1) / 2, -1, 1))
    off = centres + centres[::-1] - centres[0] - centres[-1]
    return {"twist": np.abs(angles / angles.mean() - 1).max(), "asymmetry": np.linalg.norm(off, axis=1).max() / np.linalg.norm(centres[-1] - centres[0])}


def volume_change(faces, before, after):
    """Over what the faces enclose before, closed by a fan over their border's centroid; None where they are as good as flat."""
    sides = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ordered, number = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    border = ordered[np.bincount(number.ravel(), np.where(sides[:, 0] < sides[:, 1], 1, -1)) != 0]
    centre = before[border].mean((0, 1)) if len(border) else before[faces[0, 0]]

    def volume(p):
        return (crosses(p, faces) * (p[faces[:, 0]] - centre)).sum() / 6
    rest, area = volume(before), np.linalg.norm(crosses(before, faces), axis=1).sum() / 2
    # A ball has 0.094 of its area to the power of 1.5, a limb as long as 1,600 of its radii a hundredth of that.
    return volume(after) / rest - 1 if abs(rest) > 0.001 * area**1.5 else None


def targets_of(region, before):
    """Handle vertices, and their targets."""
    handles = [(v, group) for v, group in zip(region["vertices"], region["groups"]) if group >= 0]
    maps = np.array(region["maps"]).reshape(-1, 3, 4)
    vertices, groups = map(np.array, zip(*handles))
    return vertices, np.einsum("vij,vj->vi", maps[groups][:, :, :3], before[vertices]) + maps[groups][:, :, 3]


def measure(edit, region, after):
    """All figures of one result; 1 for 100 %. @param region  as quality_bench prints it"""
    before, all_faces = edit.mesh
    vertices = np.array(region["vertices"])
    inside = np.zeros(len(before), bool)
    inside[vertices] = True
    faces, rings = all_faces[inside[all_faces].any(1)], Rings(len(before), all_faces)

    edges = rings.around.tocoo()
    edges = np.stack([edges.row, edges.col], 1)[(edges.row < edges.col) & inside[edges.row] & inside[edges.col]]
    old, now = (np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (before, after))
    stretch = now[old > 0] / old[old > 0] - 1

    turned = polar_rotations(rings.rotations(before, after)[faces].sum(1))
    flipped = np.einsum("fij,fj,fi->f", turned, crosses(before, faces), crosses(after, faces)) < 0

    handles, targets = targets_of(region, before)
    longest = np.linalg.norm(targets - before[handles], axis=1).max()
    others = [(-distance, v) for distance, v, group in zip(region["distances"], region["vertices"], region["groups"]) if group < 0]
    far = [v for _, v in sorted(others)[:max(1, int(0.3 * len(others)))]]
    return {"rms": math.sqrt((stretch**2).mean()), **area_stretch(faces, before, after), "tilt": tilt(rings, vertices, before, after),
            "far": np.linalg.norm(after[far] - before[far], axis=1).mean() / longest,
            **(evenness(edit.spine, before, after) if edit.spine else {"twist": None, "asymmetry": None}), "largest": max(stretch.max(), 0),
            "flipped": int(flipped.sum()), "volume": None if edit.height_field else volume_change(faces, before, after),
            "behind": np.linalg.norm(after[handles] - targets, axis=1).max() / longest}
