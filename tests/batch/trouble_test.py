# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit when the world is against it: what it then says, ends with, and leaves behind."""
import os
import pathlib
import re
import resource
import shutil
import signal
import socket
import struct
import time
import unittest

from command_line_test import REFUSED, UNEXPECTED, UNREADABLE, UNWRITABLE, CommandTest, version

SANITIZED = bool(os.environ.get("LAPEDIT_PRELOAD"))  # takes all address space there is
NOBODY = 54321  # an ordinary user's number
NOTHING = r".*: nothing was written"


def worker_of(process):
    (worker,) = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    return int(worker)


class Trouble(CommandTest):
    def setUp(self):
        super().setUp()
        (self.place / "out.ply").write_text("old")

    def scratch(self):
        return list(self.place.glob(".laplacian-edit-*"))


class Output(Trouble):
    def test_reports_that_nobody_reads(self):
        end, other_end = os.pipe()
        os.close(end)
        with open("/dev/full", "wb") as full:
            for arguments in ((self.edit,), (self.edit, "--fractions", "0.5,1")):
                for output, why in ((other_end, "Broken pipe"), (full, "No space left")):
                    self.refused(UNWRITABLE, r"standard output cannot be written to \(" + why + r".*\): nothing was written; "
                                             r"with --quiet", self.mesh, "out.ply", *arguments, stdout=output)
            self.refused(UNWRITABLE, r"standard output cannot be written to \(it is closed\)", self.mesh, "out.ply",
                         self.edit, stdout=None,
                         preexec_fn=lambda: os.close(1))
            for option in ("--help", "--version"):
                self.refused(UNWRITABLE, r"standard output cannot", option, stdout=full)
            self.done(self.mesh, "quiet.ply", self.edit, "--quiet", stdout=full)
        os.close(other_end)
        self.assertEqual(self.bits(self.place / "quiet.ply"), self.edited_bits(self.edit))

    def test_report_that_does_not_fit_leaves_the_outputs_alone(self):
        self.refused(UNWRITABLE, r"report .*report\.json.* cannot be written: [^.]*\.\n\Z", self.mesh, "all.ply", self.edit,
                     "--fractions", ",".join(["0.5"] * 60), "--report", "report.json", "--quiet",
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000)))


    def test_folder_that_is_moved_or_removed_while_writing(self):
        for how in ("moved", "removed"):
            place = self.place / "outputs"
            place.mkdir()
            process = self.start(self.mesh, place / "all.ply", self.edit, "--fractions", ",".join(["0.5"] * 400), "--quiet")
            end = time.monotonic() + 60
            while not list(place.glob(".laplacian-edit-*/all-0003.ply")):
                self.assertIsNone(process.poll())
                self.assertLess(time.monotonic(), end)
                time.sleep(0.002)
            os.kill(worker_of(process), signal.SIGSTOP)
            place.rename(self.place / "elsewhere")
            if how == "removed":
                shutil.rmtree(self.place / "elsewhere")
            os.kill(worker_of(process), signal.SIGCONT)
            _, errors = process.communicate(timeout=100)
            with self.subTest(how):
                self.assertEqual(process.returncode, UNWRITABLE)
                self.assertRegex(errors.decode(), r"\A[^\n]*cannot be written: its folder was moved or removed: run it "
                                                  r"again\.\n\Z")
                self.assertEqual({path.name for path in self.place.rglob("*")},
                                 {"out.ply", "elsewhere"} if how == "moved" else {"out.ply"})
            if how == "moved":
                (self.place / "elsewhere").rmdir()


class Hangs(Trouble):
    def suffixes(self, *arguments):
        sentence = self.run_command(*arguments)[2]
        return re.search(r"the suffixes are ([^.]+)\.", sentence)[1].split(", ")

    def test_no_writer_waits_for_an_answer(self):
        suffixes = self.suffixes(self.mesh, "out.knit", self.edit)
        self.assertGreater(len(suffixes), 5)
        for suffix in suffixes:
            code, _, errors = self.run_command(self.mesh, "asked." + suffix, self.edit, "--timeout", "100")
            with self.subTest(suffix):
                self.assertIn(code, (0, UNWRITABLE), errors)
                self.assertEqual((self.place / ("asked." + suffix)).exists(), code == 0)
                self.assertEqual(self.scratch(), [])
                if suffix == "u3d" and version()[2] == "2020":
                    self.assertRegex(errors, r"\AThe output .*u3d.* cannot be written: Saving Error: .*aborted\.\n\Z")
                if suffix == "x3d" and version()[2] == "2020":
                    self.assertRegex(errors, r"\AThe output .*x3d.* cannot be written: .*choose one options.*\.\n\Z")

    def test_no_reader_runs_for_ever(self):
        unknown = self.place / "in.knit"
        unknown.write_text("x")
        for suffix in self.suffixes(unknown, "out.ply", self.edit):
            for data in (bytes(80), bytes(200), b"0 0 0\n" * 20):
                mesh = self.place / ("zeros." + suffix)
                mesh.write_bytes(data)
                code, _, errors = self.run_command(mesh, "out.ply", self.edit, "--timeout", "100",
                                                   environment={"LAPEDIT_STALL_SECONDS": "0.5"})
                with self.subTest((suffix, len(data))):
                    self.assertIn(code, (UNREADABLE, REFUSED), errors)
                    self.assertEqual((self.place / "out.ply").read_text(), "old")
                    self.assertEqual(self.scratch(), [])
                    if suffix == "stl":
                        self.assertRegex(errors, r"zeros\.stl.* cannot be read: it has \d+ bytes, but an STL file of|"
                                                 r"zeros\.stl.* cannot be read: it has 80 bytes, fewer than the first 84")

    def test_time_limit(self):
        os.mkfifo(self.place / "pipe")
        self.refused(UNEXPECTED, r"time limit of --timeout was exceeded while reading .*pipe.: nothing was written; ",
                     self.mesh, "out.ply", "pipe", "--timeout", "0.5")
        self.done(self.mesh, "out.ply", self.edit, "--timeout", "100")

    def test_writer_that_stands_still(self):
        with self.writing(environment={"LAPEDIT_STALL_SECONDS": "0.5"}) as process:
            os.kill(worker_of(process), signal.SIGSTOP)
            time.sleep(1.5)
            self.assertIsNone(process.poll())
            _, errors = process.communicate(timeout=100)
        self.assertEqual(process.returncode, UNWRITABLE)
        self.assertRegex(errors.decode(), r"made no progress .* while writing .*all-\d+\.ply.: nothing was written; ")
        self.assertEqual(list(self.snapshot()), [str(self.place / "out.ply")])

    def test_writer_that_goes_on_again_is_not_ended(self):
        with self.writing(environment={"LAPEDIT_STALL_SECONDS": "2"}) as process:
            worker = worker_of(process)
            os.kill(worker, signal.SIGSTOP)
            time.sleep(3)
            os.kill(worker, signal.SIGCONT)
            _, errors = process.communicate(timeout=100)
        self.assertEqual((process.returncode, errors), (0, b""))
        self.assertEqual(len(list(self.place.glob("all-*"))), 400)

    def test_long_scripts_are_refused_at_once(self):
        parameters = "".join(f'<Param name="p{k}" type="RichInt" value="1"/>' for k in range(60000))
        for sentence, script in ((r'no filter "x+\.*" in ', f'<filter name="{"x" * 2000000}"/>'),
                                 (r'no parameter "p0"', f'<filter name="Laplacian Edit">{parameters}</filter>')):
            self.refused(REFUSED, sentence, self.mesh, "out.ply", self.write_script(script), "--timeout", "12")


class Ends(Trouble):
    def ended(self, code, sentence, process):
        _, errors = process.communicate(timeout=60)
        with self.subTest(sentence):
            self.assertEqual(process.returncode, code)
            self.assertRegex(errors.decode(), r"\A[^\n]+\.\n\Z")
            self.assertRegex(errors.decode(), sentence)
            self.assertEqual(list(self.snapshot()), [str(self.place / "out.ply")])

    def test_worker_that_is_ended(self):
        for number, code, sentence in (
                (signal.SIGABRT, UNWRITABLE, r"\AMeshLab \S+ stopped with an error of its own while writing .*all-\d+\.ply"
                                             r".*signal 6" + NOTHING + "; .*PLY"),
                (signal.SIGSEGV, UNWRITABLE, r"\AMeshLab .*signal 11" + NOTHING),
                (signal.SIGKILL, UNEXPECTED, r"was killed while writing .*memory" + NOTHING),
                (signal.SIGTERM, UNEXPECTED, r"was ended while writing .*signal 15" + NOTHING),
                (signal.SIGXCPU, UNEXPECTED, r"limit of processor time was exceeded while writing" + NOTHING)):
            with self.writing() as process:
                os.kill(worker_of(process), number)
                self.ended(code, sentence, process)

    def test_processor_time_of_a_shell_is_not_memory(self):
        """Where both limits are the same, the system kills."""
        def limited():
            resource.setrlimit(resource.RLIMIT_CPU, (1, 1))

        process = self.start(self.mesh, "all.ply", self.edit, "--fractions", ",".join(["0.5"] * 4000), "--quiet",
                             preexec_fn=limited)
        self.ended(UNEXPECTED, r"limit of processor time was exceeded while \w+" + NOTHING + r"; allow more \(ulimit -t\)", process)

    def test_library_that_ends_the_program(self):
        """What is in its place by then is what is said."""
        libraries = ([self.environment["LD_PRELOAD"]] if SANITIZED else []) + [os.environ["LAPEDIT_ENDING_LIBRARY"]]
        outputs = ["all-0001.ply", "all-0002.ply"]
        for call, code, said, found in (
                ("fsync 1", UNWRITABLE, r"writing .*all-0001\.ply.* \(exit code 1: its last words\): nothing was written; ", []),
                ("rename 1", UNWRITABLE, r"writing .*: some of the files may have been replaced, each of them completely\.", []),
                ("rename 2", UNWRITABLE, r"writing .*: some of the files may have been replaced, each of them completely\.",
                 outputs[:1]),
                ("rename 3", UNWRITABLE, r"writing .*: the outputs are complete, but there is no report\.", outputs),
                ("unlinkat 1", 0, r"\A\Z", [*outputs, "report.json"])):
            place = self.place / call.replace(" ", "")
            place.mkdir()
            ended, _, errors = self.run_command(
                self.mesh, place / "all.ply", self.edit, "--fractions", "0.5,1", "--report", place / "report.json",
                environment={"LD_PRELOAD": ":".join(libraries), "LAPEDIT_END_AT": call})
            with self.subTest(call):
                self.assertEqual(ended, code)
                self.assertRegex(errors, r"\A(MeshLab \S+ or a library of its own ended the program while [^\n]*\.\n)?\Z")
                self.assertRegex(errors, said)
                self.assertEqual(sorted(path.name for path in place.iterdir()), found)

    @unittest.skipIf(SANITIZED, "the address space is the sanitizer's")
    def test_too_little_memory(self):
        many = 2000000000
        (self.place / "in.off").write_text(f"OFF\n{many} 1 0\n0 0 0\n")
        (self.place / "in.ply").write_bytes(
            b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % many
            + b"".join(b"property float %c\n" % letter for letter in b"xyz")
            + b"element face 0\nproperty list uchar int vertex_indices\nend_header\n" + struct.pack("<300f", *[0] * 300))
        for name in ("in.off", "in.ply"):
            self.refused(UNEXPECTED, r"not enough memory while reading .*/in\.\w+." + NOTHING + r"; allow more memory",
                         name, "out.ply", self.edit,
                         preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)))

    def test_too_few_processes(self):
        self.folder.chmod(0o755)
        self.place.chmod(0o755)
        self.mesh.chmod(0o644)
        limits = [0]

        def limit():
            if os.geteuid() == 0:  # who knows no such limits
                os.setgroups([])
                os.setgid(NOBODY)
                os.setuid(NOBODY)
            resource.setrlimit(resource.RLIMIT_NPROC, (limits[0], limits[0]))
        try:
            self.refused(UNEXPECTED, r"cannot start its worker \(.*\)" + NOTHING + "; allow more processes", self.mesh,
                         "out.ply", self.edit, preexec_fn=limit)
        except PermissionError:
            self.skipTest("the program is where other users cannot start it")
        if os.geteuid() == 0:
            # The worker, and no thread of its own.
            limits[0] = 2
            self.place.chmod(0o777)
            code, _, errors = self.run_command(self.mesh, "new.ply", self.edit, preexec_fn=limit)
            self.assertIn(code, (0, UNEXPECTED))
            if code != 0:
                self.assertRegex(errors, r"allowed no more threads while \w+" + NOTHING)

    def test_caller_that_ignores_the_end_of_children_gets_the_exit_code(self):
        self.refused(UNREADABLE, r"does not exist", "none.ply", "out.ply", self.edit,
                     preexec_fn=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN))


class Scratch(Trouble):
    def test_requests_to_end_leave_nothing_behind(self):
        for name in ("TERM", "INT", "HUP", "QUIT", "USR1", "USR2", "ALRM", "XCPU", "VTALRM", "PROF", "RTMIN"):
            request = getattr(signal, "SIG" + name)
            with self.writing(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CORE, (0, 0))) as process:
                process.send_signal(request)
                process.communicate(timeout=60)
            with self.subTest(name):
                self.assertEqual(process.returncode, -request)
                self.assertEqual(list(self.snapshot()), [str(self.place / "out.ply")])

    def test_request_that_is_ignored_ends_nothing(self):
        with self.writing(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)) as process:
            process.send_signal(signal.SIGHUP)
            process.send_signal(signal.SIGPIPE)
            process.communicate(timeout=100)
        self.assertEqual(process.returncode, 0)

    def left_behind(self):
        with self.writing() as process:
            worker = worker_of(process)
            process.kill()
            process.communicate(timeout=60)
        end = time.monotonic() + 60
        while pathlib.Path(f"/proc/{worker}/cwd").exists():  # it dies with its supervisor
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        (folder,) = self.scratch()
        self.assertTrue(any(folder.iterdir()))
        return folder

    def test_what_a_killed_program_left_is_swept(self):
        folder = self.left_behind()
        self.done(self.mesh, "next.ply", self.edit)
        self.assertFalse(folder.exists())
        folder = self.left_behind()
        (self.place / "elsewhere").mkdir()
        self.done(self.mesh, "elsewhere/out.ply", self.edit, "--report", "report.json")
        self.assertFalse(folder.exists())

    def test_what_is_not_ours_or_lives_is_not_swept(self):
        kept = self.left_behind()
        begin = kept.name[:-6]
        self.assertTrue(begin.startswith(".laplacian-edit-" + re.sub(r"\W", "_", socket.gethostname())[:3]))
        other_machine = self.place / ".laplacian-edit-elsewhere-abcdef"
        kept.rename(other_machine)
        longer = self.place / (begin + "abcdefg")
        longer.mkdir()
        theirs = self.place / "theirs"
        theirs.mkdir()
        (theirs / "file").write_text("x")
        link = self.place / (begin + "linked")
        link.symlink_to(theirs)
        inside = self.left_behind_link(begin, theirs)
        if os.geteuid() == 0:
            foreign = self.place / (begin + "forein")
            foreign.mkdir()
            os.chown(foreign, NOBODY, NOBODY)
        with self.writing() as process:
            for _ in range(3):
                self.done(self.mesh, "next.ply", self.edit)
            _, errors = process.communicate(timeout=100)
        self.assertEqual((process.returncode, errors), (0, b""))
        self.assertEqual(len(list(self.place.glob("all-*"))), 400)
        self.assertTrue(other_machine.exists() and longer.exists() and link.is_symlink())
        self.assertEqual((theirs / "file").read_text(), "x")
        self.assertFalse(inside.exists())
        if os.geteuid() == 0:
            self.assertTrue(foreign.exists())

    def left_behind_link(self, begin, target):
        folder = self.place / (begin + "killed")
        folder.mkdir()
        (folder / "link").symlink_to(target)
        return folder


if __name__ == "__main__":
    unittest.main()
