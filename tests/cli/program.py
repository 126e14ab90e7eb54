# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program laplacian-edit, for tests.

Environment: LAPEDIT_COMMAND  the program
             LAPEDIT_MESHES   folder with the real test meshes; may be missing
             LAPEDIT_PRELOAD  set where the program has a sanitizer, which takes all address space
"""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from shapes import dome

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import mesh_files as files  # noqa: E402
from mesh_bytes import MeshBytes  # noqa: E402

COMMAND = os.environ["LAPEDIT_COMMAND"]
SANITIZED = bool(os.environ.get("LAPEDIT_PRELOAD"))
CENTRE = 21 * 10 + 10  # vertex in the middle of the dome
NOBODY = 54321  # an ordinary user's number
POSES = 300  # which take long enough to be interrupted
REFUSED, WRONG_USAGE, UNREADABLE, UNWRITABLE, UNEXPECTED, ADVISED = 1, 2, 3, 4, 5, 6
DOME = [struct.unpack("3f", struct.pack("3f", *p)) for p in dome()[0]], dome()[1]
POINTS, FACES = DOME
LIFT = {"region": {"radius": 0.35}, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 0.2]}]}
LEAN = {"region": {"radius": 0.3}, "handles": [{"vertices": "155", "translation": [0.05, 0, 0.1]}]}


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, `work`, in which the program runs; the dome and an edit are beside it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="lapedit-")).resolve()
        self.addCleanup(shutil.rmtree, self.folder)
        self.work = self.folder / "work"
        self.work.mkdir()
        self.mesh = self.folder / "dome.ply"
        self.mesh.write_bytes(files.ply_plain(DOME))
        self.edit = self.write_edit(LIFT)

    def write_edit(self, *steps, name="edit.json"):
        path = self.folder / name
        path.write_text(json.dumps({"laplacian_edit": 1, "steps": steps}))
        return path

    def start(self, *arguments, **options):
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "cwd": self.work}
        return subprocess.Popen([COMMAND, *(a if isinstance(a, bytes) else str(a) for a in arguments)], **{**streams, **options})

    def run_program(self, *arguments, given=None, **options):
        """@return exit code, standard output in bytes, standard error"""
        if given is not None:
            options["stdin"] = subprocess.PIPE
        with self.start(*arguments, **options) as process:
            output, errors = process.communicate(given, timeout=120)
        return process.returncode, output or b"", (errors or b"").decode(errors="replace")

    def done(self, *arguments, **options):
        """Runs what must succeed, without a message. @return the standard output"""
        code, output, errors = self.run_program(*arguments, **options)
        self.assertEqual((code, errors), (0, ""))
        return output if "given" in options else output.decode()

    def refused(self, code, sentence, *arguments, **options):
        """The exit code and one message; no file is created or changed."""
        before = self.snapshot()
        with self.subTest(sentence):
            ended, _, errors = self.run_program(*arguments, **options)
            self.assertEqual(ended, code, errors)
            self.assertRegex(errors, r"\A[^\n]+[.?]\n\Z")
            self.assertRegex(errors, sentence)
            self.assertEqual(self.snapshot(), before)

    def snapshot(self):
        return {str(path): path.read_bytes() if path.is_file() else None for path in self.work.rglob("*")}

    def edited(self, *arguments):
        """@return the bytes of the edited dome"""
        self.done(self.mesh, self.folder / "edited.ply", *(arguments or [self.edit]), "--quiet")
        return (self.folder / "edited.ply").read_bytes()

    def writing(self, *arguments, **options):
        """@return a run that writes for a while, when it has begun to"""
        process = self.start(self.mesh, self.work / "all.ply", self.edit, "--fractions", f"0:1:{POSES}", "--quiet", *arguments, **options)
        end = time.monotonic() + 60
        while len(list(self.work.glob(".laplacian-edit-*"))) < 3:
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.001)
        return process
