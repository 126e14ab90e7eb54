#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the paper's figures and its Table 1 anew, by laplacian-edit, on generated meshes and on real ones if there are.

Needs an X server (xvfb-run). paper.sh prepares what this needs and calls it.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

import numpy

from gallery import distances, read_mesh

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "hosts"))

import ply_meshes  # noqa: E402

# The paper's settings, and ours.
UNROTATED = {"method": "linear"}
ROTATED = {"method": "paper"}
DEFAULT = {}
# Table 1: vertices of the region, and seconds to factor and to solve for one coordinate on a Pentium 4 of 2.4 GHz.
TABLE_1 = ((1201, 0.031, 0.002), (3395, 0.051, 0.003), (4685, 0.092, 0.005), (12774, 0.568, 0.020),
           (16792, 0.804, 0.030), (32280, 1.863, 0.069))
COLOURS = ("#d55e00", "#0072b2", "#009e73")  # of Okabe and Ito


class Mesh:
    def __init__(self, path):
        self.path = path
        self.points, self.faces = read_mesh(path)

    def nearest(self, place):
        return int(numpy.linalg.norm(self.points - numpy.array(place), axis=1).argmin())

    def front(self, x, y, direction=2, width=0.04):
        """The vertex that is farthest along a coordinate near a place of the two others."""
        a, b = [k for k in range(3) if k != direction]
        near = numpy.nonzero((abs(self.points[:, a] - x) < width) & (abs(self.points[:, b] - y) < width))[0]
        return int(near[self.points[near, direction].argmax()])

    def radius_of(self, seeds, count):
        """Of the region that holds so many vertices."""
        found = numpy.sort(distances(self.points, self.faces, seeds))
        return float((found[count - 1] + found[count]) / 2)

    def path_along(self, places):
        """Vertices of the shortest paths from one to the next."""
        around = {}
        for a, b, c in self.faces.tolist():
            for u, v in ((a, b), (b, c), (c, a)):
                around.setdefault(u, set()).add(v)
                around.setdefault(v, set()).add(u)
        whole = [places[0]]
        for start, end in zip(places, places[1:]):
            away = distances(self.points, self.faces, [end])
            while whole[-1] != end:
                here = whole[-1]
                whole.append(min(around[here], key=lambda v: away[v] + numpy.linalg.norm(self.points[v] - self.points[here])))
        return sorted(set(whole))


class Paper:
    def __init__(self, given):
        self.given = given
        self.output = given.output
        self.output.mkdir(parents=True, exist_ok=True)

    # Meshes, edits, pictures

    def made(self, name):
        path = self.output / f"{name}.ply"
        if not path.exists():
            subprocess.run([self.given.make_mesh, name, path], check=True)
        return Mesh(path)

    def real(self, name):
        """As PLY, which the renderer reads."""
        path = self.output / pathlib.Path(name).with_suffix(".ply").name
        ply_meshes.write(path, *ply_meshes.read(self.given.meshes / name))
        return Mesh(path)

    def edited(self, mesh, name, steps):
        """@return the result's path and the report"""
        edit, result, report = (self.output / f"{name}{suffix}" for suffix in (".json", ".ply", ".report.json"))
        edit.write_text(json.dumps({"laplacian_edit": 1, "steps": steps}))
        subprocess.run([self.given.command, "--quiet", "--report", report, mesh.path, result, edit], check=True)
        return result, json.loads(report.read_text())["outputs"][0]["steps"]

    def classes(self, mesh, seeds, radius, name):
        """What the vertices are, for the renderer: 0 fixed, 1 anchor, 2 free, 3 handle."""
        away = distances(mesh.points, mesh.faces, seeds)
        kinds = numpy.where(away <= radius, 2, 0)
        kinds[(away <= radius) & (away > 0.9 * radius)] = 1
        kinds[seeds] = 3
        path = self.output / f"{name}.txt"
        numpy.savetxt(path, kinds, fmt="%d")
        return path

    def render(self, name, panels, toward, up, columns, height=300, around=None):
        """panels: path, caption, and classes where there are any"""
        command = [HERE.parents[1] / "common/demo/render.py", self.output / f"{name}.png", "--toward", *toward, "--up", *up,
                   "--columns", columns, "--height", height, *(["--around", *around] if around else [])]
        for panel in panels:
            command += ["--panel", *panel]
        subprocess.run(list(map(str, command)), check=True)

    # The figures

    def locality(self, name, mesh, handle, counts, translation, **view):
        """Figures 1 and 7: the same handle moved as far in a small and in a large region."""
        panels = []
        for row, (settings, caption) in enumerate(((ROTATED, "paper"), (DEFAULT, "default"))):
            for count in counts:
                radius = mesh.radius_of([handle], count)
                step = {"region": {"radius": radius}, "handles": [{"vertices": str(handle), "translation": translation}]}
                result, _ = self.edited(mesh, f"{name}-{count}-{row}", [{**step, **settings}])
                if row == 0:
                    panels.append((mesh.path, f"{count:,} vertices", self.classes(mesh, [handle], radius, f"{name}-{count}")))
                else:
                    panels.append((mesh.path, "before"))
                panels.append((result, caption))
        self.render(name, panels, columns=4, **view)

    def figure_1(self):
        head = self.made("head")
        self.locality("figure1", head, head.front(0, -0.13, width=0.15), (1201, 3395), [0, 0, 0.7], toward=(0.75, 0.1, 0.7),
                      up=(0, 1, 0))
        if self.given.meshes:
            self.locality("figure1-mannequin", self.real("mannequin.off"), 8624, (1201, 3395), [0, -0.9, 0],
                          toward=(0.9, -0.55, 0.15), up=(0, 0, 1))

    def figure_7(self):
        creature = self.made("creature")
        self.locality("figure7", creature, creature.nearest((-2.2, 0.6, 0)), (1201, 12774), [-0.3, 1.0, 0.5],
                      toward=(0.2, 0.2, 1), up=(0, 1, 0))
        if self.given.meshes:
            self.locality("figure7-octopus", self.real("octopus.off"), 3175, (4685, 12774), [0, 0.437, 0],
                          toward=(0.5, 0.45, -0.9), up=(0, 1, 0))

    def figure_6(self):
        ways = ((UNROTATED, "no rotation"), (ROTATED, "paper"), (DEFAULT, "default"))
        letters = self.made("letters")
        handle = letters.nearest((2.05, 0.9, 0.12))
        step = {"region": {"radius": 1.8}, "handles": [{"vertices": str(handle), "translation": [0.8, 0, 1]}]}
        panels = [(letters.path, "before")]
        panels += [(self.edited(letters, f"figure6-letters-{k}", [{**step, **way}])[0], caption)
                   for k, (way, caption) in enumerate(ways)]
        self.render("figure6-letters", panels, toward=(0.3, -0.9, 0.75), up=(0, 0, 1), columns=2)
        arm = self.made("arm")
        tip = numpy.nonzero(numpy.linalg.norm(arm.points - [10, 0, 0], axis=1) < 1)[0]
        step = {"region": {"radius": 7.5},
                "handles": [{"vertices": ",".join(map(str, tip)), "translation": [-2.5, 0, 4.5],
                             "rotation": {"axis": [0, -1, 0], "degrees": 90}}]}
        panels = [(arm.path, "before")]
        panels += [(self.edited(arm, f"figure6-arm-{k}", [{**step, **way}])[0], caption)
                   for k, (way, caption) in enumerate(ways)]
        self.render("figure6-arm", panels, toward=(0.2, -0.9, -0.5), up=(0, 0, 1), columns=2)

    def figure_8(self):
        """Five edits; a brow is moved as a curve, a mouth's corners by small handles."""
        head = self.made("head")

        def brow(side):
            return head.path_along([head.front(side * x, y) for x, y in ((0.62, 0.42), (0.4, 0.47), (0.2, 0.42))])

        def step(vertices, radius, translation):
            return {"region": {"radius": radius},
                    "handles": [{"vertices": ",".join(map(str, vertices)), "translation": translation}]}

        def disc(x, y, radius):
            away = distances(head.points, head.faces, [head.front(x, y)])
            return numpy.nonzero(away <= radius)[0].tolist()

        steps = [step(brow(1), 0.4, [0, 0.16, 0.05]), step(brow(-1), 0.35, [0.04, -0.1, 0.06]),
                 step(disc(0.24, -0.5, 0.05), 0.3, [0.1, 0.12, -0.02]), step(disc(-0.24, -0.5, 0.05), 0.3, [-0.06, -0.09, 0]),
                 step([head.front(0, -0.13, width=0.15)], 0.5, [0.05, 0.05, 0.15])]
        result, _ = self.edited(head, "expression", steps)
        self.render("figure8", [(head.path, "before"), (result, "five edits")], toward=(0.25, 0.05, 1),
                    up=(0, 1, 0), columns=2, height=420)

    # Curves: the middle line of a strip

    def strip(self, name, height):
        """121 x 9 vertices over [0, 12] x [-0.4, 0.4], number 9 * i + j; height: of the line, from x."""
        path = self.output / f"{name}.ply"
        points = [(0.1 * i, 0.1 * (j - 4), height(0.1 * i)) for i in range(121) for j in range(9)]
        faces = []
        for i in range(120):
            for j in range(8):
                a, b, c, d = 9 * i + j, 9 * i + 9 + j, 9 * i + 10 + j, 9 * i + 1 + j
                faces += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
        lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}", "property float x", "property float y",
                 "property float z", f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
        lines += [" ".join(f"{c:.9g}" for c in p) for p in points] + [" ".join(map(str, (3, *f))) for f in faces]
        path.write_text("\n".join(lines) + "\n")
        return Mesh(path)

    def curves(self, name, mesh, ways, handle, held, transform, window):
        """Draws the middle line before and after each way as SVG. held: first and last column that stay"""
        def columns(first, last):
            return f"{9 * first}-{9 * last + 8}"

        lines = [(mesh.points[4::9], "before")]
        for k, (settings, caption) in enumerate(ways):
            handles = [{"vertices": columns(*handle), **transform}, *({"vertices": columns(*h)} for h in held)]
            result, _ = self.edited(mesh, f"{name}-{k}", [{"region": {"component": True}, "handles": handles, **settings}])
            lines.append((Mesh(result).points[4::9], caption))
        left, right, low, high = window
        width, height = 420, 420 * (high - low) / (right - left)
        scale = width / (right - left)
        text = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width * len(ways)} {height + 30:.0f}" '
                'font-family="sans-serif" font-size="15"><rect width="100%" height="100%" fill="white"/>']
        for k, (points, caption) in enumerate(lines[1:]):
            for (line, colour) in ((lines[0][0], "#999999"), (points, COLOURS[k])):
                corners = " ".join(f"{width * k + scale * (x - left):.1f},{scale * (high - z):.1f}" for x, _, z in line)
                text.append(f'<polyline points="{corners}" fill="none" stroke="{colour}" stroke-width="1.5"/>')
            text.append(f'<text x="{width * (k + 0.5):.0f}" y="{height + 18:.0f}" text-anchor="middle">{caption}</text>')
        (self.output / f"{name}.svg").write_text("\n".join(text) + "\n</svg>\n")

    def figure_2(self):
        """Differential coordinates are not rotation-invariant."""
        bumps = self.strip("bumps", lambda x: 0.4 * max(0.0, numpy.sin(2 * numpy.pi * x / 1.8)))
        end = {"translation": [-3.6, 0, 6.2], "rotation": {"axis": [0, -1, 0], "degrees": 80}}
        self.curves("figure2", bumps, ((UNROTATED, "differential coordinates not rotated"),
                                       (ROTATED, "rotated by smooth normals"), (DEFAULT, "default")),
                    (112, 120), [(0, 8)], end, (-0.5, 13.5, -0.6, 7.4))

    def figure_4(self):
        """Orders of the Laplacian."""
        flat = self.strip("flat", lambda x: 0.0)
        ways = tuple(({**UNROTATED, "order": k, "handle_weight": 1000, "anchor_weight": 1000}, f"order {k}") for k in (1, 2, 3))
        self.curves("figure4", flat, ways, (60, 60), [(0, 8), (112, 120)], {"translation": [0, 0, 3]}, (-0.5, 12.5, -0.6, 3.4))

    def figure_5(self):
        """Rotations from normals as they are, and from smooth ones."""
        rough = self.strip("rough", lambda x: 0.15 * numpy.sin(2 * numpy.pi * x / 0.9) + 0.04 * numpy.sin(23 * x))
        ways = (({**ROTATED, "normal_radius": 0.11}, "normals of the nearest neighbours"),
                (ROTATED, "smooth normals, over a region"), (DEFAULT, "default"))
        end = {"translation": [-3.6, 0, 6.2], "rotation": {"axis": [0, -1, 0], "degrees": 80}}
        self.curves("figure5", rough, ways, (112, 120), [(0, 8)], end, (-0.5, 13.5, -0.6, 7.4))

    # Table 1

    def table_1(self):
        """Of the paper's sizes: seconds to factor, and to solve for one coordinate; medians of seven."""
        made = {1201: "head", 3395: "head", 4685: "creature", 12774: "creature", 16792: "arm", 32280: "field"}
        real = {1201: ("mannequin.off", 8624), 3395: ("mannequin.off", 8624), 4685: ("octopus.off", 3175),
                12774: ("octopus.off", 3175), 32280: ("bumpy_plane.off", 20200)}
        tips = {"head": (0, -0.13, 1.2), "creature": (-2.2, 0.6, 0), "arm": (10, 0, 0), "field": (2, 1, 0)}
        rows = ["| region vertices | factor, paper | solve, paper | mesh | factor | solve | factor, times as fast | solve |",
                "|---:|---:|---:|---|---:|---:|---:|---:|"]
        for count, factor, solve in TABLE_1:
            places = [(made[count], None)] + ([real[count]] if self.given.meshes and count in real else [])
            for name, handle in places:
                mesh = self.made(name) if handle is None else self.real(name)
                handle = mesh.nearest(tips[name]) if handle is None else handle
                step = {"region": {"radius": mesh.radius_of([handle], count)}, **UNROTATED,
                        "handles": [{"vertices": str(handle), "translation": [0.01, 0.02, 0.03]}]}
                times = []
                for _ in range(7):
                    report = self.edited(mesh, "table1", [step])[1][0]
                    found = report["handle"] + report["free"] + report["anchors"]
                    assert abs(found - count) <= 5, (name, count, found)  # some are as far from the handle as others
                    spent = report["milliseconds"]
                    times.append((spent["factorisation"] / 1e3, (spent["rough"] + spent["solve"]) / 3e3))
                ours = [statistics.median(column) for column in zip(*times)]
                rows.append(f"| {count:,} | {factor:.3f} | {solve:.3f} | {name} | {ours[0]:.4f} | {ours[1]:.5f} "
                            f"| {factor / ours[0]:.0f} | {solve / ours[1]:.0f} |")
                print(rows[-1], flush=True)
        (self.output / "table1.md").write_text("\n".join(rows) + "\n")


def main():
    parser = argparse.ArgumentParser()
    for name in ("command", "make-mesh", "output"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--meshes", type=pathlib.Path)
    known = ["figure_1", "figure_2", "figure_4", "figure_5", "figure_6", "figure_7", "figure_8", "table_1"]
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(known))
    given = parser.parse_args()
    if set(given.names) - set(known):
        sys.exit(f"paper.py: give some of {', '.join(known)}")
    paper = Paper(given)
    for name in given.names or known:
        getattr(paper, name)()
        print(name, flush=True)


if __name__ == "__main__":
    main()
