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
import tempfile
import time
import unittest

from shapes import dome

COMMAND = os.environ["LAPEDIT_COMMAND"]
SANITIZED = bool(os.environ.get("LAPEDIT_PRELOAD"))
CENTRE = 21 * 10 + 10  # vertex in the middle of the dome
NOBODY = 54321  # an ordinary user's number
REFUSED, WRONG_USAGE, UNREADABLE, UNWRITABLE, UNEXPECTED, ADVISED = 1, 2, 3, 4, 5, 6
POINTS, FACES = dome()
LIFT = {"region": {"radius": 0.35}, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 0.2]}]}
LEAN = {"region": {"radius": 0.3}, "handles": [{"vertices": "155", "translation": [0.05, 0, 0.1]}]}


def ply_text(points, faces, scalar="float"):
    return ("ply\nformat ascii 1.0\n" + f"element vertex {len(points)}\n" + "".join(f"property {scalar} {c}\n" for c in "xyz")
            + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
            + "".join("%r %r %r\n" % tuple(p) for p in points)
            + "".join(" ".join(map(str, (len(f), *f))) + "\n" for f in faces)).encode()


def meshes():
    """The dome in each format; name and bytes."""
    points = [struct.unpack("3f", struct.pack("3f", *p)) for p in POINTS]
    yield "text.ply", ply_text(points, FACES)
    header = ply_text(points, FACES).split(b"end_header")[0].replace(b"ascii", b"binary_little_endian") + b"end_header\n"
    yield "binary.ply", header + b"".join(struct.pack("<3f", *p) for p in points) + b"".join(
        struct.pack("<B3i", 3, *f) for f in FACES)
    yield "text.off", (f"OFF\n{len(points)} {len(FACES)} 0\n" + "".join("%r %r %r\n" % p for p in points)
                       + "".join("3 %d %d %d\n" % f for f in FACES)).encode()
    yield "text.obj", ("".join("v %r %r %r\n" % p for p in points) + "".join(
        "f %d %d %d\n" % tuple(v + 1 for v in f) for f in FACES)).encode()
    yield "binary.stl", bytes(80) + struct.pack("<I", len(FACES)) + b"".join(
        struct.pack("<12fH", 0, 0, 1, *sum((points[v] for v in f), ()), 0) for f in FACES)
    yield "text.stl", ("solid\n" + "".join("facet normal 0 0 1\nouter loop\n" + "".join(
        "vertex %r %r %r\n" % points[v] for v in f) + "endloop\nendfacet\n" for f in FACES) + "endsolid\n").encode()


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, `place`, in which the program runs; the dome and an edit are beside it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="lapedit-")).resolve()
        self.addCleanup(shutil.rmtree, self.folder)
        self.place = self.folder / "place"
        self.place.mkdir()
        self.mesh = self.folder / "dome.ply"
        self.mesh.write_bytes(ply_text(POINTS, FACES))
        self.edit = self.write_edit(LIFT)

    def write_edit(self, *steps, name="edit.json"):
        path = self.folder / name
        path.write_text(json.dumps({"laplacian_edit": 1, "steps": steps}))
        return path

    def start(self, *arguments, **options):
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "cwd": self.place}
        return subprocess.Popen([COMMAND, *(a if isinstance(a, bytes) else str(a) for a in arguments)], **{**streams, **options})

    def run_program(self, *arguments, given=None, **options):
        """@return exit code, standard output in bytes, standard error"""
        if given is not None:
            options["stdin"] = subprocess.PIPE
        with self.start(*arguments, **options) as process:
            try:
                output, errors = process.communicate(given, timeout=120)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
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
        return {str(path): path.read_bytes() if path.is_file() else None for path in self.place.rglob("*")}

    def edited(self, *arguments):
        """@return the bytes of the edited dome"""
        self.done(self.mesh, self.folder / "edited.ply", *(arguments or [self.edit]), "--quiet")
        return (self.folder / "edited.ply").read_bytes()

    def writing(self, *arguments, **options):
        """@return a run that writes for a while, when it has begun to"""
        process = self.start(self.mesh, self.place / "all.ply", self.edit, "--fractions", "0:1:900", "--quiet", *arguments, **options)
        end = time.monotonic() + 60
        while len(list(self.place.glob(".laplacian-edit-*"))) < 3:
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.001)
        return process
