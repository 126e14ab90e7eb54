# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the shape of edits and compares it with peers, see quality.sh and README.md."""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np

import quality_edits
import quality_page
import quality_remeshing
from quality_edits import ply_meshes
from quality_measures import measure, targets_of

BLENDER_SCRIPT = pathlib.Path(__file__).with_name("blender_edit.py")
PEERS = ["ARAP", "ARAP100", "SR-ARAP", "Smooth-ARAP"]


class Bench:
    def __init__(self, options):
        self.options = options
        self.ours = {"linear": {"method": "linear"}, "paper": {"method": "paper"}, "default": {}}
        self.ours.update((name, json.loads(settings)) for name, _, settings in (text.partition("=") for text in options.ours))
        methods = [*self.ours, *PEERS, *(["libigl", "biharmonic"] if options.libigl else []), *(["Blender"] if options.blender else [])]
        self.methods = options.only.split(",") if options.only else methods
        if set(self.methods) - set(methods):
            sys.exit(f"quality.py: there is no method {', '.join(set(self.methods) - set(methods))}")

    def call(self, folder, repeat, *methods):
        done = subprocess.run([self.options.program, folder, str(repeat), str(self.options.threads), *methods], stdout=subprocess.PIPE, check=True)
        return json.loads(done.stdout)

    def run(self, edit, repeat):
        """@return the region, positions by method, and by method its times, or why it has no result"""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "points").write_bytes(np.ascontiguousarray(edit.mesh[0], float).tobytes())
            (folder / "faces").write_bytes(np.ascontiguousarray(edit.mesh[1], np.int32).tobytes())
            for method, settings in {"edit": {}, **self.ours}.items():
                (folder / f"{method}.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [{**edit.step, **settings}]}), encoding="ascii")
            output = self.call(folder, repeat, *(method for method in self.methods if method != "Blender"))
            figures, poses = output.get("methods", {}), {}
            if "Blender" in self.methods:
                figures["Blender"] = self.blender(folder, edit, output["region"])
            for method in figures:
                if "failed" not in figures[method]:
                    poses[method] = np.fromfile(folder / f"{'given' if method == 'Blender' else method}.points").reshape(-1, 3)
        return output["region"], poses, figures

    def blender(self, folder, edit, region):
        """In a process of its own, scaled to edges of 0.1, as Blender has absolute bounds."""
        points, faces = edit.mesh
        vertices = np.array(region["vertices"])
        local = np.full(len(points), -1)
        local[vertices] = np.arange(len(vertices))
        faces = local[faces]
        faces = faces[(faces >= 0).all(1) & (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
        edges = quality_edits.neighbours(len(vertices), faces).tocoo()
        scale = 0.1 / np.linalg.norm(points[vertices[edges.row]] - points[vertices[edges.col]], axis=1).mean()
        groups = []
        for number, matrix in enumerate(np.reshape(region["maps"], (-1, 3, 4))):
            groups.append({"map": (matrix * (1, 1, 1, scale)).tolist(), "vertices": [i for i, g in enumerate(region["groups"]) if g == number]})
        scene = {"vertices": (scale * points[vertices]).ravel().tolist(), "faces": faces.ravel().tolist(), "groups": groups,
                 "anchors": [i for i, kind in enumerate(region["classes"]) if kind == 1]}
        (folder / "scene.json").write_text(json.dumps(scene), encoding="ascii")
        # A spinning OpenMP thread would slow it tenfold as soon as something else runs.
        done = subprocess.run(["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python", BLENDER_SCRIPT, "--",
                               folder / "scene.json", folder / "blender.json"], check=False, stdin=subprocess.DEVNULL, capture_output=True,
                              env={**os.environ, "OMP_WAIT_POLICY": "passive", "HOME": str(folder)})
        if done.returncode or not (folder / "blender.json").exists():
            return {"failed": "Blender has no result"}
        given = json.loads((folder / "blender.json").read_text(encoding="utf-8"))
        pose = points.copy()
        pose[vertices] = np.reshape(given["positions"], (-1, 3)) / scale
        (folder / "given.points").write_bytes(pose.tobytes())
        times = {"prepare_ms": given["bind_ms"], "solve_ms": given["update_ms"], "frame_ms": given["update_ms"], "fast_frame": True}
        return {**self.call(folder, 1, "given")["methods"]["given"], **times}

    def measured(self, name, kind, edit):
        region, poses, figures = self.run(edit, self.options.repeat)
        figures = {method: {**measure(edit, region, poses[method]), **found} if method in poses else found for method, found in figures.items()}
        if self.options.pictures:
            draw(self.options.pictures / f"{name}.png", edit, region, {method: poses[method] for method in self.methods if method in poses}, figures)
        return {"vertices": len(region["vertices"]), "class": kind, **figures}

    def remeshed(self, edit):
        """For each triangulation and method the largest distance of a vertex that stays from itself, over the largest displacement."""
        region, expected, _ = self.run(edit, 1)
        spec, count = edit.step["region"], len(edit.mesh[0])
        anchors, groups, vertices = spec.get("anchors", {}), np.array(region["groups"]), np.array(region["vertices"])
        handles = [vertices[groups == g] for g in range(groups.max() + 1)]
        lists = [range(count) if "vertices" in spec else [], anchors.get("vertices", []), spec.get("held", []), *handles]
        masks, numbers = [0] * count, np.zeros((count, 2))
        for k, members in enumerate(lists):
            for v in members:
                masks[v] |= 1 << k
        if anchors:
            numbers[anchors["vertices"]] = np.stack([anchors["weights"], anchors["depths"]], 1)
        for kind, change in quality_remeshing.KINDS.items():
            mesh = quality_remeshing.Mesh(*edit.mesh, masks, numbers)
            change(mesh, {v for handle in handles if len(handle) < 20 for v in handle})
            points, now, strengths, faces, kept = mesh.result()
            found = [[v for v, mask in enumerate(now) if mask >> k & 1] for k in range(len(lists))]
            step = {"region": {**spec}, "handles": [{"vertices": one, "matrix": [*matrix, 0, 0, 0, 1]} for one, matrix in zip(found[3:], region["maps"])]}
            for key, members in zip(("vertices", "anchors", "held"), found):
                if key in spec:
                    step["region"][key] = members
            if anchors:
                weights, depths = strengths[found[1]].T.tolist()
                step["region"]["anchors"] = {**anchors, "vertices": found[1], "weights": weights, "depths": depths}
            _, poses, _ = self.run(quality_edits.Edit((points, faces), step["region"], *step["handles"]), 1)
            stays = kept >= 0
            for method in self.methods:
                both = method in expected and method in poses
                off = np.linalg.norm(expected[method][stays] - poses[method][kept[stays]], axis=1).max() if both else math.nan
                yield f"{kind}, {method}", off / np.linalg.norm(expected[method] - edit.mesh[0], axis=1).max() if both else math.nan


def draw(picture, edit, region, poses, figures):
    """The methods side by side; captions: RMS stretch in %, flipped triangles, new pairs."""
    points, faces = edit.mesh
    classes = np.zeros(len(points), int)
    classes[region["vertices"]] = region["classes"]
    seen = np.vstack([points[region["vertices"]], targets_of(region, points)[1]])
    low, high = seen.min(0), seen.max(0)
    # argparse takes numbers with exponents for options.
    around = [f"{number:.9f}" for number in (*((low + high) / 2), 0.55 * max(high - low))]
    command = ["xvfb-run", "-a", "/usr/bin/python3", quality_edits.ROOT / "common/demo/render.py", picture, "--toward", *edit.toward, "--up", *edit.up,
               "--around", *around, "--height", 210, "--columns", 4]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        np.savetxt(folder / "classes.txt", classes, fmt="%d")
        for method, pose in {"rest": points, **poses}.items():
            if method not in ("linear", "paper"):
                ply_meshes.write(folder / f"{method}.ply", pose.tolist(), faces.tolist())
                found = figures.get(method)
                command += ["--panel", folder / f"{method}.ply"]
                command += [f"{method}: {100 * found['rms']:.0f} % / {found['flipped']} / {found['pairs']}"] if found else [method, folder / "classes.txt"]
        subprocess.run(list(map(str, command)), check=True)


def print_remeshed(bench, edits):
    rows = {name: dict(bench.remeshed(make())) for name, (_, make) in edits.items()}
    head = list(next(iter(rows.values())))
    for what, of in (("median", statistics.median), ("largest", max)):
        rows[what] = {key: of([row[key] for row in rows.values() if not math.isnan(row[key])]) for key in head} if len(edits) else {}
    quality_page.table(("% of the largest displacement", *head), [(name, *(f"{100 * row[key]:.2g}" for key in head)) for name, row in rows.items()])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="quality_bench")
    parser.add_argument("--make-mesh", type=pathlib.Path, required=True)
    parser.add_argument("--meshes", type=pathlib.Path, help="folder of the real meshes")
    parser.add_argument("--edits", default="", metavar="A,B", help="these edits, as quality_edits.py names them")
    parser.add_argument("--ours", action="append", default=[], metavar='NAME={"KEY": VALUE}', help="adds settings, by the keys of JSON")
    parser.add_argument("--only", default="", metavar="A,B", help="only these methods")
    parser.add_argument("--libigl", action="store_true")
    parser.add_argument("--blender", action="store_true")
    parser.add_argument("--remeshed", action="store_true", help="the change of each edit when the surface is triangulated anew")
    parser.add_argument("--threads", type=int, default=0, help="ours; 0: as many as the machine has")
    parser.add_argument("--repeat", type=int, default=2, help="best times of so many runs")
    parser.add_argument("--json", type=pathlib.Path, required=True, help="file of all figures")
    parser.add_argument("--pictures", type=pathlib.Path, help="folder of a picture for each edit")
    options = parser.parse_args()
    quality_edits.MAKE_MESH, quality_edits.MESHES = options.make_mesh, options.meshes
    edits, bench = quality_edits.edits(), Bench(options)
    if options.edits:
        edits = {name: edits[name] for name in options.edits.split(",")}
    if options.remeshed:
        print_remeshed(bench, edits)
        return
    rows = {}
    for name, (kind, make) in edits.items():
        rows[name] = bench.measured(name, kind, make())
        print(name, file=sys.stderr, flush=True)
    options.json.write_text(json.dumps(rows, indent=1, default=float) + "\n", encoding="utf-8")
    quality_page.print_tables(rows)


if __name__ == "__main__":
    main()
