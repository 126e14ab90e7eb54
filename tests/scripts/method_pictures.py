# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts that make pictures and tables of the method share: meshes, edits by laplacian-edit, and pictures."""
import functools
import json
import pathlib
import subprocess
import sys

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "batch"), str(HERE.parent / "hosts")]

import ply_meshes  # noqa: E402
import shapes  # noqa: E402


class Mesh:
    def __init__(self, path):
        self.path = path
        points, self.faces = ply_meshes.read(path)
        self.points = numpy.array(points)

    @functools.cached_property
    def around(self):
        """The neighbours of each vertex."""
        return shapes.neighbours(len(self.points), self.faces)

    def nearest(self, point):
        return int(numpy.linalg.norm(self.points - numpy.array(point), axis=1).argmin())

    def near(self, point, radius):
        """The vertices in a ball."""
        return numpy.nonzero(numpy.linalg.norm(self.points - numpy.array(point), axis=1) < radius)[0].tolist()

    def distances(self, seeds):
        """Along the edges, from the nearest seed."""
        found = shapes.distances(self.points.tolist(), self.around, seeds)
        return numpy.array([found.get(v, numpy.inf) for v in range(len(self.points))])


class Maker:
    """Makes meshes, edits and pictures in a folder."""

    def __init__(self, given):
        self.given = given
        self.output = given.output
        self.output.mkdir(parents=True, exist_ok=True)

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
        away = mesh.distances(seeds)
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


def step(vertices, radius, **more):
    """A step of an edit with one handle; more: its transform and the step's settings."""
    transform = {key: more.pop(key) for key in ("translation", "rotation") if key in more}
    return {"region": {"radius": radius}, "handles": [{"vertices": ",".join(map(str, vertices)), **transform}], **more}


def parsed(parser, names):
    """Adds what all scripts take. @param names  what can be made, all by default. @return the arguments"""
    for name in ("command", "make-mesh", "output"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--meshes", type=pathlib.Path, help="folder of the real meshes; without it theirs are skipped")
    parser.add_argument("names", nargs="*", default=names, metavar="NAME", help=", ".join(names))
    given = parser.parse_args()
    if set(given.names) - set(names):
        parser.error(f"give some of {', '.join(names)}")
    return given
