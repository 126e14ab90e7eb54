# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures fits whose truth is known, see fit.sh: errors per vertex (mean, 95 %, largest), folds and processor times."""
import argparse
import json
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/cli"), str(ROOT / "tests/compat")]

import ply_meshes  # noqa: E402
from surfaces import crosses, normals_of, read, write  # noqa: E402


def maker(program, folder):
    """Returns the function that makes the mesh of a name."""
    def make(shape):
        subprocess.run([program, shape, folder / "mesh.ply"], check=True)
        return read_mesh(folder / "mesh.ply")
    return make


def read_mesh(path):
    points, faces = ply_meshes.read(path)
    return np.array(points), np.array(faces, np.int32)


def read_obj(path):
    rows = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    return (np.array([row[1:4] for row in rows if row[:1] == ["v"]], dtype=float),
            np.array([[int(word.split("/")[0]) - 1 for word in row[1:4]] for row in rows if row[:1] == ["f"]], dtype=np.int32))


def size_of(vertices):
    return float(np.sqrt(2 * ((vertices - vertices.mean(0)) ** 2).sum(1).mean()))


def dual(vertices, faces):
    """The surface in another triangulation: its vertices are the centres of the faces."""
    around = {}
    for number, (a, b, c) in enumerate(faces.tolist()):
        for v, first, second in ((a, b, c), (b, c, a), (c, a, b)):
            around.setdefault(v, {})[first] = (second, number)
    made = []
    for ring in around.values():
        start = at = next(iter(ring))
        cycle = []
        while at in ring and len(cycle) <= len(ring):
            at, number = ring[at]
            cycle.append(number)
            if at == start:
                made += [(cycle[0], cycle[k], cycle[k + 1]) for k in range(1, len(cycle) - 1)]
                break
    return vertices[faces].mean(1), np.array(made, dtype=np.int32)


def flattened(vertices, faces):
    """A map of a surface with one border to the unit disc, by mean-value weights. @return also the border, in order"""
    from scipy.sparse import coo_matrix, diags
    from scipy.sparse.linalg import spsolve
    edges = {edge for face in faces.tolist() for edge in zip(face, face[1:] + face[:1])}
    following = {a: b for a, b in edges if (b, a) not in edges}
    border = [min(following)]
    while following[border[-1]] != border[0]:
        border.append(following[border[-1]])
    rows, columns, values = [], [], []
    for k in range(3):
        at, first, second = faces[:, k], faces[:, (k + 1) % 3], faces[:, (k + 2) % 3]
        a, b = vertices[first] - vertices[at], vertices[second] - vertices[at]
        lengths = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
        tangent = np.tan(np.arccos(np.clip((a * b).sum(1) / lengths[0] / lengths[1], -1, 1)) / 2)
        rows += [at, at]
        columns += [first, second]
        values += [tangent / lengths[0], tangent / lengths[1]]
    weights = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    matrix = (diags(np.asarray(weights.sum(1)).ravel()) - weights).tocsr()
    along = np.cumsum(np.linalg.norm(vertices[np.roll(border, -1)] - vertices[border], axis=1))
    angles = 2 * np.pi * along / along[-1]
    flat = np.zeros((len(vertices), 2))
    flat[border] = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    inner = np.setdiff1d(np.arange(len(vertices)), border)
    flat[inner] = spsolve(matrix[inner][:, inner].tocsc(), -(matrix[inner][:, border] @ flat[border]))
    return flat, border


def scattered(vertices, faces, rng):
    """The same surface with about as many vertices at random positions. In the dual, vertices are at the centres of the
    template's faces, to which MeshMonk draws the template's vertices: errors are then the distance of these."""
    from scipy.spatial import Delaunay, cKDTree
    flat, border = flattened(vertices, faces)
    areas, count = np.linalg.norm(crosses(vertices, faces), axis=1), 8 * len(vertices)
    chosen, shares = faces[rng.choice(len(faces), count, p=areas / areas.sum())], rng.dirichlet(np.ones(3), count)[:, :, None]
    points, places = (shares * vertices[chosen]).sum(1), (shares * flat[chosen]).sum(1)
    radius = 0.8 * np.sqrt(areas.sum() / 2 / len(vertices))
    keep = cKDTree(vertices[border]).query(points)[0] > 0.5 * radius
    for k, near in enumerate(cKDTree(points).query_ball_point(points, radius)):
        if keep[k]:
            keep[near] = False
            keep[k] = True
    points, places = np.vstack([vertices[border], points[keep]]), np.vstack([flat[border], places[keep]])
    made = Delaunay(places).simplices
    a, b = places[made[:, 1]] - places[made[:, 0]], places[made[:, 2]] - places[made[:, 0]]
    if (crosses(vertices, faces).sum(0) @ crosses(points, made).sum(0)) < 0:
        made = made[:, ::-1]
    return points, made[np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-9].astype(np.int32)


def cut(vertices, faces, keep):
    faces = faces[keep[faces].all(1)]
    used = np.unique(faces)
    number = np.zeros(len(vertices), int)
    number[used] = np.arange(len(used))
    return vertices[used], number[faces].astype(np.int32)


def harder(vertices, faces, rng, size):
    """Three holes, two cropped sides, and noise. @return also the holes"""
    keep, holes = np.ones(len(vertices), bool), []
    for _ in range(3):
        centre = vertices[rng.integers(len(vertices))]
        holes.append(centre)
        keep &= np.linalg.norm(vertices - centre, axis=1) > 0.12 * size
    for _ in range(2):
        direction = rng.normal(size=3)
        height = vertices @ (direction / np.linalg.norm(direction))
        keep &= height < np.quantile(height, 0.94)
    vertices, faces = cut(vertices, faces, keep)
    noise = 0.003 * size * rng.normal(size=(len(vertices), 1))
    return vertices + noise * normals_of(vertices, faces), faces, holes


def folds(before, after, faces):
    """Faces at edges that were nearly flat and are folded by more than 100 degrees."""
    unit = [n / np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None] for n in
            (crosses(before, faces), crosses(after, faces))]
    edges, bad = {}, set()
    for number, face in enumerate(faces.tolist()):
        for k in range(3):
            edge = tuple(sorted((face[k], face[(k + 1) % 3])))
            other = edges.setdefault(edge, number)
            if other != number and unit[0][other] @ unit[0][number] > 0.5 and unit[1][other] @ unit[1][number] < -0.17:
                bad |= {other, number}
    return len(bad)


def warped(points, basis, number):
    """A smooth random map of space, of wavelengths of about the size of the basis: the same for any points."""
    rng = np.random.default_rng(number)
    centre, size = basis.mean(0), size_of(basis)
    local = (points - centre) / size
    moved = local.copy()
    for _ in range(6):
        wave, phase, way = rng.normal(size=3) * 1.6, rng.uniform(0, 6.3), rng.normal(size=3)
        moved += 0.04 * np.sin(local @ wave + phase)[:, None] * way / np.linalg.norm(way)
    return moved * size + centre


class Case:
    def __init__(self, name, template, faces, truth, scan, mode="shape", landmarks=(), holes=(), normals=None, align=None):
        self.name, self.template, self.faces, self.truth = name, template, faces, truth
        self.scan, self.mode, self.landmarks, self.holes = scan, mode, list(landmarks), list(holes)
        self.normals, self.align, self.size = normals, align, size_of(truth)


def far_apart(points, count):
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(0), axis=1)))]
    distance = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < count:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen


def bent_arm(points, degrees):
    """Bends the arm of the generated person at x > 0 outwards at its elbow, over which the rotation blends."""
    pivot, turn, way = np.array([0.66, 0.34, 0.0]), np.radians(degrees), np.array([0.52, -0.854, 0.0])
    along, beside = (points - pivot) @ way, (points - pivot) @ np.array([0.854, 0.52, 0.0])
    arm = np.clip((along + 0.1) / 0.25, 0, 1) * (beside > -0.25)
    angle = turn * arm * arm * (3 - 2 * arm)
    x, y = (points - pivot)[:, 0], (points - pivot)[:, 1]
    result = points.copy()
    result[:, 0] = pivot[0] + np.cos(angle) * x - np.sin(angle) * y
    result[:, 1] = pivot[1] + np.sin(angle) * x + np.cos(angle) * y
    return result


def heads(coarse, fine, number, name="head {}"):
    template, faces = coarse
    name = name.format(number)
    truth, scan = warped(template, template, number), (warped(fine[0], template, number), fine[1])
    yield Case(f"{name}, clean", template, faces, truth, scan)
    rng = np.random.default_rng(number)
    *hard, holes = harder(*scan, rng, size_of(truth))
    yield Case(f"{name}, holes, crops, noise", template, faces, truth, hard, holes=holes)
    picks = far_apart(template, 6)
    places = truth[picks] + 0.003 * size_of(truth) * rng.normal(size=(6, 3))
    yield Case(f"{name}, the same, 6 landmarks", template, faces, truth, hard, holes=holes, landmarks=zip(picks, places))


def poses(person):
    scan = dual(*person)
    arm, tips = bent_arm(person[0], 60), far_apart(person[0], 8)
    posed = (bent_arm(scan[0], 60), scan[1])
    yield Case("person, arm bent by 60 degrees, 8 landmarks", *person, arm, posed, mode="pose", landmarks=zip(tips, arm[tips]))
    yield Case("person, arm bent by 60 degrees", *person, arm, posed, mode="pose")


def generated_cases(make):
    coarse, fine = make("head"), make("fine_head")
    template, faces = coarse
    for number in (1, 2):
        yield from heads(coarse, fine, number)
    yield from heads(make("coarse_head"), coarse, 1, "coarse head {}")
    yield next(heads(make("finest_head"), fine, 1, "finest head {}"))
    collar = np.clip(-0.8 - fine[0][:, 1], 0, 0.1) * 0.4
    clothed = fine[0] + collar[:, None] * normals_of(*fine)
    yield Case("head, offset at the neck as of clothes", template, faces, warped(template, template, 2),
               (warped(clothed, template, 2), fine[1]))
    noise = 0.008 * np.random.default_rng(3).normal(size=template.shape) * (template[:, 2:] < 0)
    normals = normals_of(*coarse)
    uneven = template + noise - (noise * normals).sum(1)[:, None] * normals
    yield Case("head, uneven template", uneven, faces, warped(uneven, template, 1), (warped(fine[0], template, 1), fine[1]))
    yield from poses(make("person"))


def real_cases(folder):
    fit = folder / "fit"
    if not (fit / "Template.obj").exists():
        return
    template, faces = read_obj(fit / "Template.obj")
    for path in sorted(fit.glob("SIMPOP_*.obj")):
        truth, _ = read_obj(path)
        rng = np.random.default_rng(int(path.stem[-2:]))
        scan = scattered(truth, faces, rng)
        yield Case(f"face {path.stem[-2:]}, clean", template, faces, truth, scan)
        *hard, holes = harder(*scan, rng, size_of(truth))
        yield Case(f"face {path.stem[-2:]}, holes, crops, noise", template, faces, truth, hard, holes=holes)


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def edit_of(case, options):
    step = {"region": {"component": True}, "fit": {"to": "scan.ply", "mode": case.mode, **options}}
    if case.landmarks:
        step["handles"] = [{"vertices": str(v), "targets": [list(map(float, p))]} for v, p in case.landmarks]
    return json.dumps({"laplacian_edit": 1, "steps": [step]})


def fit_ours(case, program, folder, options):
    names = [folder / name for name in ("template.ply", "scan.ply", "out.ply", "edit.json", "report.json")]
    write(names[0], case.template, case.faces)
    write(names[1], *case.scan, case.normals)
    names[3].write_text(edit_of(case, options), encoding="ascii")
    before = processor_time()
    done = subprocess.run([program, "-q", "--report", names[4], names[0], names[2], names[3]], check=False, capture_output=True, text=True)
    if done.returncode:
        return None, {"error": done.stderr.strip()}
    report = json.loads(names[4].read_text(encoding="utf-8"))
    step = report["outputs"][0]["steps"][0]
    return read(names[2], len(case.template)), {
        "seconds": processor_time() - before, "advice": step["advice"], "fit": step["fit"]}


def aligned(case, program, folder):
    """The template where our alignment puts it: the start of the others. By the rigid part of a fit without detail."""
    result, _ = fit_ours(case, program, folder, {"detail": 0.4})
    if result is None:
        return case.template
    from_, to = case.template - case.template.mean(0), result - result.mean(0)
    u, s, vt = np.linalg.svd(to.T @ from_)
    u[:, 2] *= np.sign(np.linalg.det(u @ vt))
    scale = s.sum() / (from_ ** 2).sum() if case.mode == "shape" else 1
    return scale * from_ @ (u @ vt).T + result.mean(0)


def fit_meshmonk(case, start):
    import meshmonk
    faces, count = case.scan[1], len(case.template)
    scale = 100 / case.size  # its lengths are millimetres of a face
    points, start = scale * case.scan[0], scale * start
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    flags = np.ones(len(points), np.float32)
    flags[np.unique(unique[counts == 1])] = 0  # as its authors advise
    begin = time.process_time()
    result = meshmonk.pyramid_register(
        floating_features=np.hstack([start, normals_of(start, case.faces)]).astype(np.float32),
        target_features=np.hstack([points, normals_of(points, faces)]).astype(np.float32), floating_faces=case.faces,
        target_faces=faces, floating_flags=np.ones(count, np.float32), target_flags=flags)
    return np.asarray(result.aligned_features)[:, :3].astype(float) / scale, time.process_time() - begin


def measures(case, result, seconds):
    error = np.linalg.norm(result - case.truth, axis=1) / case.size * 100
    in_holes = np.zeros(len(error), bool)
    for centre in case.holes:
        in_holes |= np.linalg.norm(case.truth - centre, axis=1) < 0.12 * case.size
    return {"mean": float(error.mean()), "most": float(np.quantile(error, 0.95)), "largest": float(error.max()),
            "holes": float(error[in_holes].mean()) if in_holes.any() else None,
            "folds": folds(case.template, result, case.faces), "seconds": seconds}


def text_of(one):
    if one is None:
        return "-"
    holes = "" if one["holes"] is None else f"/{one['holes']:.2f}"
    return f"{one['mean']:.2f}/{one['most']:.2f}/{one['largest']:.2f}{holes};{one['folds']};{one['seconds']:.1f}"


def picture(options):
    """Template, scan, fitted template, and its error: below 1 % of the size green, below 2 % grey, larger red."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        make = maker(options.make_mesh, folder)
        case = [*heads(make("head"), make("fine_head"), 1)][1]
        result, _ = fit_ours(case, options.program, folder, {})
        error = np.linalg.norm(result - case.truth, axis=1) / case.size
        np.savetxt(folder / "error.txt", np.where(error < 0.01, 2, np.where(error < 0.02, 0, 1)), fmt="%d")
        write(folder / "fitted.ply", result, case.faces)
        command = ["xvfb-run", "-a", "/usr/bin/python3", "common/demo/render.py", options.picture, "--toward", "0.5", "0.1", "1", "--up", "0",
                   "1", "0", "--height", "300"]
        for mesh, caption, *classes in (("template", "template"), ("scan", "scan"), ("fitted", "fitted"),
                                        ("fitted", "error", folder / "error.txt")):
            command += ["--panel", folder / f"{mesh}.ply", caption, *classes]
        subprocess.run(command, check=True)
        subprocess.run(["convert", options.picture, "+dither", "-colors", "128", f"PNG8:{options.picture}"], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("program", "make-mesh", "meshes", "output"):
        parser.add_argument("--" + name, type=pathlib.Path, required=True)
    parser.add_argument("--cases", default="", help="only cases whose names match this pattern")
    parser.add_argument("--no-peers", action="store_true")
    parser.add_argument("--kinds", type=int, metavar="SEED", help="prints the table of kinds of fits on the page on fits")
    parser.add_argument("--picture", type=pathlib.Path, metavar="FILE", help="makes the picture of the page on fits")
    options = parser.parse_args()
    if options.picture:
        picture(options)
        return
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        make = maker(options.make_mesh, folder)
        if options.kinds is not None:
            import fit_kinds
            fit_kinds.table(options, make)
            return
        rows = []
        for case in [*generated_cases(make), *real_cases(options.meshes)]:
            if not re.search(options.cases, case.name):
                continue
            row = {"case": case.name, "vertices": len(case.template)}
            result, figures = fit_ours(case, options.program, folder, {})
            row["ours"] = None if result is None else measures(case, result, figures["seconds"])
            row["figures"] = figures
            if not options.no_peers:
                start = aligned(case, options.program, folder)
                row["start"] = float(np.linalg.norm(start - case.truth, axis=1).mean() / case.size * 100)
                row["meshmonk"] = measures(case, *fit_meshmonk(case, start))
            rows.append(row)
            print(case.name, *(f"| {text_of(row.get(key))}" for key in ("ours", "meshmonk")),
                  "|", figures.get("advice") or figures.get("error", ""), flush=True)
    header = "|Case (vertices)|Fit|MeshMonk|\n|---|---|---|\n"
    lines = [f"|{row['case']} ({row['vertices']})|" + "|".join(text_of(row.get(key)) for key in ("ours", "meshmonk"))
             + "|" for row in rows]
    (options.output / "fit.md").write_text(
        "Error per vertex in % of the size: mean/95 %/largest/mean in holes; folded faces; seconds.\n\n" + header + "\n".join(lines) + "\n",
        encoding="utf-8")
    (options.output / "fit.json").write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
