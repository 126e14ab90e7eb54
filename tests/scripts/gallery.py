#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs edits with each method in the staged meshlabserver, and renders them side by side.

Needs an X server (xvfb-run). gallery.sh prepares what this needs and calls it.
"""
import argparse
import dataclasses
import heapq
import math
import os
import pathlib
import re
import subprocess
import sys

import numpy

HERE = pathlib.Path(__file__).resolve().parent
METHODS = {"linear": {"method": 2}, "paper": {"method": 1}, "default": {}}


@dataclasses.dataclass
class Edit:
    name: str
    mesh: str  # file of the real meshes, or what make_mesh calls it
    handle: tuple  # a point at the handle vertex
    radius: float
    translation: tuple
    toward: tuple  # from the mesh to the eye
    group: float = 0  # all this near to the point are the handle, not one vertex
    turn: tuple = ((0, 0, 1), 0)  # axis and degrees
    up: tuple = (0, 0, 1)
    around: tuple = ()  # part to show
    settings: dict = dataclasses.field(default_factory=dict)  # other parameters of the filter


NOSE = {"handle": (0.0185447, -1.24318, -0.0873), "translation": (0, -0.9, 0), "toward": (0.9, -0.55, 0.15)}
IGEA = {"handle": (0.002468, -0.012772, 0.049538), "translation": (0, 0, 0.02), "toward": (0.9, 0.1, 0.6),
        "up": (0, 1, 0)}
EAR = {"handle": (-0.0175221, 0.187321, -0.0198494), "radius": 0.06, "toward": (0.5, 0.15, 1), "up": (0, 1, 0),
       "around": (-0.03, 0.14, 0, 0.075)}
TENTACLE = {"handle": (0.326838, -0.31208, 0.174829), "toward": (0.5, 0.45, -0.9), "up": (0, 1, 0),
            "around": (0.23, -0.06, 0.05, 0.31)}
LETTERS = {"handle": (2.05, 0.9, 0.12), "radius": 1.8, "toward": (0.3, -0.9, 0.75)}
LIMB = {"handle": (10, 0, 0), "toward": (0.2, -0.9, -0.5)}


def limb_bent(degrees):
    """The end, about whose middle it is turned, as it is if the limb becomes an arc, from its root on."""
    angle, along, end = math.radians(degrees), 7.3, 0.5
    way = (along * (math.sin(angle) / angle - 1) + end * (math.cos(angle) - 1), 0,
           along * (1 - math.cos(angle)) / angle + end * math.sin(angle))
    return Edit(f"limb-{degrees}", "arm", radius=7.5, group=1, translation=way, turn=((0, -1, 0), degrees), **LIMB)


EDITS = [
    limb_bent(90),
    limb_bent(120),
    limb_bent(170),
    Edit("limb-pulled", "arm", radius=9, translation=(-3, 0, 5), **LIMB),
    Edit("letters", "letters", translation=(0, 0, 1), **LETTERS),
    Edit("letters-sideways", "letters", translation=(0.8, 0, 1), **LETTERS),
    Edit("letters-turned", "letters", translation=(0, 0, 0.6), group=0.5, turn=((0, 1, 0), 40), **LETTERS),
    Edit("mannequin-nose", "mannequin.off", radius=0.61167, **NOSE),
    Edit("mannequin-face", "mannequin.off", radius=1.2155, **NOSE),
    Edit("octopus-tentacle", "octopus.off", radius=0.8, translation=(0, 0.437, 0), **TENTACLE),
    Edit("octopus-beyond-root", "octopus.off", radius=0.985, translation=(0, 0.437, 0), **TENTACLE),
    Edit("octopus-turned", "octopus.off", radius=0.8, translation=(0, 0.3, 0), group=0.08,
         turn=((-0.65, 0, 0.76), 90), **TENTACLE),
    Edit("bumpy-plane", "bumpy_plane.off", (50, 50, 10), 40, (0, 0, 42.5), (0.3, -0.9, 0.6)),
    Edit("bunny-ear", "bunny.ply", translation=(0.03, -0.05, 0.03), **EAR),
    Edit("bunny-ear-turned", "bunny.ply", translation=(0.015, -0.015, 0.03), group=0.014, turn=((1, 0, 0), 75), **EAR),
    Edit("igea-nose", "igea.ply", radius=0.02, around=(0, -0.01, 0.05, 0.04), **IGEA),
    Edit("igea-face", "igea.ply", radius=0.0374, around=(0, -0.01, 0.05, 0.055), **IGEA),
]


def meshlabserver(stage, mesh, output, script=None):
    """@return what the program printed"""
    command = [stage / "bin" / "meshlabserver", "-i", mesh, "-o", output] + (["-s", script] if script else [])
    pathlib.Path(output).unlink(missing_ok=True)
    done = subprocess.run(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    text = done.stdout.decode(errors="replace")
    if done.returncode != 0 or not pathlib.Path(output).exists():
        sys.exit(f"gallery.py: exit code {done.returncode} of {' '.join(map(str, command))}\n{text}")
    return text


def read_mesh(path):
    """@return points, corners of the triangles"""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOPLY import vtkPLYReader
    reader = vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    surface = reader.GetOutput()
    return (vtk_to_numpy(surface.GetPoints().GetData()).astype(float),
            vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3))


def distances(points, faces, seeds):
    """Along the edges, from the nearest seed."""
    edges = numpy.unique(numpy.sort(numpy.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])), axis=0)
    lengths = numpy.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    around = [[] for _ in points]
    for (a, b), length in zip(edges.tolist(), lengths.tolist()):
        around[a].append((b, length))
        around[b].append((a, length))
    found = numpy.full(len(points), numpy.inf)
    found[seeds] = 0
    queue = [(0.0, int(seed)) for seed in seeds]
    while queue:
        so_far, vertex = heapq.heappop(queue)
        if so_far > found[vertex]:
            continue
        for other, length in around[vertex]:
            if so_far + length < found[other]:
                found[other] = so_far + length
                heapq.heappush(queue, (so_far + length, other))
    return found


def vertex_classes(mesh, edit):
    """0 fixed, 1 anchor, 2 free, 3 handle, per vertex."""
    points, faces = read_mesh(mesh)
    used = numpy.unique(faces)
    away = numpy.linalg.norm(points[used] - numpy.array(edit.handle), axis=1)
    seeds = used[away < edit.group] if edit.group else used[[away.argmin()]]
    distance = distances(points, faces, seeds)
    region = distance <= edit.radius
    anchor = region & (distance > (1 - edit.settings.get("padding", 0.1)) * edit.radius)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        for at, other in ((a, b), (b, a)):
            rim = region[faces[:, at]] & ~region[faces[:, other]]
            anchor[faces[rim, at]] = True
    classes = numpy.where(region, 2, 0)
    classes[anchor] = 1
    classes[seeds] = 3
    return classes


def show(edit, source, given):
    """@return for each way: RMS stretch in % / largest / triangles folded over"""
    from host import laplacian_edit, select_vertices  # tests/batch, which main() has made known
    folder = given.output / edit.name
    folder.mkdir(parents=True, exist_ok=True)
    before = folder / "before.ply"
    meshlabserver(given.stage, source, before)
    classes = folder / "classes.txt"
    numpy.savetxt(classes, vertex_classes(before, edit), fmt="%d")
    panels = [(before, "before", classes)]
    x, y, z = edit.handle
    group = select_vertices(f"(x-({x}))*(x-({x}))+(y-({y}))*(y-({y}))+(z-({z}))*(z-({z})) < {edit.group ** 2}")
    cells = []
    for caption, method in METHODS.items():
        parameters = {**edit.settings, **method, "handle_point": edit.handle, "radius": edit.radius,
                      "translation": edit.translation, "rotation_axis": edit.turn[0], "rotation_angle": edit.turn[1],
                      "handle_source": 1 if edit.group else 0}
        script = folder / f"{caption.replace(' ', '_')}.mlx"
        script.write_text("<!DOCTYPE FilterScript>\n<FilterScript>\n" + (group if edit.group else "")
                          + laplacian_edit(**parameters) + "\n</FilterScript>\n")
        text = meshlabserver(given.stage, before, script.with_suffix(".ply"), script)
        report = re.search(r"Region:.*\n.*\n.*\n(.*)\n(.*)\nMilliseconds:.*", text)
        print(f"{edit.name}, {caption}: " + ("; ".join(report.groups()) if report else "no report"), flush=True)
        cells.append("/".join(re.search(r"stretch: RMS (\S+) %, largest (\S+) %(?s:.*)folded over: (\d+)", text).groups()))
        panels.append((script.with_suffix(".ply"), caption))
    picture = given.output / f"{edit.name}.png"
    command = [HERE.parents[1] / "common/demo/render.py", picture, "--toward", *edit.toward, "--up", *edit.up,
               "--height", given.height, "--columns", given.columns]
    command += ["--around", *edit.around] if edit.around else []
    command += [word for panel in panels for word in ("--panel", *panel)]
    subprocess.run(list(map(str, command)), check=True)
    print(picture, flush=True)
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stage", type=pathlib.Path, required=True, help="made by common/demo/stage.sh")
    parser.add_argument("--make-mesh", required=True, help="the built program")
    parser.add_argument("--meshes", type=pathlib.Path,
                        help="folder of the real meshes; without it their edits are left out")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--height", type=int, default=460)
    parser.add_argument("--columns", type=int, default=2)
    parser.add_argument("names", nargs="*", help="edits to show, all by default: " + " ".join(e.name for e in EDITS))
    given = parser.parse_args()
    os.environ["LAPEDIT_STAGE"] = str(given.stage)
    sys.path.insert(0, str(HERE.parent / "batch"))
    unknown = set(given.names) - {edit.name for edit in EDITS}
    if unknown:
        parser.error("no such edit: " + " ".join(sorted(unknown)))
    given.output.mkdir(parents=True, exist_ok=True)
    rows = [["edit", *METHODS], ["---"] * (1 + len(METHODS))]
    for edit in EDITS:
        if given.names and edit.name not in given.names:
            continue
        if "." not in edit.mesh:
            source = given.output / f"{edit.mesh}.ply"
            subprocess.run([given.make_mesh, edit.mesh, source], check=True)
        elif given.meshes:
            source = given.meshes / edit.mesh
        else:
            print(f"{edit.name}: left out, needs {edit.mesh}")
            continue
        rows.append([edit.name, *show(edit, source, given)])
    print("\n" + "\n".join("|" + "|".join(row) + "|" for row in rows))


if __name__ == "__main__":
    main()
