# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit: which files its names lead to, and what happens to them."""
import json
import os
import pathlib
import resource
import shutil
import signal
import stat
import subprocess
import unittest

from program import COMMAND, LIFT, NOBODY, POSES, REFUSED, UNWRITABLE, WRONG_USAGE, ProgramTest


class Files(ProgramTest):
    def setUp(self):
        super().setUp()
        self.expected = self.edited()
        self.mesh = pathlib.Path(shutil.copy(self.mesh, self.work / "in.ply"))
        self.edit = self.write_edit(LIFT, name="work/edit.json")
        self.out = self.work / "out.ply"
        self.out.write_text("old")
        for name in ("out-0002.ply", "two-0002.ply"):
            (self.work / name).write_text("old")

    def test_names_of_one_file_are_refused(self):
        shutil.copy(self.edit, self.work / "edit.ply")
        for link, target in (("folder", "."), ("link.ply", "edit.ply"), ("link.json", "edit.json"), ("in-link.ply", "in.ply"),
                             ("all-0002.ply", "in.ply"), ("two-0001.ply", "two-0002.ply")):
            (self.work / link).symlink_to(target)
        for arguments in (
                *((out, "edit.ply") for out in ("edit.ply", "link.ply", "folder/edit.ply")),
                *(("out.ply", "edit.json", "--report", name) for name in ("in.ply", "in-link.ply", "edit.json", "link.json", "out.ply")),
                ("new.ply", "edit.json", "--report", "folder/new.ply"),
                ("out.ply", "edit.json", "--fractions", "0,1", "--report", "out-0002.ply"),
                ("all.ply", "edit.json", "--fractions", "0,1"), ("two.ply", "edit.json", "--fractions", "0,1")):
            self.refused(WRONG_USAGE, r'\AThe \w+ ".*" and the (output|report|edit) ".*" are the same file: give another name',
                         self.mesh, *arguments)
        with open(self.work / "edit.ply", "rb") as file:
            self.refused(WRONG_USAGE, r"are the same file", self.mesh, "edit.ply", "/dev/stdin", stdin=file)

    def test_files_that_are_read_are_no_outputs(self):
        for name in ("to.csv", "from.csv"):
            (self.work / name).write_text("nose,0.5,0.5,0.2\n")
        scan = pathlib.Path(shutil.copy(self.mesh, self.work / "scan.ply"))
        fit = {"to": scan.name}
        edit = self.write_edit({"region": {"component": True}, "fit": fit, "handles": [{"landmarks": {"from": "from.csv", "to": "to.csv"}}]},
                               name="work/fit.json")
        for name in ("to.csv", "from.csv", "scan.ply", "fit.json", "in.ply"):
            (self.work / ("soft-" + name)).symlink_to(name)
            os.link(self.work / name, self.work / ("hard-" + name))
            for link in (name, "soft-" + name, "hard-" + name):
                self.refused(WRONG_USAGE, f'"{link}" are the same file: give another', self.mesh, "out.ply", edit, "--report", link)
        for link in ("scan.ply", "soft-scan.ply", "hard-scan.ply"):
            self.refused(WRONG_USAGE, f'scan.ply" and the output "{link}" are the same file', self.mesh, link, edit)
        os.link(scan, self.work / "all-0002.ply")
        self.refused(WRONG_USAGE, "scan.ply\" and the output", self.mesh, "all.ply", edit, "--fractions", "0,1")
        fit["to"] = "in.ply"
        self.write_edit({"region": {"component": True}, "fit": fit}, name="work/fit.json")
        self.refused(WRONG_USAGE, "file of the edit .* and the output", self.mesh, "in.ply", edit)
        for given, arguments in ((self.edit, (self.mesh, "out.ply", "-", "--report", self.edit.name)),
                                 (self.mesh, ("-", "out.ply", self.edit, "--report", self.mesh.name))):
            with open(given, "rb") as file:
                self.refused(WRONG_USAGE, "are the same file", *arguments, stdin=file)

    def test_output_may_be_the_input(self):
        os.link(self.mesh, self.work / "other.ply")
        (self.work / "link.ply").symlink_to("in.ply")
        before = self.mesh.read_bytes()
        self.done("link.ply", self.mesh, self.edit)
        self.assertEqual((self.mesh.read_bytes(), (self.work / "other.ply").read_bytes()), (self.expected, before))

    def test_owner_group_and_permissions_are_kept_without_setuid(self):
        for mode, after in ((0o640, 0o640), (0o6775, 0o775), (0o1604, 0o604)):
            self.out.chmod(mode)
            self.done(self.mesh, self.out, self.edit)
            self.assertEqual(stat.S_IMODE(self.out.stat().st_mode), after)
        if os.geteuid() == 0:
            os.chown(self.out, NOBODY, NOBODY + 1)
            self.done(self.mesh, self.out, self.edit)
            self.assertEqual((self.out.stat().st_uid, self.out.stat().st_gid), (NOBODY, NOBODY + 1))

    @unittest.skipUnless(os.geteuid() == 0, "only root can give files away")
    def test_another_group_gets_no_more_than_all_users(self):
        for path, mode in ((self.folder, 0o755), (self.work, 0o777), (self.mesh, 0o644), (self.out, 0o664)):
            path.chmod(mode)
        try:
            self.done(self.mesh, self.out, self.edit, user=NOBODY, group=NOBODY, extra_groups=[])
        except PermissionError:
            self.skipTest("other users cannot start the program")
        found = self.out.stat()
        self.assertEqual((found.st_uid, found.st_gid, stat.S_IMODE(found.st_mode)), (NOBODY, NOBODY, 0o644))

    def test_names_are_bytes(self):
        folder = os.fsencode(self.work) + b"/d\xff \xe5\xb1"
        os.mkdir(folder)
        mesh, edit, out, report = (folder + name for name in (b"/in\xfe.ply", b"/edit\x80\xed.json", b"/out\xff.ply", b"/re\xa0.json"))
        for source, copy in ((self.mesh, mesh), (self.edit, edit)):
            shutil.copy(source, copy)
        self.done(mesh, out, edit, "--report", report, "--quiet")
        self.assertEqual(pathlib.Path(os.fsdecode(out)).read_bytes(), self.expected)
        self.assertIn("in\ufffd.ply", json.loads(pathlib.Path(os.fsdecode(report)).read_bytes())["input"])

    def test_outputs_that_cannot_be_written(self):
        (self.work / "folder.ply").mkdir()
        (self.work / "full.ply").symlink_to("/dev/full")
        for sentence, name in ((r"folder does not exist", "none/out.ply"), (r"is a folder", "folder.ply"),
                               (r"not an ordinary file", "full.ply"), (r"cannot be written", "/proc/out.ply")):
            self.refused(UNWRITABLE, rf'output "{name}".* {sentence}', self.mesh, name, self.edit)
            self.refused(UNWRITABLE, rf'report "{name}".* {sentence}', self.mesh, "out.ply", self.edit, "--report", name)
        self.refused(UNWRITABLE, r"stdout.* is not an ordinary file", self.mesh, "out.ply", self.edit, "--report", "/dev/stdout")
        (self.work / "all-0002.ply").mkdir()
        self.refused(UNWRITABLE, r"all-0002\.ply.* is a folder", self.mesh, "all.ply", self.edit, "--fractions", "0,1")
        far = self.write_edit({**LIFT, "handles": [{"vertices": "220", "translation": [0, 0, 6e38]}]})
        self.refused(REFUSED, r"At fraction 1: .*single precision", self.mesh, "new.ply", far, "--fractions", "0.25,1")

    def test_full_disk_leaves_all_files_alone(self):
        for size, sentence, more in ((8192, r"output .*out\.ply", ()), (60000, r"report .*report\.json", (
                "--fractions", ",".join(["0.5"] * 60), "--report", "report.json"))):
            self.refused(UNWRITABLE, sentence + r".* cannot be written: it is larger than a file may be here: raise the limit "
                         r"\(ulimit -f\)[^.]*\.\n", self.mesh, "out.ply", self.edit, "--quiet", *more,
                         preexec_fn=lambda size=size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
        (self.work / "disk").mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", self.work / "disk"], check=False,
                          stderr=subprocess.DEVNULL).returncode == 0:
            self.addCleanup(subprocess.run, ["umount", self.work / "disk"], check=True)
            self.refused(UNWRITABLE, r"output .* cannot be written: the disk is full: free some space, or", self.mesh,
                         "disk/out.ply", self.edit)


class Interruptions(ProgramTest):
    def test_target_that_becomes_a_folder_meanwhile(self):
        for name, sentence, written in (("all-0003.ply", r"output .*all-0003\.ply.* folder\.\n\Z", 0),
                                        ("report.json", r"report .*report\.json.* folder\. The outputs are complete\.\n\Z", POSES)):
            with self.writing("--report", "report.json") as process:
                (self.work / name).mkdir()
                _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, UNWRITABLE)
            self.assertRegex(errors.decode(), sentence)
            (self.work / name).rmdir()
            self.assertEqual((len(list(self.work.glob("all-*"))), len(list(self.work.glob(".lap*")))), (written, 0))

    def remove(self):
        while self.work.exists():  # files appear meanwhile
            shutil.rmtree(self.work, ignore_errors=True)

    def test_folder_that_is_moved_or_removed_meanwhile(self):
        for change in (lambda: self.work.rename(self.folder / "moved"), self.remove):
            self.work.mkdir(exist_ok=True)
            with self.writing() as process:
                change()
                _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, UNWRITABLE, errors)
            self.assertRegex(errors.decode(), r"output .* cannot be written: its folder was moved or removed: run it again\.\n\Z")

    def left(self):
        return [path.name for path in self.work.glob(".laplacian-edit-*")]

    def test_requests_to_end_and_what_is_left(self):
        for name in ("TERM", "INT", "HUP", "QUIT", "XCPU", "KILL"):
            with self.writing() as process:
                process.send_signal(getattr(signal, "SIG" + name))
                process.communicate(timeout=60)
            with self.subTest(name):
                self.assertEqual(process.returncode, -getattr(signal, "SIG" + name))
                self.assertEqual(list(self.work.glob("all-*")), [])
                self.assertEqual(len(self.left()) > 0, name == "KILL")
            for name in self.left():
                (self.work / name).unlink()

    @unittest.skipUnless(shutil.which("strace"), "needs strace")
    def test_requests_at_each_call(self):
        """The signal arrives when a system call that creates, writes, removes or renames a file begins or ends."""
        for call, first, last in (("openat", 6, 15), ("fsync", 1, 3), ("write", 1, 3), ("rename", 1, 3),
                                  ("fchmodat,chmod", 1, 3), ("rt_sigprocmask", 1, 15)):
            for when in range(first, last + 1):
                self.run_with_strace(f"--trace={call}", f"--inject={call}:signal=SIGTERM:when={when}")

    def run_with_strace(self, *faults):
        done = subprocess.run(["strace", "--quiet=all", "--output=/dev/null", "--follow-forks", *faults, COMMAND, self.mesh, "all.ply",
                               self.edit, "--fractions", "0,1", "--report", "all-report", "-q"], cwd=self.work, check=False, timeout=60)
        names = sorted(path.name for path in self.work.iterdir())
        self.assertIn((done.returncode, names), ((0, ["all-0001.ply", "all-0002.ply", "all-report"]), (-signal.SIGTERM, []),
                                                 (-signal.SIGINT, [])), faults)
        for name in names:
            (self.work / name).unlink()

    def test_ignored_requests_stay_ignored(self):
        with self.writing(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)) as process:
            process.send_signal(signal.SIGHUP)
            process.communicate(timeout=60)
        self.assertEqual((process.returncode, self.left()), (0, []))


if __name__ == "__main__":
    unittest.main()
