# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit where calls of the system fail, disks are full and processes are killed, at random places:
each output is what it was before or complete, and the exit code 0 means complete.

LAPEDIT_FAULTS in the environment says how many runs there are, 40 unless given; LAPEDIT_FAULTS_SEED which ones.
"""
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

from command_line_test import CommandTest
from host import COMMAND
from list_test import make_family

RUNS = int(os.environ.get("LAPEDIT_FAULTS", "40"))
SEED = int(os.environ.get("LAPEDIT_FAULTS_SEED", "28"))
FORMATS = ("ply", "off", "stl", "obj", "xyz")
OLD = b"what was there before\n"
# The calls that fail, how many of them a run makes, and the errors.
CALLS = {"openat": (300, ("EIO", "ENOMEM", "EMFILE", "EACCES")), "read": (250, ("EIO", "ENOMEM")),
         "write": (40, ("EIO", "ENOSPC", "EDQUOT", "EFBIG")), "fsync": (4, ("EIO", "ENOSPC")),
         "rename": (2, ("EIO", "ENOSPC", "EACCES")), "mkdir": (1, ("ENOSPC", "EACCES")), "close": (200, ("EIO",)),
         "mmap": (300, ("ENOMEM",)), "clone,clone3,fork,vfork": (4, ("EAGAIN",)), "pipe2": (2, ("EMFILE",)),
         "unlink,unlinkat": (3, ("EIO",)), "flock": (2, ("EIO",)), "newfstatat,fstat": (200, ("EIO",))}


@unittest.skipIf(os.environ.get("LAPEDIT_PRELOAD"), "a sanitizer makes calls of its own")
class Faults(CommandTest):
    def setUp(self):
        super().setUp()
        self.random = random.Random(SEED)
        self.outputs = {}
        for suffix in FORMATS:
            self.done(self.mesh, "out." + suffix, self.edit)
            self.outputs[suffix] = (self.place / ("out." + suffix)).read_bytes()

    def check(self, what, suffix, code, errors):
        """After a run. @return whether a folder of scratch files is left"""
        output = (self.place / ("out." + suffix)).read_bytes()
        self.assertIn(output, (OLD, self.outputs[suffix]), f"{what}: the output is neither old nor complete")
        if code == 0:
            self.assertEqual(output, self.outputs[suffix], what)
        else:
            # The loader, before the program begins, has 127; write itself may be what fails.
            self.assertIn(code, {1, 2, 3, 4, 5, 127, -signal.SIGKILL}, (what, errors))
            self.assertTrue(errors or code == -signal.SIGKILL or "write" in what, what)
            if output != OLD:
                self.assertRegex(errors, r"may have been replaced|are complete|^$", what)
        left = [path.name for path in self.place.iterdir() if path.name != "out." + suffix]
        self.assertTrue(all(name.startswith(".laplacian-edit-") for name in left), (what, left))
        return bool(left)

    def run_with(self, what, suffix, *prefix, **options):
        (self.place / ("out." + suffix)).write_bytes(OLD)
        process = subprocess.run([*prefix, COMMAND, self.mesh, "out." + suffix, self.edit], cwd=self.place,
                                 env=self.quiet_environment(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, timeout=300, check=False, **options)
        return self.check(what, suffix, process.returncode, process.stderr.decode(errors="replace"))

    def quiet_environment(self):
        return {**{name: value for name, value in self.environment.items() if name != "DISPLAY"}, "LC_ALL": "C"}

    def inject(self, suffix):
        call = self.random.choice(list(CALLS))
        count, errors = CALLS[call]
        when = f"{self.random.randint(1, count)}{self.random.choice(('', '+'))}"
        fault = f"{call}:error={self.random.choice(errors)}:when={when}"
        self.run_faulty(call, fault, suffix)

    def run_faulty(self, call, fault, suffix):
        # What is kept then is what cannot be removed, opened or locked.
        self.run_with(fault, suffix, "strace", "--follow-forks", "--quiet=all", "--output=/dev/null", "--seccomp-bpf",
                      f"--trace={call}", f"--inject={fault}")

    def fill(self, suffix):
        most = self.random.randint(0, len(self.outputs[suffix]) + 4096)
        self.assertFalse(self.run_with(f"a limit of {most} bytes", suffix, preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (most, most))))

    def kill(self, suffix):
        (self.place / ("out." + suffix)).write_bytes(OLD)
        with subprocess.Popen([COMMAND, self.mesh, "out." + suffix, self.edit, "--quiet"], cwd=self.place,
                              env=self.quiet_environment(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, start_new_session=True) as process:
            time.sleep(self.random.uniform(0, 0.2))
            request = self.random.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
            # All of it at once, or the one that was started.
            try:
                (os.killpg if self.random.random() < 0.5 else os.kill)(process.pid, request)
            except ProcessLookupError:
                pass
            errors = process.communicate(timeout=300)[1].decode(errors="replace")
        code = process.returncode
        if code == -request and request != signal.SIGKILL:
            code, errors = 5, errors or "ended by the request"
        self.wait_for_workers()
        left = self.check(f"kill by {request}", suffix, code, errors)
        self.assertTrue(not left or request == signal.SIGKILL)

    def wait_for_workers(self):
        """A worker dies with its supervisor, and not before."""
        end = time.monotonic() + 60
        while subprocess.run(["pgrep", "-f", str(self.mesh)], stdout=subprocess.DEVNULL, check=False).returncode == 0:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    @unittest.skipUnless(shutil.which("strace"), "needs strace")
    def test_file_that_cannot_be_removed_is_no_output(self):
        for path in list(self.place.iterdir()):
            path.unlink()
        self.run_faulty("unlink,unlinkat", "unlink,unlinkat:error=EIO:when=1", "ply")

    @unittest.skipUnless(shutil.which("strace") and shutil.which("pgrep"), "needs strace and pgrep")
    def test_each_output_is_old_or_complete(self):
        for path in list(self.place.iterdir()):
            path.unlink()
        for number in range(RUNS):
            suffix = self.random.choice(FORMATS)
            with self.subTest(number):
                self.random.choice((self.inject, self.inject, self.fill, self.kill))(suffix)
            # The next run sweeps what a killed one has left.
            self.done(self.mesh, "out." + suffix, self.edit, "--quiet")
            self.assertEqual([path.name for path in self.place.iterdir()], ["out." + suffix], number)
            (self.place / ("out." + suffix)).unlink()

    def test_a_list_that_is_killed_is_done_by_the_same_command(self):
        before = os.getcwd()
        os.chdir(self.place)
        try:
            make_family.main(20, self.place / "family")
        finally:
            os.chdir(before)
        arguments = ("--list", "family/jobs.tsv", "--job-log", "log.jsonl", "--resume", "--quiet")
        self.done(*arguments)
        complete = {path: path.read_bytes() for path in (self.place / "family").glob("edited-*")}
        self.assertEqual(len(complete), 20)
        for number in range(max(2, RUNS // 10)):
            with self.subTest(number):
                for path in complete:
                    path.unlink()
                (self.place / "log.jsonl").unlink()
                with self.start(*arguments, start_new_session=True) as process:
                    time.sleep(self.random.uniform(0, 1))
                    (os.killpg if self.random.random() < 0.5 else os.kill)(process.pid, signal.SIGKILL)
                    process.communicate(timeout=300)
                for path in complete:
                    self.assertIn(path.read_bytes() if path.exists() else None, (None, complete[path]))
                self.done(*arguments)
                self.assertEqual({path: path.read_bytes() for path in complete}, complete)


if __name__ == "__main__":
    unittest.main()
