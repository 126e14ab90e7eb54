# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits of many kinds whose truth is known: shapes that are nearly symmetric, turned, partial or mirrored scans, wrong
landmarks, sliding sheets, poses. Counts those that are wrong without advice, and right with advice. Run by fit.sh --kinds."""
import collections
import pathlib
import re
import tempfile

import numpy as np

import fit
from surfaces import together


def sphere(count, rng):
    """A sphere of nearly even triangles."""
    from scipy.spatial import ConvexHull
    k = np.arange(count) + 0.5
    z, angle = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    points = np.stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z], 1)
    points = points @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    faces = ConvexHull(points).simplices.astype(np.int32)
    inward = (fit.crosses(points, faces) * points[faces].mean(1)).sum(1) < 0
    faces[inward] = faces[inward][:, ::-1]
    return points, faces


def revolved(p, radius, height):
    around = np.sqrt(np.maximum(np.hypot(p[:, 0], p[:, 2]), 1e-9))
    return np.stack([p[:, 0] / around * radius, height * p[:, 1], p[:, 2] / around * radius], 1)


def vase(p):
    return revolved(p, 0.5 + 0.22 * np.sin(3 * p[:, 1] + 0.6), 1.3)


def limb(p):
    q = revolved(p, 0.28 + 0.1 * np.exp(-((p[:, 1] - 0.35) / 0.35)**2) + 0.06 * p[:, 1], 1.6)
    q[:, 2] += 0.12 * (1 - p[:, 1]**2)
    return q


def bone(p):
    y, angle = p[:, 1], np.arctan2(p[:, 2], p[:, 0])
    return revolved(p, 0.16 + y**4 * (0.2 + 0.04 * (y > 0) + 0.07 * np.cos(2 * angle)), 1.7)


def crown(p):
    q = p / (np.abs(p)**6).sum(1, keepdims=True)**(1 / 6) * [0.95, 0.8, 1]
    q[:, 1] += np.clip(q[:, 1], 0, 1) * 0.25 * np.cos(2.6 * q[:, 0]) * np.cos(2.6 * q[:, 2] + 0.2)
    return q


def socket(p):
    upper = p[:, 1] > 0
    q = p * np.where(upper, 0.8, 1)[:, None]
    q[:, 1] = 0.35 - np.where(upper, 0.95, -1.35) * p[:, 1]
    return q * [1.12, 1, 1]


def torso(p):
    q = revolved(p, 0.62 + 0.12 * np.sin(2.5 * p[:, 1]), 1.15) * [1, 1, 0.6]
    q[:, 0] *= 1 + 0.15 * np.exp(-((p[:, 1] - 0.6) / 0.25)**2)
    q[:, 2] += 0.08 * np.exp(-((p[:, 1] - 0.3) / 0.3)**2) * np.clip(q[:, 2] / 0.2, 0, 1)
    return q


def warp(basis, rng, most):
    """A smooth map of space without a mean displacement, the largest of which is `most` times the size."""
    centre, size = basis.mean(0), fit.size_of(basis)
    waves = [(rng.normal(size=3) * 1.5, rng.uniform(0, 6.3), rng.normal(size=3)) for _ in range(5)]

    def field(points):
        return sum(np.sin((points - centre) / size @ wave + phase)[:, None] * way / np.linalg.norm(way) for wave, phase, way in waves)

    mean = field(basis).mean(0)
    scale = most * size / np.linalg.norm(field(basis) - mean, axis=1).max()
    return lambda points: points + scale * (field(points) - mean)


def rotation(rng, degrees):
    from scipy.spatial.transform import Rotation
    axis = rng.normal(size=3)
    return Rotation.from_rotvec(np.radians(degrees) * axis / np.linalg.norm(axis)).as_matrix()


def cropped(vertices, faces, rng, part):
    height = vertices[faces].mean(1) @ rng.normal(size=3)
    used, index = np.unique(faces[height >= np.quantile(height, 1 - part)], return_inverse=True)
    return vertices[used], index.reshape(-1, 3).astype(np.int32)


def grid(columns, rows, width, height):
    x, y = np.meshgrid(np.linspace(-width, width, columns), np.linspace(-height, height, rows))
    at = np.arange(columns * rows).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
    return np.stack([x.ravel(), y.ravel()], 1), np.vstack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)


def of_bodies(bodies, rng):
    for name, (template, scan) in bodies.items():
        vertices, faces = template
        for degrees in (180, 120):
            bend, turn = warp(vertices, rng, 0.05), rotation(rng, degrees)
            yield "turned", fit.Case(f"{name} turned by {degrees}", *template, bend(vertices) @ turn.T, (bend(scan[0]) @ turn.T, scan[1]))
        for part in (0.5, 0.33):
            bend = warp(vertices, rng, 0.04)
            yield "partial", fit.Case(f"{part} of {name}", *template, bend(vertices), cropped(bend(scan[0]), scan[1], rng, part))
        bend, size = warp(vertices, rng, 0.04), fit.size_of(vertices)
        ball = sphere(1200, rng)
        beside = (vertices.mean(0) + [1.6 * size, 0.2 * size, 0] + 0.5 * size * ball[0], ball[1])
        yield "another object", fit.Case(f"{name} and a ball", *template, bend(vertices), together((bend(scan[0]), scan[1]), beside, 0))
        if name in ("hand", "octopus"):  # the others are nearly their own mirror images
            image = [-1, 1, 1]
            yield "mirrored", fit.Case(f"{name} mirrored", *template, bend(vertices) * image, (bend(scan[0]) * image, scan[1][:, ::-1].copy()))


def of_faces(meshes, rng):
    template, faces = fit.read_obj(meshes / "fit/Template.obj")
    for path in sorted((meshes / "fit").glob("SIMPOP_*.obj")):
        truth, _ = fit.read_obj(path)
        scan, size, picks = fit.scattered(truth, faces, rng), fit.size_of(truth), fit.far_apart(template, 10)
        yield "face", fit.Case(f"{path.stem}", template, faces, truth, scan)
        yield "face", fit.Case(f"{path.stem}, holes", template, faces, truth, fit.harder(*scan, rng, size)[:2])
        for count in (5, 10):
            some = rng.choice(len(template), 5, replace=False) if count == 5 else np.array(picks)
            targets = truth[some] + 0.01 * size * rng.normal(size=(count, 3)) / 3**0.5
            yield "landmarks", fit.Case(f"{path.stem}, {count} landmarks of 1 %", template, faces, truth, scan, landmarks=zip(some.tolist(), targets))
        for kind in ("elsewhere", "off the scan", "exchanged"):
            targets = truth[picks] + 0.003 * size * rng.normal(size=(10, 3))
            wrong, other = rng.choice(10, 2, replace=False)
            away = np.linalg.norm(truth - truth[picks[wrong]], axis=1) / size
            if kind == "elsewhere":
                targets[wrong] = truth[rng.choice(np.flatnonzero((away > 0.15) & (away < 0.3)))]
            elif kind == "off the scan":
                targets[wrong] += size * (0.3 + 0.7 * rng.random()) * rotation(rng, 90)[0]
            else:
                targets[[wrong, other]] = targets[[other, wrong]]
            yield "wrong landmark", fit.Case(f"{path.stem}, {kind}", template, faces, truth, scan, landmarks=zip(picks, targets))


def of_sheets(rng):
    for k in range(6):
        (u, faces), (finer, scan), phase, shift = grid(45, 40, 1, 0.9), grid(71, 66, 1, 0.9), rng.uniform(0, 6), 0.03 + 0.03 * k

        def lifted(x):
            return np.c_[x, 0.05 * np.sin(2 * x[:, 0] + phase) * np.cos(1.5 * x[:, 1])]

        def slid(x):
            return lifted(x + shift * np.stack([np.sin(1.5 * x[:, 1] + phase), np.cos(1.2 * x[:, 0])], 1))
        yield "sliding sheet", fit.Case(f"sheet slid by {shift:.2f}", lifted(u), faces, slid(u), (slid(finer), scan))


def cases(make, meshes, seed):
    rng = np.random.default_rng(seed)
    for shape in (vase, limb, bone, crown, socket, torso):
        (coarse, faces), (fine, scan) = sphere(2000, rng), sphere(4500, rng)
        for most in (0.02, 0.04, 0.06, 0.08):
            bend = warp(shape(coarse), rng, most)
            yield "nearly symmetric", fit.Case(f"{shape.__name__} {most}", shape(coarse), faces, bend(shape(coarse)), (bend(shape(fine)), scan))
    bodies = {"head": (make("head"), make("fine_head"))}
    for name in ("person", "hand", "creature"):
        bodies[name] = make(name), fit.dual(*make(name))
    for name in ("octopus", "mannequin"):
        mesh = fit.read_mesh(meshes / f"{name}.off")
        bodies[name] = mesh, fit.dual(*mesh)
    yield from of_bodies(bodies, rng)
    yield from of_faces(meshes, rng)
    yield from of_sheets(rng)
    person = make("person")
    scan, tips = fit.dual(*person), fit.far_apart(person[0], 8)
    for degrees in (20, 60, 90):
        posed = fit.bent_arm(person[0], degrees)
        for picks in ([], tips):
            yield "pose", fit.Case(f"arm bent by {degrees}, {len(picks)} landmarks", *person, posed, (fit.bent_arm(scan[0], degrees), scan[1]),
                                   mode="pose", landmarks=zip(picks, posed[picks]))
    for number in range(3):
        for case in fit.heads(bodies["head"][0], bodies["head"][1], seed + number):
            yield "head", case


def table(options, make):
    """Prints each case, and a row for each kind: errors before and after in % of the size, and what advice says."""
    kinds = collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as name:
        for kind, case in cases(make, options.meshes, options.kinds):
            if re.search(options.cases, f"{kind}: {case.name}"):
                result, figures = fit.fit_ours(case, options.program, pathlib.Path(name), {})
                errors = [100 * float("nan") if mesh is None else 100 * np.linalg.norm(mesh - case.truth, axis=1).mean() / case.size
                          for mesh in (case.template, result)]
                advice = figures.get("advice", figures.get("error"))
                kinds[kind].append((*errors, bool(advice)))
                print(f"{kind}: {case.name} | {errors[0]:.2f} | {errors[1]:.2f} | {advice}", flush=True)
    print("|Kind|Cases|Before|After|Farther than before|Above 3 %|of these silent|Below 1 %|of these with advice|\n" + "|---" * 9 + "|")
    kinds["all"] = [row for rows in kinds.values() for row in rows]
    for kind, rows in kinds.items():
        wrong, right = [row for row in rows if not row[1] <= 3], [row for row in rows if row[1] < 1]
        print(f"|{kind}|{len(rows)}|{np.mean([row[0] for row in rows]):.2f}|{np.nanmean([row[1] for row in rows]):.2f}|"
              f"{sum(row[1] > row[0] for row in rows)}|{len(wrong)}|{sum(not row[2] for row in wrong)}|{len(right)}|{sum(row[2] for row in right)}|")
