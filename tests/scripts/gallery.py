#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs edits with each kind of detail rotation in the staged meshlabserver and renders them beside each other.

Needs an X server (xvfb-run). gallery.sh prepares what this needs and calls it.
"""
import argparse
import dataclasses
import os
import pathlib
import re
import subprocess
import sys

import numpy

HERE = pathlib.Path(__file__).resolve().parent
ROTATIONS = ["none", "smooth normals", "smooth surface"]  # in the order of the filter's choices


@dataclasses.dataclass
class Edit:
    name: str
    mesh: str  # file of the real meshes, or what make_mesh calls it
    handle: tuple  # a point at the handle vertex
    radius: float
    translation: tuple
    toward: tuple  # from the mesh to the eye
    up: tuple = (0, 0, 1)
    around: tuple = ()  # part to show
    settings: dict = dataclasses.field(default_factory=dict)  # other parameters of the filter


NOSE = ((0.0185447, -1.24318, -0.0873), (0, -0.9, 0), (0.9, -0.55, 0.15))
TENTACLE = ((0.326838, -0.31208, 0.174829), (0, 0.437, 0), (0.5, 0.45, -0.9), (0, 1, 0), (0.23, -0.04, 0.05, 0.26))
EDITS = [
    Edit("letters", "letters", (2.05, 0.9, 0.12), 1.8, (0, 0, 1), (0.3, -0.9, 0.75)),
    Edit("letters-sideways", "letters", (2.05, 0.9, 0.12), 1.8, (0.8, 0, 1), (0.3, -0.9, 0.75)),
    Edit("arm", "arm", (10, 0, 0), 9, (-3, 0, 5), (0.2, -0.9, -0.5)),
    Edit("mannequin-nose", "mannequin.off", NOSE[0], 0.61167, NOSE[1], NOSE[2]),
    Edit("mannequin-face", "mannequin.off", NOSE[0], 1.2155, NOSE[1], NOSE[2]),
    Edit("octopus-tentacle", "octopus.off", TENTACLE[0], 0.8, TENTACLE[1], *TENTACLE[2:]),
    Edit("octopus-beyond-root", "octopus.off", TENTACLE[0], 0.985, TENTACLE[1], *TENTACLE[2:]),
    Edit("bumpy-plane", "bumpy_plane.off", (50, 50, 10), 40, (0, 0, 42.5), (0.3, -0.9, 0.6)),
    Edit("bunny-ear", "bunny.ply", (-0.0175221, 0.187321, -0.0198494), 0.06, (0.03, -0.05, 0.03), (0.5, 0.15, 1),
         (0, 1, 0), (-0.03, 0.14, 0, 0.075)),
    Edit("igea-nose", "igea.ply", (0.002468, -0.012772, 0.049538), 0.02, (0, 0, 0.02), (0.9, 0.1, 0.6), (0, 1, 0),
         (0, -0.01, 0.05, 0.04)),
    Edit("igea-face", "igea.ply", (0.002468, -0.012772, 0.049538), 0.0374, (0, 0, 0.02), (0.9, 0.1, 0.6), (0, 1, 0),
         (0, -0.01, 0.05, 0.055)),
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


def vertex_classes(mesh, handle, radius, padding):
    """0 fixed, 1 anchor, 2 free, 3 handle, per vertex."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkDoubleArray
    from vtkmodules.vtkFiltersModeling import vtkDijkstraGraphGeodesicPath
    from vtkmodules.vtkIOPLY import vtkPLYReader
    reader = vtkPLYReader()
    reader.SetFileName(str(mesh))
    reader.Update()
    surface = reader.GetOutput()
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    used = numpy.unique(faces)
    away = numpy.linalg.norm(vtk_to_numpy(surface.GetPoints().GetData())[used] - numpy.array(handle), axis=1)
    seed = used[away.argmin()]
    paths = vtkDijkstraGraphGeodesicPath()
    paths.SetInputData(surface)
    paths.SetStartVertex(seed)
    paths.SetEndVertex(seed)
    paths.StopWhenEndReachedOff()
    paths.Update()
    lengths = vtkDoubleArray()
    paths.GetCumulativeWeights(lengths)
    distance = vtk_to_numpy(lengths).copy()
    distance[distance < 0] = numpy.inf  # not reached
    region = distance <= radius
    anchor = region & (distance > (1 - padding) * radius)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        for at, other in ((a, b), (b, a)):
            rim = region[faces[:, at]] & ~region[faces[:, other]]
            anchor[faces[rim, at]] = True
    classes = numpy.where(region, 2, 0)
    classes[anchor] = 1
    classes[seed] = 3
    return classes


def show(edit, source, given):
    from host import laplacian_edit  # tests/host, whose folder main() has made known
    folder = given.output / edit.name
    folder.mkdir(parents=True, exist_ok=True)
    before = folder / "before.ply"
    meshlabserver(given.stage, source, before)
    classes = folder / "classes.txt"
    padding = edit.settings.get("padding", 0.1)
    numpy.savetxt(classes, vertex_classes(before, edit.handle, edit.radius, padding), fmt="%d")
    panels = [(before, "before", classes)]
    for number, rotation in enumerate(ROTATIONS):
        parameters = dict(edit.settings, handle_point=edit.handle, radius=edit.radius, translation=edit.translation,
                          detail_rotation=number)
        script = folder / f"{rotation.replace(' ', '_')}.mlx"
        script.write_text("<!DOCTYPE FilterScript>\n<FilterScript>\n" + laplacian_edit(**parameters)
                          + "\n</FilterScript>\n")
        text = meshlabserver(given.stage, before, script.with_suffix(".ply"), script)
        report = re.search(r"Region:.*\n.*\n.*\n(.*)\n(Milliseconds:.*)", text)
        print(f"{edit.name}, {rotation}: {report.group(1) if report else 'no report'}", flush=True)
        panels.append((script.with_suffix(".ply"), rotation))
    picture = given.output / f"{edit.name}.png"
    command = [HERE.parents[1] / "common/demo/render.py", picture, "--toward", *edit.toward, "--up", *edit.up,
               "--height", given.height, "--columns", given.columns]
    command += ["--around", *edit.around] if edit.around else []
    command += [word for panel in panels for word in ("--panel", *panel)]
    subprocess.run(list(map(str, command)), check=True)
    print(picture, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stage", type=pathlib.Path, required=True, help="made by common/demo/stage.sh")
    parser.add_argument("--make-mesh", required=True, help="the built program")
    parser.add_argument("--meshes", type=pathlib.Path, help="folder of the real meshes; without it their edits are left out")
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
        show(edit, source, given)


if __name__ == "__main__":
    main()
