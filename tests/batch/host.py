# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs filters without a window, for tests: by the staged meshlabserver on a private X server, or by laplacian-edit.

Environment:
  LAPEDIT_STAGE    folder made by stage.sh
  LAPEDIT_COMMAND  the program laplacian-edit
  LAPEDIT_RUNNER   "command": laplacian-edit, also where there is a meshlabserver
  LAPEDIT_SCALAR   what the host stores coordinates in: float or double
  LAPEDIT_MESHES   folder with the real test meshes (tests that use them)
  LAPEDIT_PRELOAD  libraries to load into the host: a sanitizer's run time
"""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
from xml.sax.saxutils import escape, quoteattr

from x_server import host_environment, start_x_server

STAGE = pathlib.Path(os.environ["LAPEDIT_STAGE"])
COMMAND = os.environ.get("LAPEDIT_COMMAND")
BY_COMMAND = os.environ.get("LAPEDIT_RUNNER") == "command" or not (STAGE / "bin" / "meshlabserver").exists()
REFUSED = 1 if BY_COMMAND else 255  # exit code for a filter that refuses its work


def point(name, xyz):
    return f'<Param type="RichPoint3f" name="{name}" x="{xyz[0]}" y="{xyz[1]}" z="{xyz[2]}"/>'


def number(kind):
    return lambda name, value: f'<Param type="{kind}" name="{name}" value="{value}"/>'


def choice(name, value):
    return f'<Param type="RichEnum" name="{name}" value="{value}" enum_cardinality="3"/>'


def length(name, value):
    return f'<Param type="RichAbsPerc" name="{name}" value="{value}" min="0" max="100"/>'


real, integer = number("RichFloat"), number("RichInt")

# Order and names are part of the interface: meshlabserver wants every parameter in a script.
EDIT_PARAMETERS = {
    "handle_source": (choice, 0), "handle_point": (point, (0, 0, 0)), "handle_vertex": (integer, 0),
    "region_source": (choice, 0),
    "radius": (length, 1), "padding": (real, 0.1), "translation": (point, (0, 0, 0)),
    "rotation_axis": (point, (0, 0, 1)), "rotation_angle": (real, 0), "scale": (real, 1), "laplacian": (choice, 2),
    "order": (integer, 1), "detail_rotation": (choice, 3), "iterations": (integer, 0), "normal_radius": (length, 0),
    "handle_weight": (real, 30), "anchor_weight": (real, 30),
    "turning": (choice, 1), "rough": (choice, 0), "membrane": (real, 500)}


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


def select_vertices(condition):
    return ('<filter name="Conditional Vertex Selection"><Param type="RichString" name="condSelect" value='
            + quoteattr(condition) + "/></filter>")


def select_faces(condition):
    return ('<filter name="Conditional Face Selection"><Param type="RichString" name="condSelect" value='
            + quoteattr(condition) + "/></filter>")


def project(mesh, matrix):
    """Text of a .mlp project with one layer; matrix: 16 numbers by rows."""
    rows = "\n".join(" ".join(repr(float(x)) for x in matrix[4 * i:4 * i + 4]) + " " for i in range(4))
    return ('<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n'
            f'  <MLMesh label="layer" filename={quoteattr(str(mesh))}>\n   <MLMatrix44>\n{escape(rows)}\n'
            '</MLMatrix44>\n  </MLMesh>\n </MeshGroup>\n</MeshLabProject>\n')


class Result:
    def __init__(self, code, text, output):
        self.code = code
        self.text = text  # what was printed, both streams
        self.output = output  # path of the mesh that was written, None if there is none


def without_display(environment):
    return {name: value for name, value in environment.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


class HostTest(unittest.TestCase):
    """A test case with its own folder and home, and with its own X server if it needs one."""
    screen = None if BY_COMMAND else "640x480"

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="lapedit-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.runs = 0
        display = start_x_server(cls.addClassCleanup, cls.screen) if cls.screen else ""
        cls.environment = host_environment(display, cls.folder)

    def run_host(self, filters, mesh=None, save=(), project_text=None, project_out=None):
        """Opens mesh or project, runs the filters, writes a binary PLY.
        @param save  what else than coordinates and faces is written, in meshlabserver's words; laplacian-edit writes
                     all that there is, normals and selection only if they are among these"""
        cls = type(self)
        cls.runs += 1
        base = cls.folder / f"run{cls.runs}"
        base.with_suffix(".mlx").write_text(
            "<!DOCTYPE FilterScript>\n<FilterScript>\n" + "\n".join(filters) + "\n</FilterScript>\n")
        if BY_COMMAND:
            self.assertIsNone(project_text or project_out, "laplacian-edit opens no projects")
            return self._run_command(base, mesh, save)
        return self._run_meshlabserver(base, filters, mesh, save, project_text, project_out)

    def _run_command(self, base, mesh, save):
        also = [word for word, flags in (("normals", {"vn", "fn"}), ("selection", {"vf", "ff"})) if flags & set(save)]
        output = base.with_suffix(".ply")
        command = [COMMAND, str(mesh), str(output), f"{base}.mlx"] + (["--also", ",".join(also)] if also else [])
        done = subprocess.run(command, env=without_display(self.environment), cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
        result = Result(done.returncode, (done.stdout + done.stderr).decode(errors="replace"),
                        output if output.exists() else None)
        result.errors = done.stderr.decode(errors="replace")
        return result

    def _run_meshlabserver(self, base, filters, mesh, save, project_text, project_out):
        command = [str(STAGE / "bin" / "meshlabserver")]
        if project_text is not None:
            base.with_suffix(".mlp").write_text(project_text)
            command += ["-p", f"{base}.mlp"]
        if mesh is not None:
            command += ["-i", str(mesh)]
        output = base.with_suffix(".ply")
        if project_out is None:
            command += ["-o", str(output)] + (["-m", *save] if save else [])
        else:
            command += ["-w", str(project_out)]
        if filters:
            command += ["-s", f"{base}.mlx"]
        done = subprocess.run(command, env=self.environment, cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=120)
        return Result(done.returncode, done.stdout.decode(errors="replace"), output if output.exists() else None)

    def edited(self, filters, mesh, **options):
        """Runs filters that must work. @return the path of the mesh written, the text printed"""
        result = self.run_host(filters, mesh, **options)
        self.assertEqual(result.code, 0, result.text)
        self.assertIsNotNone(result.output, result.text)
        return result.output, result.text

    def assert_refused(self, result, sentence):
        """The exit code, no output, and one sentence, in the log or on the standard error, that matches the pattern."""
        self.assertEqual(result.code, REFUSED, result.text)
        self.assertIsNone(result.output, result.text)
        if BY_COMMAND:
            self.assertRegex(result.errors, r"\A[^\n]+\.\n\Z")
            self.assertRegex(result.errors, sentence)
            return
        self.assertIn("Problem with filter: Laplacian Edit", result.text)
        entries = result.text.split("LOG: 1 ")[1:]
        self.assertEqual(len(entries), 1, result.text)
        line = entries[0].splitlines()[0]
        self.assertRegex(line, sentence)
        self.assertRegex(line, r"\.$")
