# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit where calls of the system fail, disks are full and processes are killed, at random calls and times:
each output is the old one or complete, and the exit code 0 means complete.

LAPEDIT_FAULTS in the environment is the number of runs, by default 40; LAPEDIT_FAULTS_SEED chooses them.
"""
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

from program import COMMAND, DOME, SANITIZED, ProgramTest, files

RUNS = int(os.environ.get("LAPEDIT_FAULTS", "40"))
SEED = int(os.environ.get("LAPEDIT_FAULTS_SEED", "28"))
OLD = b"the old output\n"
# The calls that fail, the first and the last of them that does, and the errors. The loader cannot do without its first memory.
CALLS = {"openat": (1, 15, ("EIO", "ENOMEM", "EMFILE", "EACCES")), "read": (1, 15, ("EIO", "ENOMEM")),
         "write": (1, 8, ("EIO", "ENOSPC", "EDQUOT", "EFBIG")), "fsync": (1, 2, ("EIO", "ENOSPC")),
         "rename": (1, 2, ("EIO", "ENOSPC", "EACCES")), "close": (1, 15, ("EIO",)), "mmap,brk": (2, 40, ("ENOMEM",)),
         "unlink,unlinkat": (1, 2, ("EIO",)), "newfstatat,fstat": (1, 20, ("EIO",)),
         "chmod,fchmod,fchmodat,chown,fchownat": (1, 2, ("EPERM",)), "getrandom": (1, 2, ("EIO",))}


@unittest.skipIf(SANITIZED, "a sanitizer makes calls of its own")
class Faults(ProgramTest):
    def setUp(self):
        super().setUp()
        self.random, self.outputs = random.Random(SEED), {}
        for name, data in files.plain_files(DOME):
            (self.folder / name).write_bytes(data)
            self.done(self.folder / name, name, self.edit, "--quiet")
            self.outputs[name] = (self.work / name).read_bytes()
            self.assertNotEqual(self.outputs[name], data)
            (self.work / name).unlink()

    def run_one(self, what, name, *prefix, seconds=None, request=None, **options):
        """@return whether a file is left beside the output"""
        (self.work / name).write_bytes(OLD)
        with subprocess.Popen([*prefix, COMMAND, self.folder / name, name, self.edit], cwd=self.work, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, **options) as process:
            if seconds is not None:
                time.sleep(seconds)
                process.send_signal(request)
            errors = process.communicate(timeout=300)[1].decode(errors="replace")
        code, output = process.returncode, (self.work / name).read_bytes()
        self.assertIn(output, (OLD, self.outputs[name]), f"{what}: the output is neither old nor complete")
        if code == 0:
            self.assertEqual(output, self.outputs[name], what)
        elif request is None or code != -request:
            # The loader, before the program begins, has 127; write itself may be what fails.
            self.assertIn(code, {1, 2, 3, 4, 5, 127}, (what, errors))
            self.assertTrue(errors or "write" in what, what)
            self.assertEqual(output, OLD, what)
        left = [path.name for path in self.work.iterdir() if path.name != name]
        self.assertTrue(all(other.startswith(".laplacian-edit-") for other in left), (what, left))
        for other in left:
            (self.work / other).unlink()
        return bool(left)

    def inject(self, name):
        call = self.random.choice(list(CALLS))
        first, last, errors = CALLS[call]
        when = f"{self.random.randint(first, last)}{self.random.choice(('', '+'))}"
        fault = f"{call}:error={self.random.choice(errors)}:when={when}"
        # A file may be left that could not be removed.
        self.run_one(fault, name, "strace", "--quiet=all", "--output=/dev/null", "--seccomp-bpf", "--follow-forks",
                     f"--trace={call}", f"--inject={fault}")

    def fill(self, name):
        most = self.random.randint(0, len(self.outputs[name]) + 4096)
        self.assertFalse(self.run_one(f"a limit of {most} bytes", name,
                                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))))

    def kill(self, name):
        request = self.random.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
        self.run_one(f"{request!r}", name, seconds=self.random.uniform(0, 0.008), request=request)

    @unittest.skipUnless(shutil.which("strace"), "needs strace")
    def test_each_output_is_old_or_complete(self):
        for number in range(RUNS):
            name = self.random.choice(list(self.outputs))
            with self.subTest(number):
                self.random.choice((self.inject, self.inject, self.fill, self.kill))(name)
            (self.work / name).unlink()


if __name__ == "__main__":
    unittest.main()
