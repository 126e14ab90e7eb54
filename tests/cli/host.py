# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs filters without a window, for tests: by MeshLab 2020.09's meshlabserver on a private X server, or in later versions
by tests/compat/run_filters.

Environment:
  LAPEDIT_STAGE        folder made by stage.sh, with meshlabserver if there is one
  LAPEDIT_RUN_FILTERS  the tool run_filters, where there is no meshlabserver
  LAPEDIT_FILTERS      the plugin with the filters, for that tool
  LAPEDIT_COMMAND      the program laplacian-edit
  LAPEDIT_SCALAR       the type of MeshLab's coordinates: float or double
  LAPEDIT_MESHES       folder with the real test meshes (tests that use them)
  LAPEDIT_PRELOAD      libraries to load into MeshLab: a sanitizer's run time
"""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
from xml.sax.saxutils import escape, quoteattr

from ply import write_ply
from shapes import dome
from x_server import host_environment, start_x_server

STAGE = pathlib.Path(os.environ.get("LAPEDIT_STAGE", "."))
COMMAND = os.environ.get("LAPEDIT_COMMAND")
TOOL = os.environ.get("LAPEDIT_RUN_FILTERS")
CENTRE = 21 * 10 + 10  # vertex in the middle of the dome
UP = (0, 0, 0.2)


def point(name, xyz):
    return f'<Param type="RichPoint3f" name="{name}" x="{xyz[0]}" y="{xyz[1]}" z="{xyz[2]}"/>'


def number(kind):
    return lambda name, value: f'<Param type="{kind}" name="{name}" value="{value}"/>'


def choice(name, value):
    return f'<Param type="RichEnum" name="{name}" value="{value}" enum_cardinality="4"/>'


def length(name, value):
    return f'<Param type="RichAbsPerc" name="{name}" value="{value}" min="0" max="100"/>'


real, integer = number("RichFloat"), number("RichInt")

# Order and names are part of the interface: meshlabserver requires every parameter in a script.
EDIT_PARAMETERS = {
    "handle_source": (choice, 0), "handle_point": (point, (0, 0, 0)), "handle_vertex": (integer, 0),
    "region_source": (choice, 0),
    "radius": (length, 1), "padding": (real, 0.1), "translation": (point, (0, 0, 0)),
    "rotation_axis": (point, (0, 0, 1)), "rotation_angle": (real, 0), "scale": (real, 1), "method": (choice, 0),
    "laplacian": (choice, 0), "order": (integer, 1), "membrane": (real, -1)}


def laplacian_edit(**given):
    unknown = set(given) - set(EDIT_PARAMETERS)
    assert not unknown, unknown
    lines = [write(name, given.get(name, value)) for name, (write, value) in EDIT_PARAMETERS.items()]
    return '<filter name="Laplacian Edit">' + "\n".join(lines) + "</filter>"


def replay(edit, fraction=1):
    """edit: a JSON text or path as it is, or the members of an edit's only step."""
    if isinstance(edit, dict):
        edit = json.dumps({"laplacian_edit": 1, "steps": [edit]})
    value = quoteattr(str(edit), {"\n": "&#10;", "\t": "&#9;"})
    return (f'<filter name="Laplacian Edit Replay"><Param type="RichString" name="edit" value={value}/>'
            + real("fraction", fraction) + "</filter>")


FIT_PARAMETERS = {"scan": (number("RichString"), ""), "mode": (choice, 0), "detail": (real, 0.03), "align": (choice, 0),
                  "landmarks": (choice, 0)}


def laplacian_fit(**given):
    lines = [write(name, given.get(name, value)) for name, (write, value) in FIT_PARAMETERS.items()]
    return '<filter name="Laplacian Fit">' + "\n".join(lines) + "</filter>"


def select(what):
    return lambda condition: (f'<filter name="Conditional {what} Selection"><Param type="RichString" name="condSelect" value='
                              + quoteattr(condition) + "/></filter>")


select_vertices, select_faces = select("Vertex"), select("Face")


def project(*layers):
    """Text of a .mlp project. layers: file and matrix of each, 16 numbers by rows."""
    text = "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n"
    for number, (mesh, matrix) in enumerate(layers):
        rows = "\n".join(" ".join(repr(float(x)) for x in matrix[4 * i:4 * i + 4]) + " " for i in range(4))
        text += (f'  <MLMesh label="layer{number}" filename={quoteattr(str(mesh))}>\n   <MLMatrix44>\n{escape(rows)}\n'
                 "</MLMatrix44>\n  </MLMesh>\n")
    return text + " </MeshGroup>\n</MeshLabProject>\n"


class Result:
    def __init__(self, done, output):
        self.code = done.returncode
        self.errors = done.stderr.decode(errors="replace")
        self.text = done.stdout.decode(errors="replace") + self.errors
        self.output = output if output.exists() else None  # path of the mesh that was written


class HostTest(unittest.TestCase):
    """A test case with its own folder and home, and with its own X server if `screen` has a size."""
    screen = None

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="lapedit-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.runs = 0
        cls.environment = host_environment(start_x_server(cls.addClassCleanup, cls.screen) if cls.screen else "", cls.folder)


class FilterHost(HostTest):
    screen = None if TOOL else "640x480"

    def run_host(self, filters, mesh=None, save=(), project_text=None, project_out=None):
        """Opens mesh or project, runs the filters, writes a binary PLY.
        @param save  attributes to write besides coordinates and faces, in meshlabserver's words; run_filters writes all"""
        cls = type(self)
        cls.runs += 1
        base = cls.folder / f"run{cls.runs}"
        script, output = base.with_suffix(".mlx"), base.with_suffix(".ply")
        script.write_text("<!DOCTYPE FilterScript>\n<FilterScript>\n" + "\n".join(filters) + "\n</FilterScript>\n")
        if TOOL:
            command = [TOOL, os.environ["LAPEDIT_FILTERS"], mesh or "", output, script]
        else:
            command = [STAGE / "bin" / "meshlabserver"] + (["-i", mesh] if mesh else [])
            if project_text is not None:
                base.with_suffix(".mlp").write_text(project_text)
                command += ["-p", base.with_suffix(".mlp")]
            command += ["-o", output, *(["-m", *save] if save else []), *(["-w", project_out] if project_out else [])]
            command += ["-s", script] if filters else []
        done = subprocess.run(list(map(str, command)), env=self.environment, cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
        return Result(done, output)

    def edited(self, filters, mesh, **options):
        """Runs filters that must work. @return the path of the mesh written, the text printed"""
        result = self.run_host(filters, mesh, **options)
        self.assertEqual(result.code, 0, result.text)
        self.assertIsNotNone(result.output, result.text)
        return result.output, result.text

    def assert_refused(self, result, sentence):
        """The exit code, no output, and one sentence, in the log or on the standard error, that matches the pattern."""
        self.assertEqual(result.code, 1 if TOOL else 255, result.text)
        self.assertIsNone(result.output, result.text)
        message = result.errors.removesuffix("\n")
        if not TOOL:
            self.assertIn("Problem with filter: Laplacian Edit", result.text)
            entries = result.text.split("LOG: 1 ")[1:]
            self.assertEqual(len(entries), 1, result.text)
            message = entries[0].splitlines()[0]
        self.assertRegex(message, sentence)
        self.assertRegex(message, r"\A[^\n]+\.\Z")


class DomeHost(FilterHost):
    """Lifts the middle of a dome."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points, cls.faces = dome()
        cls.mesh = write_ply(cls.folder / "dome.ply", cls.points, cls.faces)
        cls.lift = {"handle_point": cls.points[CENTRE], "radius": 0.35, "translation": UP}
        cls.lift_json = {"region": {"radius": 0.35}, "handles": [{"vertices": str(CENTRE), "translation": UP}]}
