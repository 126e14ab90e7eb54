# SPDX-License-Identifier: GPL-3.0-or-later
"""The edits of quality.py, such as users make, and their meshes: generated creatures, deterministic and outward-facing, real
meshes, and those of the survey of M. Botsch, O. Sorkine, TVCG 2008."""
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.sparse import coo_array

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/cli"), str(ROOT / "tests/compat")]

import ply_meshes  # noqa: E402
from surfaces import X, Y, Z, grid, nearest, rotation, tube as round_tube  # noqa: E402

ORIGIN = np.zeros(3)


# --- Meshes: points and faces ------------------------------------------------------------------------------------------

def read(path):
    """In single precision, as MeshLab reads them."""
    points, faces = ply_meshes.read(path)
    return np.array(points, np.float32).astype(float), np.array(faces, np.int32)


def half_fine_tube():
    """A tube of radius 1 along x from 0 to 16, open at both ends: 16 vertices around up to x = 8, 64 beyond."""
    around, times, rings = 16, 4, 20
    fine, points, faces = times * around, [], []

    def ring(x, count):
        points.extend((x, math.cos(2 * math.pi * k / count), math.sin(2 * math.pi * k / count)) for k in range(count))

    def strip(first, following, count):
        for k in range(count):
            n = (k + 1) % count
            faces.extend([(first + k, following + n, following + k), (first + k, first + n, following + n)])

    for i in range(rings + 1):
        ring(8.0 * i / rings, around)
    for i in range(1, times * rings + 1):
        ring(8 + 8.0 * i / (times * rings), fine)
    for i in range(rings):
        strip(i * around, (i + 1) * around, around)
    coarse, first = rings * around, (rings + 1) * around
    for k in range(around):  # fans from the coarse ring to the fine one
        n, middle = (k + 1) % around, times * k + times // 2
        faces += [(coarse + (k if a < middle else n), first + (a + 1) % fine, first + a) for a in range(times * k, times * (k + 1))]
        faces.append((coarse + k, coarse + n, first + middle))
    for i in range(times * rings - 1):
        strip(first + i * fine, first + (i + 1) * fine, fine)
    return np.array(points), np.array(faces)


def tube_with_relief():
    """Closed, of length 16, with eight rows of bumps that are about as deep as wide."""
    points, faces = round_tube(128, 320, 16)
    angle = np.arctan2(points[:, 2], points[:, 1])
    radius = np.hypot(points[:, 1], points[:, 2]) * (1 + 0.2 * np.cos(8 * angle) * np.cos(8 * points[:, 0]))
    return np.stack([points[:, 0], radius * np.cos(angle), radius * np.sin(angle)], 1), faces


def noise(a, b):
    """A number in [-1, 1] for each pair of integers."""
    mask = 0xFFFFFFFF
    h = (np.asarray(a, np.uint64) * 0x9E3779B1 & mask) ^ (np.asarray(b, np.uint64) * 0x85EBCA77 & mask)
    h = (h ^ (h >> 15)) * 0x2C1B3C6D & mask
    h = (h ^ (h >> 12)) * 0x297A2D39 & mask
    return (h ^ (h >> 15)) / 2147483647.5 - 1


def uneven_face(rows, columns):
    """A face, open at its border: heights with a nose at (0, 0), of vertices that are spaced unevenly and shaken: sizes of
    triangles vary 30 times, many are obtuse."""
    points, faces = grid(rows, columns)
    faces = np.stack(np.split(faces, 2), 1).reshape(-1, 3)  # both of a square one after the other
    i, j = points[:, 0].astype(int), points[:, 1].astype(int)
    t = 2 * (i + np.where(i % (rows - 1), 0.42 * noise(i, j), 0)) / (rows - 1) - 1
    x = 1.5 * (0.25 * t + 0.75 * t * np.abs(t))
    y = 1.5 * (2 * (j + np.where(j % (columns - 1), 0.42 * noise(j + 7919, i), 0)) / (columns - 1) - 1)

    def bump(cx, cy, wx, wy):
        return np.exp(-((x - cx) / wx)**2 - ((y - cy) / wy)**2)

    z = np.sqrt(5 - x * x - y * y) - 1 + 0.45 * bump(0, 0, 0.16, 0.28) + 0.08 * (bump(0, -0.55, 0.35, 0.06) + bump(0, -0.72, 0.3, 0.06))
    z -= 0.15 * (bump(0.42, 0.35, 0.18, 0.12) + bump(-0.42, 0.35, 0.18, 0.12))
    # Either diagonal, so that valences vary, where neither turns a face over; obtuse ones stay.
    q, right, above, over = *faces[::2].T.copy(), faces[1::2, 2].copy()

    def upward(a, b, c):
        return (x[b] - x[a]) * (y[c] - y[a]) > (y[b] - y[a]) * (x[c] - x[a])

    as_it_is = upward(q, right, above) & upward(above, right, over)
    other = upward(q, right, over) & upward(q, over, above) & (~as_it_is | (noise(np.arange(0, len(faces), 2), 31) > 0))
    faces[::2][other] = np.stack([q, right, over], 1)[other]
    faces[1::2][other] = np.stack([q, over, above], 1)[other]
    return np.stack([x, y, z], 1), faces


# --- Bodies: surfaces on which a function of points is zero, negative inside --------------------------------------------

def blend(a, b, k):
    """The smaller one, rounded where they are nearer to each other than k."""
    h = np.maximum(k - np.abs(a - b), 0) / k
    return np.minimum(a, b) - h * h * k / 4


def ball(p, centre, radius):
    return np.linalg.norm(p - centre, axis=1) - radius


def ellipsoid(p, centre, half):
    q, half = p - centre, np.array(half)
    a, b = np.linalg.norm(q / half, axis=1), np.linalg.norm(q / half**2, axis=1)
    return np.where(b > 0, a * (a - 1) / np.where(b > 0, b, 1), -half.min())


def capsule(p, a, b, at_a, at_b):
    a, along = np.array(a), np.subtract(b, a)
    t = np.clip((p - a) @ along / (along @ along), 0, 1)
    return np.linalg.norm(p - a - t[:, None] * along, axis=1) - (at_a + t * (at_b - at_a))


def surface_nets(distance, low, high, cell):
    """One vertex in each cell that the surface passes, one square across each edge of the grid that it cuts."""
    low, high = np.array(low, float), np.array(high, float)
    size = np.ceil((high - low) / cell).astype(int) + 1
    ijk = np.stack(np.meshgrid(*(np.arange(n) for n in size[::-1]), indexing="ij"), -1)[..., ::-1]  # x fastest
    at = low + cell * ijk
    value = distance(at.reshape(-1, 3)).reshape(at.shape[:3])

    def corner(array, c):
        return array[tuple(slice((c >> k) & 1, n - 1 + ((c >> k) & 1)) for k, n in ((2, size[2]), (1, size[1]), (0, size[0])))]

    total, cuts = np.zeros((*(size[::-1] - 1), 3)), np.zeros(size[::-1] - 1, int)
    for a in range(8):
        for axis in range(3):
            b = a | (1 << axis)
            if b != a:
                va, vb = corner(value, a), corner(value, b)
                cut = (va < 0) != (vb < 0)
                part = np.where(cut, va / np.where(cut, va - vb, 1), 0)[..., None]
                total += np.where(cut[..., None], corner(at, a) + part * cell * np.eye(3)[axis], 0)
                cuts += cut
    number = np.full(value.shape, -1)
    passed = cuts > 0
    number[:-1, :-1, :-1][passed] = np.arange(passed.sum())
    points, faces = total[passed] / cuts[passed][:, None], []
    inner = tuple(slice(1, n - 1) for n in size[::-1])
    step = (1, size[0], size[0] * size[1])
    value, number = value.ravel(), number.ravel()
    here = np.arange(value.size).reshape(size[::-1])[inner].ravel()
    for axis in range(3):
        inside = value[here] < 0
        crossed = inside != (value[here + step[axis]] < 0)
        cell_at, u, v = here[crossed], step[(axis + 1) % 3], step[(axis + 2) % 3]
        square = np.stack([number[cell_at], number[cell_at - u], number[cell_at - u - v], number[cell_at - v]], 1)
        square[~inside[crossed]] = square[~inside[crossed]][:, [0, 3, 2, 1]]
        sides = [((points[square[:, k]] - points[square[:, k + 2]])**2).sum(1) for k in (0, 1)]
        square = np.where((sides[0] < sides[1])[:, None], square, np.roll(square, -1, 1))
        faces += [square[:, [0, 1, 2]], square[:, [0, 2, 3]]]
    return points, np.vstack(faces)


def neighbours(count, faces):
    """A sparse matrix of ones."""
    sides = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    sides = np.unique(np.vstack([sides, sides[:, ::-1]]), axis=0)
    sides = sides[sides[:, 0] != sides[:, 1]]
    return coo_array((np.ones(len(sides)), sides.T), shape=(count, count)).tocsr()


def level_set(distance, low, high, cell):
    """Surface nets on a grid of cubic cells, smoothed along the surface: to the mean of the neighbours, and back."""
    points, faces = surface_nets(distance, low, high, cell)
    around, h = neighbours(len(points), faces), 1e-3 * cell
    for _ in range(6):
        points = around @ points / around.sum(1).reshape(-1, 1)
        for _newton in range(2):
            slope = np.stack([(distance(points + h * e) - distance(points - h * e)) / (2 * h) for e in np.eye(3)], 1)
            way = -(distance(points) / np.maximum((slope**2).sum(1), 0.1))[:, None] * slope
            points = points + way * np.minimum(1, cell / np.maximum(np.linalg.norm(way, axis=1), 1e-300))[:, None]
    return points, faces


def mirrored(mesh, gap):
    """The half with x > 0 and its mirror image. Vertices nearer to the plane x = 0 than the gap are put onto it; no face may
    cross it."""
    points, right, left = [], {}, {}
    for v, (x, y, z) in enumerate(mesh[0]):
        if x > -gap:
            right[v] = left[v] = len(points)
            points.append((0 if x < gap else x, y, z))
            if x >= gap:
                left[v] = len(points)
                points.append((-x, y, z))
    faces = []
    for a, b, c in mesh[1]:
        if a in right and b in right and c in right:
            faces += [(right[a], right[b], right[c]), (left[a], left[c], left[b])]
    return np.array(points), np.array(faces)


def head_with_ear(cell):
    """Ball of radius 1 with a thin cupped ear on top, from z = 0.9 to 2.4, 0.1 thick and bent forwards."""
    def distance(p):
        z = p[:, 2] - 1.55
        front = p[:, 0] - 0.35 * p[:, 1]**2 - 0.12 * z * z
        wide = 0.45 * np.where(z < 0, 1, 1 - 0.35 * z / 0.85)
        a, b = np.abs(front) - 0.05 + 0.045, (np.hypot(p[:, 1] / wide, z / 0.85) - 1) * 0.45 + 0.045
        ear = np.minimum(np.maximum(a, b), 0) + np.hypot(np.maximum(a, 0), np.maximum(b, 0)) - 0.045
        return blend(ball(p, ORIGIN, 1), ear, 0.15)
    return level_set(distance, (-1.2, -1.2, -1.2), (1.2, 1.2, 2.6), cell)


def body_with_arm(cell):
    """An arm of length 4 along x with a fist and, at x = 2, where it is 0.6 wide, an elbow, on a body."""
    def distance(p):
        arm = capsule(p, (-0.2, 0, 0), (2, 0, 0), 0.42, 0.3)
        arm = blend(arm, ellipsoid(p, (0.9, 0, 0.12), (0.7, 0.33, 0.36)), 0.2)  # upper arm's muscle
        arm = blend(arm, capsule(p, (2, 0, 0), (3.6, 0, 0), 0.3, 0.2), 0.1)
        arm = blend(arm, ellipsoid(p, (2.5, 0, 0.05), (0.5, 0.28, 0.28)), 0.15)
        arm = blend(arm, ball(p, (3.75, 0, 0), 0.33), 0.15)  # fist
        for k in range(4):  # knuckles
            arm = blend(arm, ball(p, (4.0, 0.18 - 0.12 * k, 0.12), 0.09), 0.05)
        return blend(ellipsoid(p, (-1, 0, 0), (1.0, 0.8, 1.4)), arm, 0.4)
    return level_set(distance, (-2.2, -1, -1.6), (4.3, 1, 1.6), cell)


def bust(cell):
    """Shoulders below z = 0, a neck up to 1.2, a head of radius 0.8 around (0, 0, 1.8) with a snout towards -y."""
    def distance(p):
        d = blend(ellipsoid(p, (0, 0, -0.7), (1.6, 0.7, 0.8)), capsule(p, (0, 0, -0.2), (0, 0, 1.3), 0.45, 0.38), 0.3)
        head = blend(ellipsoid(p, (0, 0, 1.8), (0.65, 0.75, 0.85)), capsule(p, (0, -0.5, 1.6), (0, -1.0, 1.5), 0.3, 0.2), 0.2)
        for side in (-1, 1):
            head = blend(head, ball(p, (0.28 * side, -0.62, 2.0), 0.12), 0.06)  # eyes
            head = blend(head, capsule(p, (0.45 * side, 0.1, 2.3), (0.6 * side, 0.15, 2.85), 0.16, 0.06), 0.1)
        return blend(d, head, 0.2)
    return level_set(distance, (-1.8, -1.4, -1.7), (1.8, 1.1, 3.1), cell)


def body_with_tail(cell):
    """A tail of seven beads that rises behind a body. @return also the vertex of its sting"""
    radii, middles, at = [0.4 - 0.03 * k for k in range(7)], [], np.array((1.1, 0, 0.1))
    for k, radius in enumerate(radii):
        middles.append(at)
        at = at + 1.45 * radius * np.array((math.cos(0.25 + 0.28 * k), 0, math.sin(0.25 + 0.28 * k)))
    tip = at + (-0.45, 0, 0.45)

    def distance(p):
        d = ellipsoid(p, ORIGIN, (1.2, 0.8, 0.5))
        for middle, radius in zip(middles, radii):
            d = blend(d, ellipsoid(p, middle, (radius, 0.9 * radius, radius)), 0.1)
        return blend(d, capsule(p, middles[-1], tip, 0.18, 0.05), 0.08)
    mesh = level_set(distance, (-1.4, -1, -0.7), (4.2, 1, 3.6), cell)
    return mesh, nearest(mesh, tip + (-0.1, 0, 0.1))


def symmetric_figure(cell):
    """A figure that stands and looks to -y, from z = -1.7 to 1.9: its mesh is exactly its own mirror image in x."""
    def distance(q):
        p = np.abs(q) * (1, 0, 0) + q * (0, 1, 1)
        d = blend(ellipsoid(p, (0, 0, 0.45), (0.42, 0.3, 0.65)), capsule(p, (0, 0, 0.9), (0, 0, 1.3), 0.17, 0.14), 0.15)
        d = blend(d, ellipsoid(p, (0, -0.03, 1.55), (0.29, 0.33, 0.36)), 0.1)
        for a, b, at_a, at_b, k in (((0, -0.33, 1.5), (0, -0.42, 1.45), 0.07, 0.06, 0.06), ((0.33, 0, 0.85), (0.72, 0, 0.35), 0.15, 0.12, 0.12),
                                    ((0.72, 0, 0.35), (1.0, -0.08, -0.15), 0.12, 0.09, 0.05), ((1.05, -0.1, -0.25),) * 2 + (0.13, 0.13, 0.05),
                                    ((0.26, 0, 0), (0.32, 0, -1.5), 0.19, 0.12, 0.12), ((0.32, 0, -1.55), (0.35, -0.28, -1.58), 0.13, 0.1, 0.06)):
            d = blend(d, capsule(p, a, b, at_a, at_b) if a != b else ball(p, a, at_a), k)
        return d
    side = (math.ceil(1.3 / cell) + 0.5) * cell  # the middle of a cell is on the plane, so that no square crosses it
    return mirrored(level_set(distance, (-side, -0.7, -1.8), (side, 0.5, 2.1), cell), 0.25 * cell)


def quadruped(cell):
    """An animal that looks to +x, its four hooves below z = -1.6 at x = 0.9 and -0.9, y = 0.32 and -0.32."""
    def distance(q):
        p = np.abs(q) * (0, 1, 0) + q * (1, 0, 1)
        d = ellipsoid(p, ORIGIN, (1.3, 0.5, 0.55))
        for a, b, at_a, at_b, k in (((1.0, 0, 0.2), (1.75, 0, 1.05), 0.3, 0.18, 0.2), ((1.75, 0, 1.1), (2.35, 0, 0.8), 0.22, 0.13, 0.1),
                                    ((1.68, 0.1, 1.25), (1.6, 0.16, 1.5), 0.07, 0.04, 0.05), ((-1.2, 0, 0.3), (-1.75, 0, -0.6), 0.1, 0.06, 0.1)):
            d = blend(d, capsule(p, a, b, at_a, at_b), k)
        for x, back in ((0.85, 0.06), (-0.9, -0.12)):
            d = blend(d, capsule(p, (x, 0.28, -0.1), (x + back, 0.32, -0.85), 0.26, 0.14), 0.15)
            d = blend(d, capsule(p, (x + back, 0.32, -0.85), (x, 0.32, -1.55), 0.14, 0.09), 0.05)
            d = blend(d, ellipsoid(p, (x + 0.05, 0.32, -1.65), (0.15, 0.12, 0.12)), 0.05)
        return d
    return level_set(distance, (-2, -0.8, -1.9), (2.7, 0.8, 1.7), cell)


def demo(name):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([MAKE_MESH, name, f"{folder}/mesh.ply"], check=True)
        return read(pathlib.Path(folder, "mesh.ply"))


MAKE_MESH = MESHES = None  # set by quality.py


# --- Regions, motions, edits -------------------------------------------------------------------------------------------

class Edit:
    """A mesh and a step of the JSON format. spine: a direction, and where the part begins and ends along which the motion is to
    be even; height_field: it encloses nothing; toward, up: for a picture, from the mesh to the eye, upwards"""

    def __init__(self, mesh, region, *handles, toward=(0.35, -0.8, 0.6), up=(0, 0, 1), spine=None, height_field=False):
        self.mesh, self.step = mesh, {"region": region, "handles": list(handles)}
        self.toward, self.up, self.spine, self.height_field = toward, up, spine, height_field


def within(radius):
    return {"radius": radius}


def joint(length, band):
    """A free length around the handle, and behind it a narrow band of anchors."""
    return {"radius": length + band, "padding": band / (length + band)}


COMPONENT = {"component": True}


def map_of(linear, translation):
    return {"matrix": [*np.hstack([linear, np.reshape(translation, (3, 1))]).ravel().tolist(), 0, 0, 0, 1]}


def shift(*way):
    return map_of(np.eye(3), way)


def turn(degrees, axis, centre, along=ORIGIN):
    """Rotated about an axis through a point, then moved."""
    by = rotation(axis, degrees)
    return map_of(by, np.array(centre) + along - by @ np.array(centre))


def arc(degrees, axis, root, along):
    """A limb's end rotated as if the limb, from its root on, became an arc of the same length."""
    a, root, along = math.radians(degrees), np.array(root), np.array(along)
    end = along * (math.sin(a) / a) + np.cross(np.array(axis) / np.linalg.norm(axis), along) * ((1 - math.cos(a)) / a)
    return turn(degrees, axis, root + along, end - along)


def where(condition, motion=None):
    """@param condition  of x, y, z, as arrays"""
    return lambda mesh: {"vertices": np.flatnonzero(condition(*mesh[0].T)).tolist(), **(motion or {})}


def patch(point, radius, motion):
    """All within a distance along the surface; 0: the vertex alone. @param point  or a vertex"""
    def group(mesh):
        vertex = point if isinstance(point, int) else nearest(mesh, point)
        return {**({"within": {"point": mesh[0][vertex].tolist(), "radius": radius}} if radius else {"vertices": [vertex]}), **motion}
    return group


def turned(degrees, axis, *along):
    """About the patch's own middle, then moved."""
    return {"rotation": {"axis": list(axis), "degrees": degrees}, "translation": list(along)}


def edit(mesh, toward, region, *groups, **more):
    return Edit(mesh, region, *(group(mesh) for group in groups), toward=toward, **more)


AT_ARM, AT_EAR, AT_ANIMAL, AT_TUBE, EAR = (0.2, -1, 0.25), (0.9, -0.6, 0.3), (0.4, -1, 0.3), (0.1, -1, 0.15), (0.08, 0, 2.4)
ELBOW, WIDTH = np.array((2, 0, 0)), 0.6
TUBE_BENT, TUBE_TWISTED = arc(90, -Y, (2, 0, 0), (11.5, 0, 0)), turn(120, X, ORIGIN)
ARM_BENT = arc(120, -Y, (0.9, 0, 0), (2.4, 0, 0))
FINGERS = [((-0.4, 0.35, 0), (-0.09, 0.79, 0.08)), ((-0.14, 0.35, 0), (-0.04, 1, 0.1)), ((0.12, 0.35, 0), (0.035, 1.04, 0.1)),
           ((0.36, 0.35, 0), (0.095, 0.94, 0.095))]  # of the hand: roots, and from there to the tips


def limb(motion, mesh="limb"):
    return edit(demo(mesh), (0, -1, 0.2), within(7.5), where(lambda x, y, z: x > 9, motion))


def arm(cell, low, high, region, motion):
    """All of an arm from one x to another is the handle."""
    return edit(body_with_arm(cell), AT_ARM, region, where(lambda x, y, z: (x > low) & (x < high), motion))


def elbow(widths, motion):
    """All beyond a free joint around the elbow moves, all before it is stationary."""
    return arm(0.03, 2 + widths * WIDTH / 2, 9, joint(widths * WIDTH, 0.15), motion)


def scaled(factor):
    return arm(0.03, 1.85, 2.15, within(1), map_of(factor * np.eye(3), (1 - factor) * ELBOW))


def neck(axis):
    """A short neck, rotated about its middle."""
    return edit(bust(0.045), (0.8, -0.7, 0.35), joint(0.55, 0.15), where(lambda x, y, z: z > 1, turn(60, axis, (0, 0, 0.75))))


def tail(group):
    mesh, sting = body_with_tail(0.04)
    return (edit(mesh, (0.1, -1, 0.25), within(3.2), patch(sting, 0.8, turned(-90, Y, -1.8, 0, 0.1))) if group else
            edit(mesh, (0.1, -1, 0.25), within(4.2), patch(sting, 0, shift(-1.2, 1.5, -0.8))))


def standing(cell, motion):
    """Three hooves stand; the left one in front is moved."""
    def hoof(front, left, how=None):
        return where(lambda x, y, z: (z < -1.5) & (front * x > 0) & (left * y > 0), how)
    return edit(quadruped(cell), AT_ANIMAL, COMPONENT, hoof(1, 1, motion), hoof(1, -1), hoof(-1, 1), hoof(-1, -1))


def hoof_pulled_apart():
    """Two groups of one hoof are pulled in opposite directions."""
    made = standing(0.045, shift(0.25, 0, 0.2))
    front = made.step["handles"][0]
    x = made.mesh[0][:, 0]
    made.step["handles"].append({"vertices": [v for v in front["vertices"] if x[v] <= 0.92], **shift(-0.25, 0, 0.2)})
    front["vertices"] = [v for v in front["vertices"] if x[v] > 0.92]
    return made


def twisted_animal():
    return edit(quadruped(0.045), AT_ANIMAL, COMPONENT, where(lambda x, y, z: x > 1.3, turn(70, X, (1.3, 0, 0.1))),
                where(lambda x, y, z: (z < -1.5) & (x < 0)))


def tube(mesh, motion, **more):
    """Held at the left end, moved at the right one."""
    return edit(mesh, AT_TUBE, within(13), where(lambda x, y, z: x > 13.5, motion), **more)


def slender_tube(around, times):
    """Of triangles that are this many times as long as wide."""
    return tube(round_tube(around, round(16 / (times * 2 * math.sin(math.pi / around))) + 1, 16), TUBE_BENT)


def nose(length):
    return edit(uneven_face(201, 101), (0.9, -0.5, 0.4), within(0.9), patch((0, 0, 5**0.5 - 0.55), 0, shift(0.1 * length, 0, length)), up=(0, 1, 0))


def bumpy_grid():
    """The grid of figures that a known angle and height belong to: see test_details_keep_their_orientation."""
    mesh = demo("bumps")
    anchors = np.flatnonzero((mesh[0][:, 0] < 5.5) | (mesh[0][:, 0] > 93.5)).tolist()
    region = {"vertices": f"0-{len(mesh[0]) - 1}", "anchors": {"vertices": anchors, "weights": [1] * len(anchors), "depths": [1] * len(anchors),
                                                               "reach": 50}}
    return edit(mesh, (0.35, -0.8, 0.6), region, where(lambda x, y, z: x == 50, shift(30, 0, 60)), height_field=True)


def bar(left, right, **more):
    """Without anchors, held by its ends."""
    return edit(demo("bar"), (0.2, -1, 0.3), COMPONENT, where(lambda x, y, z: x < 4.5, left), where(lambda x, y, z: x > 55.5, right), **more)


def fist():
    groups = []
    for root, along in map(np.array, FINGERS):
        groups.append(patch(root + 1.1 * along, 0.35 * np.linalg.norm(along), arc(90, -X, root + 0.15 * along, 0.65 * along)))
    return edit(demo("hand"), (0.9, 0.2, -0.5), joint(0.55, 0.1), *groups, up=(0, 1, 0))


def pushed_finger():
    root, along = map(np.array, FINGERS[2])
    return edit(demo("hand"), (0.3, 0.2, 1), joint(0.5, 0.15), patch(root + 1.1 * along, 0.3, shift(*(-0.35 * along / np.linalg.norm(along)))),
                up=(0, 1, 0))


def posed_figure(cell):
    return edit(symmetric_figure(cell), (0.5, -1, 0.2), COMPONENT, where(lambda x, y, z: (z < -1.4) & (x < 0)),
                where(lambda x, y, z: (z < -1.4) & (x > 0)),
                where(lambda x, y, z: (x < -0.9) & (z < 0), turn(-80, X, (-0.33, 0, 0.85))),
                where(lambda x, y, z: (x > 0.9) & (z < 0), turn(-100, Y, (0.33, 0, 0.85))), where(lambda x, y, z: z > 1.35, turn(45, Z, (0, 0, 1.3))))


def bowing_figure():
    return edit(symmetric_figure(0.04), (0.9, -0.6, 0.3), COMPONENT, where(lambda x, y, z: z < -1.4),
                where(lambda x, y, z: z > 1.35, turn(60, X, (0, 0, 0.1))))


def landmarks():
    """Sixty vertices far from each other, the first of which is the highest: the head is rotated above the neck and opens its jaw."""
    def rise(low, high, at):
        t = min(max((at - low) / (high - low), 0), 1)
        return t * t * (3 - 2 * t)

    def moved(p):
        jaw = rise(1.6, 1.4, p[2]) * rise(0.9, 1.1, p[2]) * rise(-0.35, -0.7, p[1])
        opened = applied(turn(20 * jaw, X, (0, -0.2, 1.5)), p)
        return applied(turn(30 * rise(0.2, 1.2, p[2]), Z, ORIGIN), opened)

    mesh, groups = bust(0.055), []
    chosen, away = int(mesh[0][:, 2].argmax()), np.full(len(mesh[0]), np.inf)
    for _ in range(60):
        p = mesh[0][chosen]
        groups.append(patch(chosen, 0, shift(*(moved(p) - p))))
        away = np.minimum(away, ((mesh[0] - p)**2).sum(1))
        chosen = int(away.argmax())
    return edit(mesh, (0.8, -0.7, 0.2), COMPONENT, *groups)


def applied(motion, point):
    matrix = np.reshape(motion["matrix"], (4, 4))
    return matrix[:3, :3] @ point + matrix[:3, 3]


def pulled(file, vertex, radius, motion, toward, up, patch_radius=0):
    return edit(read(MESHES / file), toward, within(radius), patch(vertex, patch_radius, motion), up=up, height_field=file == "bumpy_plane.off")


def survey(name, by_group, toward, **more):
    """The motion and the classes of vertices come with the mesh. @param by_group  holds, and not anchors"""
    mesh = read(MESHES / f"survey/{name}.off")
    matrix, kinds = (np.array([float(word) for line in (MESHES / f"survey/{name}{end}").read_text().splitlines() if not line.startswith("#")
                               for word in line.split()]) for end in (".def", ".sel"))
    held = np.flatnonzero(kinds == 0).tolist()
    grip = {"vertices": np.flatnonzero((kinds != 0) & (kinds != 1)).tolist(), "matrix": [*matrix[:12], 0, 0, 0, 1]}
    return Edit(mesh, {"component": True, **({} if by_group else {"held": held})}, grip, *([{"vertices": held}] if by_group else []), toward=toward,
                **more)


def generated():
    """Kind, name, and a function that makes the edit."""
    kind = "one vertex pulled"
    yield kind, "ear_vertex", lambda: edit(head_with_ear(0.024), AT_EAR, within(1.7), patch(EAR, 0, shift(1.0, 0.2, -0.6)))
    yield kind, "arm_vertex", lambda: edit(body_with_arm(0.04), AT_ARM, within(3.6), patch((4.1, 0, 0), 0, shift(-1.2, 0, 2.2)))
    yield kind, "nose_gently", lambda: nose(0.5)
    yield kind, "nose_far", lambda: nose(1.5)
    yield kind, "tail_vertex", lambda: tail(False)
    yield kind, "letters_sideways", lambda: edit(demo("small_letters"), (0.3, -0.9, 0.75), within(1.8), patch((2.05, 0.9, 0.12), 0, shift(0.8, 0, 1)),
                                                 height_field=True)
    kind = "group turned by more"
    yield kind, "ear_group", lambda: edit(head_with_ear(0.024), AT_EAR, within(1.5), patch(EAR, 0.25, turned(100, Y, 0.85, 0, -0.6)))
    yield kind, "limb_120", lambda: limb(arc(120, -Y, (1.7, 0, 0), (7.3, 0, 0)))
    yield kind, "limb_179", lambda: limb(arc(179, -Y, (1.7, 0, 0), (7.3, 0, 0)))
    yield kind, "limb_twisted", lambda: limb(turn(120, X, (9, 0, 0)))
    yield kind, "arm_120", lambda: arm(0.04, 3.3, 9, within(2.6), ARM_BENT)
    kind = "group turned by at most 90"
    yield kind, "limb_90", lambda: limb(arc(90, -Y, (1.7, 0, 0), (7.3, 0, 0)))
    yield kind, "tail_group", lambda: tail(True)
    yield kind, "neck_nods", lambda: neck(X)
    yield kind, "neck_turns", lambda: neck(Z)
    yield kind, "tube_4", lambda: slender_tube(96, 4)
    yield kind, "tube_12", lambda: slender_tube(160, 12)
    kind = "compression, scaling"
    yield kind, "grid_sideways", bumpy_grid
    yield kind, "compressed_40", lambda: elbow(2, shift(-0.8 * WIDTH, 0, 0))
    yield kind, "compressed_80", lambda: elbow(2, shift(-1.6 * WIDTH, 0, 0))
    yield kind, "finger_pushed", pushed_finger
    yield kind, "scaled_up", lambda: scaled(2)
    yield kind, "scaled_down", lambda: scaled(0.5)
    kind = "several groups, components"
    yield kind, "bar_twisted", lambda: bar(shift(0, 0, 0), turn(90, X, (0, 7, 7)), spine=(X, 4.5, 55.5))
    yield kind, "bar_both_ends", lambda: bar(arc(60, Y, (30, 7, 7), (-25.5, 0, 0)), arc(60, -Y, (30, 7, 7), (25.5, 0, 0)))
    yield kind, "fist", fist
    yield kind, "figure_posed", lambda: posed_figure(0.035)
    yield kind, "figure_bows", bowing_figure
    yield kind, "landmarks_60", landmarks
    for name, widths, degrees in (("half_60", 0.5, 60), ("half_120", 0.5, 120), ("one_90", 1, 90), ("one_120", 1, 120), ("one_150", 1, 150),
                                  ("two_120", 2, 120), ("two_150", 2, 150)):
        yield "elbows", f"elbow_{name}", lambda w=widths, d=degrees: elbow(w, turn(d, -Y, ELBOW))
    yield "standing animals", "hoof_lifted", lambda: standing(0.045, shift(0.5, 0.1, 0.7))
    yield "standing animals", "hoof_pulled_apart", hoof_pulled_apart
    yield "standing animals", "animal_twisted", twisted_animal
    kind = "coarse meshes"
    yield kind, "coarse_hoof", lambda: standing(0.15, shift(0.5, 0.1, 0.7))
    yield kind, "coarse_limb", lambda: limb(arc(90, -Y, (1.7, 0, 0), (7.3, 0, 0)), "coarse_limb")
    yield kind, "coarse_arm", lambda: arm(0.15, 3.3, 9, within(2.6), ARM_BENT)
    yield kind, "coarse_figure", lambda: posed_figure(0.11)
    kind = "half fine meshes"
    yield kind, "half_fine_bent", lambda: tube(half_fine_tube(), TUBE_BENT)
    yield kind, "half_fine_twisted", lambda: tube(half_fine_tube(), TUBE_TWISTED, spine=(X, 2, 13.5))
    yield kind, "half_fine_pulled", lambda: edit(half_fine_tube(), AT_TUBE, within(5), patch((8, 0, 1), 1, shift(0, 0, 2.5)))
    yield "deep relief", "relief_bent", lambda: tube(tube_with_relief(), TUBE_BENT)
    yield "deep relief", "relief_twisted", lambda: tube(tube_with_relief(), TUBE_TWISTED)


def real():
    profile, below, face, side, hill, pull = (0.9, -0.55, 0.15), (0.5, 0.45, -0.9), (0.9, 0.1, 0.6), (0.5, 0.15, 1), (0.3, -0.9, 0.6), -12 / 9.4
    for name, file, vertex, radius, way, toward, up in (
            ("mannequin_nose", "mannequin.off", 8624, 0.6117, (0, pull * 0.6117, 0), profile, Z),
            ("mannequin_face", "mannequin.off", 8624, 1.2155, (0, -1.29, 0), profile, Z),
            ("mannequin_far", "mannequin.off", 8624, 1.2155, (0, pull * 1.2155, 0), profile, Z),
            ("octopus_vertex", "octopus.off", 3175, 0.8, (0, 0.437, 0), below, Y), ("bunny_vertex", "bunny.ply", 23637, 0.06, (0.03, -0.05, 0.03), side, Y),
            ("igea_nose", "igea.ply", 31536, 0.02, (0, 0, 0.02), face, Y), ("igea_face", "igea.ply", 31536, 0.0374, (0, 0.01, 0.03), face, Y),
            ("laurana_nose", "Laurana50k.ply", 25805, 80, (0, 0, 60), face, Y), ("bumps_up", "bumpy_plane.off", 20200, 40, (0, 0, 42.5), hill, Z),
            ("bumps_sideways", "bumpy_plane.off", 20200, 30, (20, 0, 30), hill, Z)):
        yield "one vertex pulled", name, lambda row=(file, vertex, radius, shift(*way), toward, up): pulled(*row)
    kind = "group turned by at most 90"
    yield kind, "octopus_group", lambda: pulled("octopus.off", 3175, 0.8, turned(90, (-0.65, 0, 0.76), 0, 0.3, 0), below, Y, 0.1)
    yield kind, "bunny_group", lambda: pulled("bunny.ply", 23637, 0.06, turned(75, X, 0.015, -0.015, 0.03), side, Y, 0.015)
    yield kind, "mannequin_head", lambda: edit(read(MESHES / "mannequin.off"), (-0.5, -0.8, 0.2), within(0.9),
                                               where(lambda x, y, z: z > -0.62 + 0.35 * y, turn(60, Z, (0, 0.2, 0))))
    for by_group in (False, True):
        for name, toward, more in (("bar", (0.3, -1, 0.1), {"spine": (Z, 30, 95.6)}), ("cylinder", (0.1, -1, 0.1), {}), ("cactus", (1, 0, 0.1), {}),
                                   ("plane", (0.1, -1, 0.2), {"spine": (X, 4.2, 95.8), "height_field": True})):
            yield "survey", f"survey_{name}{'_group' * by_group}", lambda row=(name, by_group, toward), more=more: survey(*row, **more)


def edits():
    """By name: kind, and a function that makes the edit."""
    return {name: (kind, make) for kind, name, make in [*generated(), *(real() if MESHES else [])]}
