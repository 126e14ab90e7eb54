#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the paper's figures and its Table 1 anew, by laplacian-edit, on generated meshes and on real ones if there are.

Needs an X server (xvfb-run). gallery.sh prepares what this needs and calls it.
"""
import argparse
import statistics

import numpy

from method_pictures import Maker, Mesh, parsed, ply_meshes, step

# The paper's settings, and ours.
UNROTATED = {"method": "linear"}
ROTATED = {"method": "paper"}
DEFAULT = {}
# Table 1: vertices of the region, and seconds to factor and to solve for one coordinate on a Pentium 4 of 2.4 GHz.
TABLE_1 = ((1201, 0.031, 0.002), (3395, 0.051, 0.003), (4685, 0.092, 0.005), (12774, 0.568, 0.020),
           (16792, 0.804, 0.030), (32280, 1.863, 0.069))
COLOURS = ("#d55e00", "#0072b2", "#009e73")  # of Okabe and Ito


def front(mesh, x, y, direction=2, width=0.04):
    """The vertex that is farthest along a coordinate near a position of the two others."""
    a, b = [k for k in range(3) if k != direction]
    near = numpy.nonzero((abs(mesh.points[:, a] - x) < width) & (abs(mesh.points[:, b] - y) < width))[0]
    return int(near[mesh.points[near, direction].argmax()])


def radius_of(mesh, seeds, count):
    """Of the region that holds so many vertices."""
    found = numpy.sort(mesh.distances(seeds))
    return float((found[count - 1] + found[count]) / 2)


def path_along(mesh, vertices):
    """Vertices of the shortest paths from one to the next."""
    whole = [vertices[0]]
    for end in vertices[1:]:
        away = mesh.distances([end])
        while whole[-1] != end:
            here = whole[-1]
            whole.append(min(mesh.around[here],
                             key=lambda v: away[v] + numpy.linalg.norm(mesh.points[v] - mesh.points[here])))
    return sorted(set(whole))


class Paper(Maker):
    def locality(self, name, mesh, handle, counts, translation, **view):
        """Figures 1 and 7: the same handle moved as far in a small and in a large region."""
        panels = []
        for row, (settings, caption) in enumerate(((ROTATED, "paper"), (DEFAULT, "default"))):
            for count in counts:
                radius = radius_of(mesh, [handle], count)
                one = step([handle], radius, translation=translation, **settings)
                result, _ = self.edited(mesh, f"{name}-{count}-{row}", [one])
                if row == 0:
                    panels.append((mesh.path, f"{count:,} vertices", self.classes(mesh, [handle], radius, f"{name}-{count}")))
                else:
                    panels.append((mesh.path, "before"))
                panels.append((result, caption))
        self.render(name, panels, columns=4, **view)

    def figure_1(self):
        head = self.made("head")
        self.locality("figure1", head, front(head, 0, -0.13, width=0.15), (1201, 3395), [0, 0, 0.7], toward=(0.75, 0.1, 0.7),
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
        letters, arm = self.made("letters"), self.made("arm")
        bend = {"translation": [-2.5, 0, 4.5], "rotation": {"axis": [0, -1, 0], "degrees": 90}}
        for name, mesh, handle, radius, transform, view in (
                ("letters", letters, [letters.nearest((2.05, 0.9, 0.12))], 1.8, {"translation": [0.8, 0, 1]}, (0.3, -0.9, 0.75)),
                ("arm", arm, arm.near((10, 0, 0), 1), 7.5, bend, (0.2, -0.9, -0.5))):
            panels = [(mesh.path, "before")]
            for settings, caption in ((UNROTATED, "no rotation"), (ROTATED, "paper"), (DEFAULT, "default")):
                one = step(handle, radius, **transform, **settings)
                panels.append((self.edited(mesh, f"figure6-{name}-{caption}", [one])[0], caption))
            self.render(f"figure6-{name}", panels, toward=view, up=(0, 0, 1), columns=2)

    def figure_8(self):
        """Five edits; a brow is moved as a curve, a mouth's corners by small handles."""
        head = self.made("head")

        def brow(side):
            return path_along(head, [front(head, side * x, y) for x, y in ((0.62, 0.42), (0.4, 0.47), (0.2, 0.42))])

        def disc(x, y, radius):
            return numpy.nonzero(head.distances([front(head, x, y)]) <= radius)[0].tolist()

        steps = [step(brow(1), 0.4, translation=[0, 0.16, 0.05]), step(brow(-1), 0.35, translation=[0.04, -0.1, 0.06]),
                 step(disc(0.24, -0.5, 0.05), 0.3, translation=[0.1, 0.12, -0.02]),
                 step(disc(-0.24, -0.5, 0.05), 0.3, translation=[-0.06, -0.09, 0]),
                 step([front(head, 0, -0.13, width=0.15)], 0.5, translation=[0.05, 0.05, 0.15])]
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
        ply_meshes.write(path, points, faces)
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
            meshes = [(made[count], None)] + ([real[count]] if self.given.meshes and count in real else [])
            for name, handle in meshes:
                mesh = self.made(name) if handle is None else self.real(name)
                handle = mesh.nearest(tips[name]) if handle is None else handle
                one = step([handle], radius_of(mesh, [handle], count), translation=[0.01, 0.02, 0.03], **UNROTATED)
                times = []
                for _ in range(7):
                    report = self.edited(mesh, "table1", [one])[1][0]
                    found = report["handle"] + report["free"] + report["anchors"]
                    assert abs(found - count) <= 5, (name, count, found)  # some are as far from the handle as others
                    spent = report["milliseconds"]
                    times.append((spent["factorisation"] / 1e3, spent["solve"] / 3e3))
                ours = [statistics.median(column) for column in zip(*times)]
                rows.append(f"| {count:,} | {factor:.3f} | {solve:.3f} | {name} | {ours[0]:.4f} | {ours[1]:.5f} "
                            f"| {factor / ours[0]:.0f} | {solve / ours[1]:.0f} |")
                print(rows[-1], flush=True)
        (self.output / "table1.md").write_text("\n".join(rows) + "\n")


def main():
    known = ["figure_1", "figure_2", "figure_4", "figure_5", "figure_6", "figure_7", "figure_8", "table_1"]
    paper = Paper(parsed(argparse.ArgumentParser(), known))
    for name in paper.given.names:
        getattr(paper, name)()
        print(name, flush=True)


if __name__ == "__main__":
    main()
