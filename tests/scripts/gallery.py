#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs edits with each method by laplacian-edit, renders them side by side, and prints a table.

Needs an X server (xvfb-run). gallery.sh prepares what this needs and calls it.
"""
import argparse
import dataclasses
import math
import subprocess

from method_pictures import Maker, Mesh, parsed, ply_meshes, step

METHODS = ("linear", "paper", "default")


@dataclasses.dataclass
class Edit:
    name: str
    mesh: str  # file of the real meshes, or what make_mesh calls it
    handle: tuple  # a point at the handle vertex
    radius: float
    translation: tuple
    toward: tuple  # from the mesh to the eye
    group: float = 0  # all this near to the point are the handle, not one vertex
    rotation: tuple = ((0, 0, 1), 0)  # axis and degrees
    up: tuple = (0, 0, 1)
    around: tuple = ()  # part to show


NOSE = {"handle": (0.0185447, -1.24318, -0.0873), "translation": (0, -0.9, 0), "toward": (0.9, -0.55, 0.15)}
TENTACLE = {"handle": (0.326838, -0.31208, 0.174829), "translation": (0, 0.437, 0), "toward": (0.5, 0.45, -0.9),
            "up": (0, 1, 0), "around": (0.23, -0.06, 0.05, 0.31)}
LETTERS = {"handle": (2.05, 0.9, 0.12), "radius": 1.8, "toward": (0.3, -0.9, 0.75)}


def limb_bent(degrees):
    """The end, about whose middle it is rotated, as it is if the limb becomes an arc, from its root on."""
    angle, along, end = math.radians(degrees), 7.3, 0.5
    way = (along * (math.sin(angle) / angle - 1) + end * (math.cos(angle) - 1), 0,
           along * (1 - math.cos(angle)) / angle + end * math.sin(angle))
    return Edit(f"limb-{degrees}", "arm", (10, 0, 0), 7.5, way, (0.2, -0.9, -0.5), group=1, rotation=((0, -1, 0), degrees))


EDITS = [
    limb_bent(120),
    limb_bent(170),
    Edit("letters", "letters", translation=(0, 0, 1), **LETTERS),
    Edit("letters-sideways", "letters", translation=(0.8, 0, 1), **LETTERS),
    Edit("letters-rotated", "letters", translation=(0, 0, 0.6), group=0.5, rotation=((0, 1, 0), 40), **LETTERS),
    Edit("mannequin-nose", "mannequin.off", radius=0.61167, **NOSE),
    Edit("mannequin-face", "mannequin.off", radius=1.2155, **NOSE),
    Edit("octopus-tentacle", "octopus.off", radius=0.8, **TENTACLE),
    Edit("octopus-beyond-root", "octopus.off", radius=0.985, **TENTACLE),
    Edit("bumpy-plane", "bumpy_plane.off", (50, 50, 10), 40, (0, 0, 42.5), (0.3, -0.9, 0.6)),
    Edit("bunny-ear", "bunny.ply", (-0.0175221, 0.187321, -0.0198494), 0.06, (0.03, -0.05, 0.03), (0.5, 0.15, 1),
         up=(0, 1, 0), around=(-0.03, 0.14, 0, 0.075)),
    Edit("igea-nose", "igea.ply", (0.002468, -0.012772, 0.049538), 0.02, (0, 0, 0.02), (0.9, 0.1, 0.6), up=(0, 1, 0),
         around=(0, -0.01, 0.05, 0.04)),
]


def show(edit, maker):
    """@return for each method: RMS stretch in % / largest / triangles folded over"""
    mesh = maker.made(edit.mesh) if "." not in edit.mesh else maker.real(edit.mesh)
    handle = mesh.near(edit.handle, edit.group) if edit.group else [mesh.nearest(edit.handle)]
    axis, degrees = edit.rotation
    rotation = {"rotation": {"axis": axis, "degrees": degrees}} if degrees else {}
    panels, cells = [(mesh.path, "before", maker.classes(mesh, handle, edit.radius, edit.name))], []
    for method in METHODS:
        one = step(handle, edit.radius, translation=edit.translation, method=method, **rotation)
        result, (report,) = maker.edited(mesh, f"{edit.name}-{method}", [one])
        panels.append((result, method))
        cells.append(f"{100 * report['stretch_rms']:.3g}/{100 * report['stretch_max']:.3g}/{report['folded']}")
    maker.render(edit.name, panels, edit.toward, edit.up, maker.given.columns, maker.given.height, edit.around)
    return cells


def show_cells(maker):
    """The cells of the limb, before and after its end is bent back."""
    edit, mesh = limb_bent(170), maker.made("arm")
    handle = mesh.near(edit.handle, edit.group)
    axis, degrees = edit.rotation
    one = step(handle, edit.radius, translation=edit.translation, rotation={"axis": axis, "degrees": degrees})
    result, _ = maker.edited(mesh, "cells", [one])
    colours = maker.output / "cells.txt"
    with colours.open("w") as out:
        subprocess.run([maker.given.cell_colours, str(edit.radius), *map(str, handle)], stdout=out, check=True)
    maker.render("cells", [(mesh.path, "cells at rest", colours), (result, "after the edit", colours)], edit.toward, edit.up, 2,
                 maker.given.height)


def grid(columns, rows, place):
    """Triangles of columns x rows vertices, placed by a function of two numbers from 0 to 1."""
    points = [place(i / (columns - 1), j / (rows - 1)) for j in range(rows) for i in range(columns)]
    corners = [columns * j + i for j in range(rows - 1) for i in range(columns - 1)]
    return points, [face for a in corners for face in ((a, a + 1, a + columns), (a + 1, a + columns + 1, a + columns))]


def show_surface(maker):
    """A sheet of long cells and a tube that is half fine, with weights that depend on the triangles and with those of the surface."""
    def tube(u, v):
        angle = 2 * math.pi * (u % 1)
        return (25 * v if v < 0.2 else 5 + 6.25 * (v - 0.2), math.cos(angle), math.sin(angle))

    panels = []
    for name, shape, handle, motion in (
            ("sheet", grid(21, 81, lambda u, v: (10 * u, 6 * v - 3, 0)), (5, 0, 0), {"translation": (0, 0, 2.5)}),
            ("tube", grid(25, 81, tube), (10, 0, 0), {"rotation": {"axis": (1, 0, 0), "degrees": 270}})):
        path = maker.output / f"surface-{name}.ply"
        ply_meshes.write(path, *shape)
        mesh = Mesh(path)
        grip = [mesh.nearest(handle)] if name == "sheet" else mesh.near((10, 0, 0), 1.3)
        for kind in ("mean_value", "surface"):
            result, _ = maker.edited(mesh, f"surface-{name}-{kind}", [step(grip, 3 if name == "sheet" else 9.5, laplacian=kind, **motion)])
            panels.append((result, kind))
    maker.render("surface", panels, (0.25, -0.6, 0.75), (0, 0, 1), 4, maker.given.height)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--cell-colours", help="the program; draws the cells alone")
    parser.add_argument("--surface", action="store_true", help="the picture of the operator alone")
    parser.add_argument("--height", type=int, default=460)
    parser.add_argument("--columns", type=int, default=2)
    maker = Maker(parsed(parser, [edit.name for edit in EDITS]))
    if maker.given.cell_colours:
        show_cells(maker)
        return
    if maker.given.surface:
        show_surface(maker)
        return
    rows = [["edit", *METHODS], ["---"] * (1 + len(METHODS))]
    for edit in EDITS:
        if edit.name in maker.given.names and (maker.given.meshes or "." not in edit.mesh):
            rows.append([edit.name, *show(edit, maker)])
            print(*rows[-1], flush=True)
    print("\n" + "\n".join("|" + "|".join(row) + "|" for row in rows))


if __name__ == "__main__":
    main()
