#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the documents' pictures of edits, and prints the table that belongs to them, by laplacian-edit.

usage: pictures.py [NAME]...

It builds what it needs in build/, and writes to build/pictures/. Names: figure1, figure2, figure4 to figure8 and table1 of
common/docs/paper.md; methods, cells and surface of method.md; contact of peers.md: all by default. It needs xvfb-run, python3-scipy
and python3-vtk9. LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
"""
import argparse
import functools
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

import numpy
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/cli"), str(ROOT / "tests/compat")]

import ply_meshes  # noqa: E402

BUILD, OUTPUT = ROOT / "build", ROOT / "build/pictures"
MESHES = pathlib.Path(os.environ.get("LAPEDIT_MESHES", ROOT.parent / "shared/meshes"))
METHODS = ("linear", "paper", "default")
COLOURS = ("#d55e00", "#0072b2", "#009e73")  # of Okabe and Ito
UP = {"toward": (0.3, -0.9, 0.75), "up": (0, 0, 1)}
ALONG_Y = {"toward": (0.75, 0.1, 0.7), "up": (0, 1, 0)}
LIMB = {"toward": (0.2, -0.9, -0.5), "up": (0, 0, 1)}


# Region vertices, and the paper's seconds to factor and to solve for one coordinate on a Pentium 4 of 2.4 GHz; meshes with
# points at their handles.
TABLE_1 = {1201: (0.031, 0.002), 3395: (0.051, 0.003), 4685: (0.092, 0.005), 12774: (0.568, 0.020), 16792: (0.804, 0.030),
           32280: (1.863, 0.069)}
OF_TABLE_1 = {"head": ((0, -0.13, 1.2), (1201, 3395)), "creature": ((-2.2, 0.6, 0), (4685, 12774)), "arm": ((10, 0, 0), (16792,)),
              "field": ((2, 1, 0), (32280,)), "mannequin.off": ((0.0185447, -1.24318, -0.0873), (1201, 3395)),
              "octopus.off": ((0.326838, -0.31208, 0.174829), (4685, 12774)), "bumpy_plane.off": ((50, 50, 10), (32280,))}


class Mesh:
    """A generated mesh by its name, a real one by its file's, or any PLY file."""

    def __init__(self, name):
        self.path = pathlib.Path(name)
        if not self.path.is_absolute():
            self.path = OUTPUT / f"{self.path.stem}.ply"
            if "." in name:
                ply_meshes.write(self.path, *ply_meshes.read(MESHES / name))
            else:
                subprocess.run([BUILD / "common/demo/make_mesh", name, self.path], check=True)
        points, self.faces = ply_meshes.read(self.path)
        self.points = numpy.array(points)

    @functools.cached_property
    def edges(self):
        """A sparse matrix of their lengths."""
        sides = numpy.unique(numpy.sort(numpy.array(self.faces)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        lengths = numpy.linalg.norm(self.points[sides[:, 0]] - self.points[sides[:, 1]], axis=1)
        return csr_matrix((lengths, sides.T), shape=2 * (len(self.points),))

    def near(self, point, radius=0.0):
        """The vertices in a ball, or the nearest one."""
        away = numpy.linalg.norm(self.points - numpy.array(point), axis=1)
        return numpy.nonzero(away < radius)[0].tolist() if radius else [int(away.argmin())]

    def distances(self, seeds):
        return dijkstra(self.edges, directed=False, indices=seeds, min_only=True)

    def radius(self, seeds, count):
        """Of the region that holds so many vertices."""
        found = numpy.sort(self.distances(seeds))
        return float((found[count - 1] + found[count]) / 2)

    def classes(self, seeds, radius):
        """A file for the renderer: 0 fixed, 1 anchor, 2 free, 3 handle."""
        away = self.distances(seeds)
        kinds = numpy.where(away > radius, 0, numpy.where(away > 0.9 * radius, 1, 2))
        kinds[seeds] = 3
        path = OUTPUT / f"{self.path.stem}-{radius:.3g}.txt"
        numpy.savetxt(path, kinds, fmt="%d")
        return path

    def edited(self, name, *steps):
        """@return the result's path, and the report of each step"""
        edit, result, report = (OUTPUT / f"{name}{suffix}" for suffix in (".json", ".ply", ".report.json"))
        edit.write_text(json.dumps({"laplacian_edit": 1, "steps": steps}))
        program = BUILD / "common/cli/laplacian-edit"
        subprocess.run([program, "--quiet", "--report", report, self.path, result, edit], check=True)
        return result, json.loads(report.read_text())["outputs"][0]["steps"]


def step(vertices, radius, motion, **settings):
    return {"region": {"radius": radius}, "handles": [{"vertices": ",".join(map(str, vertices)), **motion}], **settings}


def render(name, panels, view, columns=2, height=300):
    """panels: path, caption, and classes where there are any"""
    command = ["xvfb-run", "-a", ROOT / "common/demo/render.py", OUTPUT / f"{name}.png", "--columns", columns, "--height", height]
    for key, numbers in view.items():
        command += [f"--{key}", *numbers]
    for panel in panels:
        command += ["--panel", *panel]
    subprocess.run(list(map(str, command)), check=True)


def bent_limb():
    """The end, about whose middle it is rotated, is where it is if the limb becomes an arc, from its root on."""
    mesh, angle, along, end = Mesh("arm"), math.radians(170), 7.3, 0.5
    way = (along * (math.sin(angle) / angle - 1) + end * (math.cos(angle) - 1), 0,
           along * (1 - math.cos(angle)) / angle + end * math.sin(angle))
    return mesh, step(mesh.near((10, 0, 0), 1), 7.5, {"translation": way, "rotation": {"axis": (0, -1, 0), "degrees": 170}})


def methods():
    """The limb's end bent back by each method."""
    mesh, edit = bent_limb()
    results = [(mesh.edited(f"methods-{method}", {**edit, "method": method})[0], method) for method in METHODS]
    render("methods", [(mesh.path, "before", mesh.classes(mesh.near((10, 0, 0), 1), 7.5)), *results], LIMB, 2, 460)


def cells():
    """The cells of the limb, before and after its end is bent back."""
    (mesh, edit), colours = bent_limb(), OUTPUT / "cells.txt"
    with colours.open("w") as out:
        subprocess.run([BUILD / "tests/unit/cell_colours", "7.5", *map(str, mesh.near((10, 0, 0), 1))], stdout=out, check=True)
    render("cells", [(mesh.path, "cells at rest", colours), (mesh.edited("cells", edit)[0], "after the edit", colours)], LIMB)


def strip(name, columns, rows, place):
    """A mesh of columns x rows vertices, placed by a function of two numbers from 0 to 1."""
    points = [place(i / (columns - 1), j / (rows - 1)) for j in range(rows) for i in range(columns)]
    corners = [columns * j + i for j in range(rows - 1) for i in range(columns - 1)]
    ply_meshes.write(OUTPUT / name, points, [face for a in corners for face in ((a, a + 1, a + columns), (a + 1, a + columns + 1, a + columns))])
    return Mesh(OUTPUT / name)


def surface():
    """A sheet of long cells and a tube that is half fine, with weights that depend on the triangles and with those of the surface."""
    def tube(u, v):
        angle = 2 * math.pi * (u % 1)
        return (25 * v if v < 0.2 else 5 + 6.25 * (v - 0.2), math.cos(angle), math.sin(angle))

    panels = []
    for mesh, disc, radius, motion in (
            (strip("sheet.ply", 21, 81, lambda u, v: (10 * u, 6 * v - 3, 0)), 0, 3, {"translation": (0, 0, 2.5)}),
            (strip("tube.ply", 25, 81, tube), 1.3, 9.5, {"rotation": {"axis": (1, 0, 0), "degrees": 270}})):
        handle = mesh.near((10, 0, 0) if disc else (5, 0, 0), disc)
        for kind in ("mean_value", "surface"):
            panels.append((mesh.edited(f"{mesh.path.stem}-{kind}", step(handle, radius, motion, laplacian=kind))[0], kind))
    render("surface", panels, {"toward": (0.25, -0.6, 0.75), "up": (0, 0, 1)}, 4)


def contact():
    """A finger beside another one, a hand on a thigh, and a tube bent by 150 degrees, without and with contact."""
    hand, person = Mesh("hand"), Mesh("person")
    tube = strip("elbow.ply", 41, 140, lambda u, v: (0.3 * math.sin(2 * math.pi * (u % 1)), 4 * v - 2, 0.3 * math.cos(2 * math.pi * (u % 1))))
    to_thigh = {"rotation": {"axis": (0, 0, 1), "degrees": -55, "center": (0.4, 0.8, 0)}}
    ends = [{"vertices": numpy.nonzero(end)[0].tolist(), **motion} for end, motion in (
        (tube.points[:, 1] < -0.5, {}), (tube.points[:, 1] > 0.5, {"rotation": {"axis": (0, 0, 1), "degrees": 150, "center": (0, 0, 0)}}))]
    panels = []
    for mesh, edit in ((hand, step(hand.near((0.05, 1.6, 0), 0.2), 1.2, {"translation": (0.35, -0.1, 0)})),
                       (person, step(person.near((1.08, -0.4, 0.1), 0.25), 1.4, to_thigh)),
                       (tube, {"region": {"component": True}, "handles": ends})):
        panels += [(mesh.edited(f"contact-{mesh.path.stem}-{kind}", {**edit, **more})[0], kind)
                   for kind, more in (("default", {}), ("contact", {"contact": True}))]
    render("contact", panels, {"toward": (0.25, 0.15, 1), "up": (0, 1, 0)}, 6, 360)


def locality(name, mesh_name, point, counts, translation, view):
    """Figures 1 and 7: the same handle moved as far in a small and in a large region."""
    mesh = Mesh(mesh_name)
    handle, panels = mesh.near(point), []
    for method in ("paper", "default"):
        for count in counts:
            radius = mesh.radius(handle, count)
            result, _ = mesh.edited(f"{name}-{count}-{method}", step(handle, radius, {"translation": translation}, method=method))
            panels += [(mesh.path, f"{count:,} vertices", mesh.classes(handle, radius)) if method == "paper" else (mesh.path, "before"),
                       (result, method)]
    render(name, panels, view, 4)


def front(mesh, x, y):
    """The vertex in front of a position of the head."""
    near = numpy.nonzero(numpy.abs(mesh.points[:, :2] - (x, y)).max(axis=1) < 0.04)[0]
    return int(near[mesh.points[near, 2].argmax()])


def path_along(mesh, vertices):
    """Vertices of the shortest paths from one to the next."""
    whole = [vertices[0]]
    for end in vertices[1:]:
        _, following = dijkstra(mesh.edges, directed=False, indices=end, return_predecessors=True)
        while whole[-1] != end:
            whole.append(int(following[whole[-1]]))
    return sorted(set(whole))


def figure6():
    bend = {"translation": (-2.5, 0, 4.5), "rotation": {"axis": (0, -1, 0), "degrees": 90}}
    for name, point, disc, radius, motion, view in (("letters", (2.05, 0.9, 0.12), 0, 1.8, {"translation": (0.8, 0, 1)}, UP),
                                                    ("arm", (10, 0, 0), 1, 7.5, bend, LIMB)):
        mesh = Mesh(name)
        results = [(mesh.edited(f"figure6-{name}-{method}", step(mesh.near(point, disc), radius, motion, method=method))[0], method)
                   for method in METHODS]
        render(f"figure6-{name}", [(mesh.path, "before"), *results], view)


def figure8():
    """Five edits; a brow is moved as a curve, a mouth's corners by small handles."""
    head = Mesh("head")
    brows = [path_along(head, [front(head, side * x, y) for x, y in ((0.62, 0.42), (0.4, 0.47), (0.2, 0.42))]) for side in (1, -1)]
    corners = [numpy.nonzero(head.distances([front(head, x, -0.5)]) <= 0.05)[0].tolist() for x in (0.24, -0.24)]
    moves = ((brows[0], 0.4, (0, 0.16, 0.05)), (brows[1], 0.35, (0.04, -0.1, 0.06)), (corners[0], 0.3, (0.1, 0.12, -0.02)),
             (corners[1], 0.3, (-0.06, -0.09, 0)), ([front(head, 0, -0.13)], 0.5, (0.05, 0.05, 0.15)))
    result, _ = head.edited("expression", *(step(handle, radius, {"translation": way}) for handle, radius, way in moves))
    render("figure8", [(head.path, "before"), (result, "five edits")], {"toward": (0.25, 0.05, 1), "up": (0, 1, 0)}, height=420)


def curves(name, height, ways, handle, held, motion, window):
    """Figures 2, 4 and 5: the middle line of a strip before and after each way, as SVG. held: first and last columns that stay"""
    mesh = strip(f"{name}.ply", 9, 121, lambda u, v: (12 * v, 0.8 * u - 0.4, height(12 * v)))

    def columns(first, last):
        return f"{9 * first}-{9 * last + 8}"

    handles = [{"vertices": columns(*handle), **motion}, *({"vertices": columns(*h)} for h in held)]
    left, right, low, high = window
    scale = 420 / (right - left)
    tall = scale * (high - low)
    text = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {420 * len(ways)} {tall + 30:.0f}" font-family="sans-serif" '
            'font-size="15"><rect width="100%" height="100%" fill="white"/>']
    for k, (caption, settings) in enumerate(ways.items()):
        result, _ = mesh.edited(f"{name}-{k}", {"region": {"component": True}, "handles": handles, **settings})
        for line, colour in ((mesh.points[4::9], "#999999"), (Mesh(result).points[4::9], COLOURS[k])):
            corners = " ".join(f"{420 * k + scale * (x - left):.1f},{scale * (high - z):.1f}" for x, _, z in line)
            text.append(f'<polyline points="{corners}" fill="none" stroke="{colour}" stroke-width="1.5"/>')
        text.append(f'<text x="{420 * (k + 0.5):.0f}" y="{tall + 18:.0f}" text-anchor="middle">{caption}</text>')
    (OUTPUT / f"{name}.svg").write_text("\n".join(text) + "\n</svg>\n")


def figure4():
    orders = {f"order {k}": {"method": "linear", "order": k, "handle_weight": 1000, "anchor_weight": 1000} for k in (1, 2, 3)}
    curves("figure4", lambda x: 0.0, orders, (60, 60), [(0, 8), (112, 120)], {"translation": (0, 0, 3)}, (-0.5, 12.5, -0.6, 3.4))


def rotations(name, height, ways):
    end = {"translation": (-3.6, 0, 6.2), "rotation": {"axis": (0, -1, 0), "degrees": 80}}
    curves(name, height, {**ways, "default": {}}, (112, 120), [(0, 8)], end, (-0.5, 13.5, -0.6, 7.4))


def table1():
    """Of the paper's sizes: seconds to factor, and to solve for one coordinate; medians of seven."""
    print("|region vertices|factor, paper|solve, paper|mesh|factor|solve|factor, times as fast|solve|\n" + "|---:" * 8 + "|")
    for name, (point, counts) in OF_TABLE_1.items():
        for count in counts if "." not in name or MESHES.is_dir() else ():
            mesh = Mesh(name)
            handle = mesh.near(point)
            one = step(handle, mesh.radius(handle, count), {"translation": (0.01, 0.02, 0.03)}, method="linear")
            spent = [mesh.edited("table1", one)[1][0]["milliseconds"] for _ in range(7)]
            ours = [statistics.median(times[key] for times in spent) / 1e3 for key in ("factorisation", "solve")]
            ours[1] /= 3
            factor, solve = TABLE_1[count]
            print(f"|{count:,}|{factor:.3f}|{solve:.3f}|{name}|{ours[0]:.4f}|{ours[1]:.5f}|{factor / ours[0]:.0f}|{solve / ours[1]:.0f}|", flush=True)


PICTURES = {
    "figure1": lambda: locality("figure1", "head", (0, -0.13, 1.21), (1201, 3395), (0, 0, 0.7), ALONG_Y),
    "figure2": lambda: rotations("figure2", lambda x: 0.4 * max(0.0, math.sin(2 * math.pi * x / 1.8)), {
        "differential coordinates not rotated": {"method": "linear"}, "rotated by smooth normals": {"method": "paper"}}),
    "figure4": figure4,
    "figure5": lambda: rotations("figure5", lambda x: 0.15 * math.sin(2 * math.pi * x / 0.9) + 0.04 * math.sin(23 * x), {
        "normals of the nearest neighbours": {"method": "paper", "normal_radius": 0.11},
        "smooth normals, over a region": {"method": "paper"}}),
    "figure6": figure6,
    "figure7": lambda: locality("figure7", "creature", (-2.2, 0.6, 0), (1201, 12774), (-0.3, 1.0, 0.5), {"toward": (0.2, 0.2, 1), "up": (0, 1, 0)}),
    "figure8": figure8, "table1": table1, "methods": methods, "cells": cells, "surface": surface, "contact": contact}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", choices=[[], *PICTURES], default=[])
    given = parser.parse_args()
    subprocess.run([ROOT / "common/scripts/install_dependencies.sh", "bench"], check=True)
    subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-DLAPEDIT_BUILD_TESTS=ON"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "--parallel", "--target", "laplacian_edit_program", "make_mesh", "cell_colours"], check=True,
                   stdout=subprocess.DEVNULL)
    OUTPUT.mkdir(parents=True, exist_ok=True)
    for name in given.names or PICTURES:
        PICTURES[name]()
        print(name, flush=True)


if __name__ == "__main__":
    main()
