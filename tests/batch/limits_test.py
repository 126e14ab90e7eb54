# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit where a machine, a shell or a cluster's queue grants little: it ends, with the same bits."""
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import unittest

from host import COMMAND, HostTest, without_display
from ply import Ply, write_ply
from shapes import dome

CENTRE = 21 * 10 + 10  # vertex in the middle of the dome
KILOBYTE, GIGABYTE = 2**10, 2**30
# A library that spins or hangs at its start would do so for ever.
SECONDS = 300


@unittest.skipIf(os.environ.get("LAPEDIT_PRELOAD"), "a sanitizer wants terabytes of addresses for itself")
class LimitsTest(HostTest):
    screen = None

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = write_ply(cls.folder / "dome.ply", *dome())
        cls.edit = cls.folder / "edit.json"
        cls.edit.write_text(json.dumps({"laplacian_edit": 1, "steps": [
            {"region": {"radius": 0.35}, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 0.2]}]}]}))
        cls.expected = cls.edited({}, "unlimited.ply")

    @classmethod
    def run_limited(cls, limits, *arguments, **environment):
        """limits: resource -> bytes. @return exit code and all that was said"""
        def limit():
            for what, size in limits.items():
                resource.setrlimit(what, (size, resource.getrlimit(what)[1]))

        process = subprocess.run([COMMAND, *map(str, arguments)], preexec_fn=limit, timeout=SECONDS,
                                 env={**without_display(cls.environment), **environment}, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return process.returncode, process.stdout.decode()

    @classmethod
    def edited(cls, limits, name, **environment):
        output = cls.folder / name
        code, text = cls.run_limited(limits, cls.mesh, output, cls.edit, **environment)
        assert code == 0, (code, text)
        return Ply(output).point_bits()

    def test_address_space_as_a_queue_grants_it(self):
        """Two threads of a BLAS, were there one, would wait for ever for memory that they cannot have."""
        little = {resource.RLIMIT_AS: 409600 * KILOBYTE}
        for threads in ("1", "2", "8"):
            with self.subTest(threads=threads):
                code, text = self.run_limited(little, "--version", OPENBLAS_NUM_THREADS=threads)
                self.assertEqual(code, 0, text)
                self.assertEqual(self.edited(little, f"little_{threads}.ply", OPENBLAS_NUM_THREADS=threads),
                                 self.expected)

    def test_no_room_for_the_stack_of_another_thread(self):
        if 0 <= resource.getrlimit(resource.RLIMIT_STACK)[1] < 4 * GIGABYTE:
            self.skipTest("stacks may not be made that large here")
        stack = {resource.RLIMIT_AS: 2 * GIGABYTE, resource.RLIMIT_STACK: 4 * GIGABYTE}
        self.assertEqual(self.edited(stack, "alone.ply"), self.expected)

    def test_less_and_less_address_space(self):
        """Down to where not even the libraries can be loaded: one message, and nothing or all of the output."""
        for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA):
            for megabytes in (*range(360, 60, -20), 60, 30, 10, 5):
                with self.subTest(kind=kind, megabytes=megabytes):
                    output = self.folder / f"less_{kind}_{megabytes}.ply"
                    code, text = self.run_limited({kind: megabytes * KILOBYTE**2}, self.mesh, output, self.edit)
                    self.assertEqual(output.exists(), code == 0, text)
                    if code == 0:
                        self.assertEqual(Ply(output).point_bits(), self.expected)
                    else:
                        self.assertEqual(code, 5, text)
                        self.assertRegex(text, r"\A[^\n]*: nothing was written; allow more [^\n]*\.\n\Z")

    def test_command_without_its_program(self):
        copied = shutil.copy(COMMAND, self.folder / "copied")
        ended = subprocess.run([copied, "--version"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        self.assertEqual(ended.returncode, 5)
        self.assertRegex(ended.stdout.decode(), r"\AThe program /.*/libexec/laplacian-edit cannot be started \(No such file "
                                                r"or directory\): nothing was written; install laplacian-edit again\.\n\Z")

    def test_nobody_brings_threads_along(self):
        """No BLAS: its threads compute while they wait, and cost address space."""
        program = pathlib.Path(COMMAND).parent / "../libexec/laplacian-edit"
        loaded = subprocess.run(["ldd", program], stdout=subprocess.PIPE, check=True, env={**os.environ, "LC_ALL": "C"})
        self.assertIsNone(re.search(r"lib(openblas|blas|cholmod)\b.*", loaded.stdout.decode()))


if __name__ == "__main__":
    unittest.main()
