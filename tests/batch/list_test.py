# SPDX-License-Identifier: GPL-3.0-or-later
"""Many meshes: the program's lists, and the commands of common/docs/many-meshes.md as they are printed there."""
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

from host import COMMAND, HostTest, laplacian_edit, without_display
from ply import Ply, write_ply
from shapes import dome

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "common" / "demo"))
import make_family  # noqa: E402

DOCUMENT = (ROOT / "common" / "docs" / "many-meshes.md").read_text(encoding="utf-8")
ONE_CALL, PARALLEL, HOSTS = re.findall(r"```sh\n(.*?)```", DOCUMENT, re.S)
SLURM = ROOT / "filter_laplacian_edit" / "command_line" / "recipes" / "slurm_array.sh"
REFUSED, WRONG_USAGE, UNREADABLE, UNWRITABLE, UNEXPECTED = 1, 2, 3, 4, 5
FOLLOWERS = ("PARALLEL", "OPENBLAS")  # of the environment: what changes the recipes


def children(process):
    try:
        return [int(word) for word in pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    except OSError:
        return []


def status(process, name):
    """A number from /proc/<process>/status, 0 if the process has ended."""
    try:
        found = re.search(rf"(?m)^{name}:\s+(\d+)", pathlib.Path(f"/proc/{process}/status").read_text())
    except OSError:
        found = None
    return int(found[1]) if found else 0


class ListTest(HostTest):
    screen = None

    def setUp(self):
        self.place = self.folder / self.id().rsplit(".", 1)[1]
        self.place.mkdir()
        self.log = self.place / "family" / "log.jsonl"

    def family(self, count, place=None):
        """Generated meshes, their edit and their list, in a folder "family". @return the pairs of mesh and output"""
        before = os.getcwd()
        os.chdir(place or self.place)
        try:
            make_family.main(count, pathlib.Path("family"))
        finally:
            os.chdir(before)
        folder = (place or self.place) / "family"
        return [(folder / f"mesh-{k:04}.off", folder / f"edited-{k:04}.ply") for k in range(1, count + 1)]

    def write_list(self, *lines, name="jobs.tsv"):
        path = self.place / name
        path.write_text("".join(("\t".join(map(str, line)) if isinstance(line, tuple) else line) + "\n" for line in lines))
        return path

    def start(self, *command, **options):
        environment = {name: value for name, value in without_display(self.environment).items()
                       if not name.startswith(FOLLOWERS)}
        environment["PATH"] = f"{pathlib.Path(COMMAND).parent}:{environment['PATH']}"
        environment.update(options.pop("environment", {}))
        return subprocess.Popen([*map(str, command)], env=environment, cwd=self.place, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)

    def ended(self, process):
        with process:
            output, errors = process.communicate(timeout=120)
        return process.returncode, output.decode(), errors.decode()

    def run_command(self, *arguments, **options):
        return self.ended(self.start(COMMAND, *arguments, **options))

    def done(self, *arguments, **options):
        code, output, errors = self.run_command(*arguments, **options)
        self.assertEqual((code, errors), (0, ""))
        return output

    def entries(self, log=None):
        return [json.loads(line) for line in (log or self.log).read_text().splitlines()]

    def wait_until(self, happened, process):
        limit = time.monotonic() + 60
        while not happened():
            self.assertLess(time.monotonic(), limit)
            self.assertIsNone(process.poll(), "ended too early")
            time.sleep(0.002)

    def require_edited(self, pairs):
        """All outputs are there, with the handle where it is to be; some are compared with single calls."""
        middle = make_family.SIDE * make_family.SIDE // 2
        for mesh, output in pairs:
            before = [float(word) for word in mesh.read_text().splitlines()[2 + middle].split()]
            after = Ply(output).points()
            self.assertEqual(len(after), make_family.SIDE * make_family.SIDE)
            self.assertAlmostEqual(after[middle][2], before[2] + 0.2, delta=0.005)
            self.assertAlmostEqual(after[0][2], 0, delta=0.02)
        for mesh, output in pairs[::max(1, len(pairs) // 5)]:
            self.done(mesh, "alone.ply", mesh.parent / "edit.json", "--quiet")
            self.assertEqual(output.read_bytes(), (self.place / "alone.ply").read_bytes(), output)

    def require_clean(self):
        self.assertEqual([path for path in self.place.rglob(".laplacian-edit-*")], [])


class Lists(ListTest):
    def test_killed_half_way_and_taken_up_again(self):
        pairs = self.family(200)
        command = ("sh", "-c", "exec " + ONE_CALL.strip())
        process = self.start(*command)
        self.wait_until(lambda: self.log.exists() and self.log.read_bytes().count(b"\n") > 80, process)
        process.kill()
        self.assertEqual(self.ended(process)[0], -signal.SIGKILL)
        # The jobs end too, and clean up.
        limit = time.monotonic() + 30
        while list(self.place.rglob(".laplacian-edit-*")):
            self.assertLess(time.monotonic(), limit)
            time.sleep(0.01)
        first = self.entries()
        self.assertLess(len(first), 200)
        made = {entry["out"]: os.stat(entry["out"]).st_mtime_ns for entry in first}

        code, output, errors = self.ended(self.start(*command))
        self.assertEqual((code, errors), (0, ""))
        self.assertEqual(output, f"200 of 200 jobs done ({len(first)} of them before), 0 failed.\n")
        self.assertEqual({path: os.stat(path).st_mtime_ns for path in made}, made)
        entries = self.entries()
        self.assertEqual(sorted(entry["line"] for entry in entries), list(range(1, 201)))
        self.assertEqual({entry["exit"] for entry in entries}, {0})
        self.require_edited(pairs)
        self.require_clean()
        keys = {name for row in re.findall(r"(?m)^\| (`.*?) \|", DOCUMENT) for name in re.findall(r"`(\w+)`", row)}
        self.assertEqual(keys, set(entries[0]))

    def test_request_to_stop(self):
        pairs = self.family(120)
        command = ("--list", "family/jobs.tsv", "--jobs", 3, "--job-log", self.log, "--resume")
        for request in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            process = self.start(COMMAND, *command)
            before = len(self.entries()) if self.log.exists() else 0
            self.wait_until(lambda: self.log.exists() and self.log.read_bytes().count(b"\n") > before + 20, process)
            process.send_signal(request)
            code, output, errors = self.ended(process)
            self.assertEqual(code, -request)
            self.assertRegex(output, r"\A\d+ of 120 jobs done[^\n]*\n\Z")
            self.assertRegex(errors, r"\A(Line \d+: It was stopped from outside[^\n]*\n){0,3}\Z")
            self.require_clean()
            self.assertLessEqual({entry["exit"] for entry in self.entries()},
                                 {0, *(128 + number for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP))})
        self.done(*command)
        self.require_edited(pairs)

    def test_bad_jobs_stop_no_other(self):
        pairs = self.family(3)
        broken = self.place / "broken.ply"
        whole = write_ply(self.place / "whole.ply", *dome()).read_bytes()
        broken.write_bytes(whole[:len(whole) // 2])
        (self.place / "empty.json").write_text('{"laplacian_edit": 1, "steps": [{"region": {"radius": -1}}]}')
        (self.place / "bad.mlx").write_text(
            "<!DOCTYPE FilterScript><FilterScript>" + laplacian_edit(radius=-1) + "</FilterScript>")
        edit = "family/edit.json"
        jobs = self.write_list(
            "# comment", (pairs[0][0], "a.ply", edit), ("none.ply", "b.ply", edit), "", (broken, "c.ply", edit),
            (pairs[1][0], "d.ply", "empty.json"), (pairs[1][0], "none/e.ply", edit), (pairs[1][0], "f.ply", "bad.mlx"),
            (pairs[1][0], "g.xyzzy", edit), (pairs[2][0], "h.ply", edit))
        code, output, errors = self.run_command("--list", jobs, "--job-log", "log.jsonl")
        self.assertEqual(code, UNWRITABLE)
        self.assertEqual(output, "2 of 8 jobs done, 6 failed.\n")
        ends = {entry["line"]: entry for entry in self.entries(self.place / "log.jsonl")}
        self.assertEqual({line: entry["exit"] for line, entry in ends.items()},
                         {2: 0, 3: UNREADABLE, 5: UNREADABLE, 6: REFUSED, 7: UNWRITABLE, 8: REFUSED, 9: UNWRITABLE, 10: 0})
        told = dict(re.findall(r"(?m)^Line (\d+): (.+)$", errors))
        self.assertEqual(len(errors.splitlines()), 6)
        self.assertEqual({int(line): sentence for line, sentence in told.items()},
                         {line: entry["sentence"] for line, entry in ends.items() if entry["exit"]})
        self.assertRegex(told["3"], r"none\.ply.*does not exist")
        self.assertEqual({path.name for path in self.place.glob("?.*")}, {"a.ply", "h.ply"})
        # What failed is tried again, and nothing else.
        shutil.copy(self.place / "whole.ply", broken)
        code, output, errors = self.run_command("--list", jobs, "--job-log", "log.jsonl", "--resume")
        self.assertEqual(output, "3 of 8 jobs done (2 of them before), 5 failed.\n")

    def test_a_job_that_is_killed_stops_no_other(self):
        # A mesh that takes long enough to be killed at.
        large = write_ply(self.place / "large.ply", *dome(301, 301))
        pairs = self.family(4)
        edit = "family/edit.json"
        jobs = self.write_list((large, "large-edited.ply", edit), *((m, o, edit) for m, o in pairs))
        process = self.start(COMMAND, "--list", jobs, "--jobs", 1)

        def workers():
            return [w for p in children(process.pid) for s in children(p) for w in children(s)]

        self.wait_until(workers, process)
        os.kill(workers()[0], signal.SIGKILL)
        code, output, errors = self.ended(process)
        self.assertEqual(code, UNEXPECTED, errors)
        self.assertEqual(output, "4 of 5 jobs done, 1 failed.\n")
        self.assertRegex(errors, r"\ALine 1: [^\n]*\n\Z")
        self.assertFalse((self.place / "large-edited.ply").exists())
        self.require_edited(pairs)
        # With the program its jobs end.
        process = self.start(COMMAND, "--list", jobs, "--jobs", 1)
        self.wait_until(workers, process)
        (worker,) = workers()
        process.kill()
        self.ended(process)
        limit = time.monotonic() + 60
        while pathlib.Path(f"/proc/{worker}").exists():
            self.assertLess(time.monotonic(), limit)
            time.sleep(0.01)
        self.assertFalse((self.place / "large-edited.ply").exists())

    def test_lines_of_json(self):
        (mesh, _), = self.family(1)
        odd = self.place / "a\tb\nc {ü}.off"
        shutil.copy(mesh, odd)
        lines = [{"in": odd.name, "out": "{\t}.ply", "edit": "family/edit.json", "fraction": 0.25, "report": "r.json"},
                 {"in": str(mesh), "out": "whole.ply", "edit": "family/edit.json"}]
        self.done("--list", self.write_list(*map(json.dumps, lines)))
        self.done(mesh, "alone.ply", "family/edit.json", "--quiet", "--fraction", "0.25")
        self.assertEqual((self.place / "{\t}.ply").read_bytes(), (self.place / "alone.ply").read_bytes())
        self.assertEqual(json.loads((self.place / "r.json").read_text())["outputs"][0]["fraction"], 0.25)

    def test_list_from_a_pipe_with_the_line_ends_of_windows(self):
        pairs = self.family(3)
        slowly = "while read -r line; do printf %s \"${line%json}\"; sleep 0.1; printf 'json\\r\\n'; done"
        code, output, errors = self.ended(self.start(
            "bash", "-c", slowly + " <family/jobs.tsv | laplacian-edit --list /dev/stdin"))
        self.assertEqual((code, output, errors), (0, "3 of 3 jobs done, 0 failed.\n", ""))
        self.require_edited(pairs)

    def test_poses(self):
        pairs = self.family(2)
        self.done("--list", "family/jobs.tsv", "--fractions", "0.5,1")
        self.assertEqual(len(list((self.place / "family").glob("edited-*-000?.ply"))), 4)
        self.done(pairs[1][0], "alone.ply", "family/edit.json", "--quiet", "--fraction", "0.5")
        self.assertEqual((self.place / "family" / "edited-0002-0001.ply").read_bytes(),
                         (self.place / "alone.ply").read_bytes())

    def test_lists_that_are_refused(self):
        (mesh, output), = self.family(1)
        edit = self.place / "family" / "edit.json"
        (self.place / "s.mlx").write_text("<FilterScript/>")
        (self.place / "other").symlink_to("family")
        good = (mesh, "good.ply", edit)

        def refused(sentence, *lines, options=(), code=WRONG_USAGE):
            with self.subTest(sentence):
                path = self.write_list(good, *lines)
                before = sorted(self.place.rglob("*"))
                ended, output, errors = self.run_command("--list", path, *options)
                self.assertEqual((ended, output), (code, ""), errors)
                self.assertRegex(errors, r"\A[^\n]+[.?]\n\Z")
                self.assertRegex(errors, sentence)
                self.assertEqual(sorted(self.place.rglob("*")), before)

        refused(r"line 2: there are 2 names: give IN, OUT and EDIT with tabs", (mesh, "out.ply"))
        refused(r"line 2: there are 4 names", (mesh, "out.ply", edit, edit))
        refused(r"line 2: a name is empty", (mesh, "", edit))
        refused(r"line 2: this is no JSON object", "{")
        refused(r'line 2: unknown key "inn"; known keys are', '{"inn": "a"}')
        refused(r'line 2: the key "out" is given twice: keep one',
                json.dumps({"in": str(mesh), "out": "a.ply", "edit": str(edit)})[:-1] + ', "out": "b.ply"}')
        refused(r"cannot be read after line 1: the line is too long", "x" * 2000000, code=UNREADABLE)
        refused(r"line 2: out must be the name of a file", '{"out": 3}')
        refused(r"line 2: a job needs the keys in, out and edit", '{"in": "a", "out": "b"}')
        refused(r"line 2: the fraction must be a number from 0 to 1",
                json.dumps({"in": "a", "out": "b", "edit": "c", "fraction": 2}))
        refused(r'line 3: ".*good\.ply" is also written by line 1', "#", (mesh, "./family/../good.ply", edit))
        refused(r'line 3: ".*x\.ply" is also written by line 2', (mesh, "other/x.ply", edit), (mesh, "family/x.ply", edit))
        refused(r'line 2: ".*good\.ply" is written by line 1', ("good.ply", "out.ply", edit))
        refused(r'line 1: ".*edit\.json" is written by line 2', (mesh, edit, "s.mlx"))
        refused(r'line 2: ".*own\.off" is written by the same line', ("family/own.off", "other/own.off", edit))
        refused(r'line 2: ".*jobs\.tsv" is also the list or the job log', (mesh, "jobs.tsv", edit))
        refused(r'line 2: ".*log" is also the list or the job log', (mesh, "log", edit), options=("--job-log", "log"))
        refused(r'line 2: ".*log" is the job log: give the log another name', ("log", "out.ply", edit),
                options=("--job-log", "log"))
        refused(r"line 2: fractions are for JSON edits", (mesh, "out.ply", "s.mlx"), options=("--fraction", "0.5"))
        refused(r"job log .*s\.mlx.*: it is not a job log", options=("--job-log", "s.mlx"))
        refused(r"job log .*cannot be written", options=("--job-log", "none/log"), code=UNWRITABLE)
        for sentence, arguments in (
                (r"File names and --list are given together", ("--list", "jobs.tsv", mesh, output, edit)),
                (r"--job-log and --resume are for --list", (mesh, output, edit, "--resume")),
                (r"--jobs is for --list and --fractions", (mesh, output, edit, "--jobs", 2)),
                (r'number of jobs is "0"', ("--list", "jobs.tsv", "--jobs", 0)),
                (r"The option --resume reads the job log: give --job-log too", ("--list", "jobs.tsv", "--resume")),
                (r"--report is for one job", ("--list", "jobs.tsv", "--report", "r.json"))):
            code, _, errors = self.run_command(*arguments)
            self.assertEqual(code, WRONG_USAGE)
            self.assertRegex(errors, sentence)
        for name in ("none.tsv", "family", "/proc/self/mem"):
            code, output, errors = self.run_command("--list", name)
            self.assertEqual((code, output), (UNREADABLE, ""))
            self.assertRegex(errors, r"\AThe list .* cannot be read: [^\n]*; no job was begun\.\n\Z")

    @unittest.skipUnless(shutil.which("strace"), "needs strace")
    def test_an_error_of_reading_is_not_the_end(self):
        """Each read after the first of a file fails: of a list, an edit, a job log, a mesh."""
        pairs = self.family(3)
        edit = self.place / "family" / "edit.json"
        folder = self.place / "fails"
        folder.mkdir()
        jobs, log, large, mesh = (folder / name for name in ("jobs.tsv", "log.jsonl", "edit.json", "mesh.off"))
        jobs.write_text("".join(f"{pairs[0][0]}\t{self.place}/{k:0200}.ply\t{edit}\n" for k in range(900)))
        log.write_text('{"laplacian_edit_job": 1}\n' * 10000)
        large.write_text(edit.read_text() + " " * 200000)
        mesh.write_text(pairs[0][0].read_text() + "\n" * 2000000)
        short = self.write_list((pairs[0][0], "out.ply", edit))
        before = sorted(self.place.rglob("*"))
        for path, sentence, arguments in (
                (jobs, r"\AThe list .*jobs\.tsv. cannot be read after line \d+: .*error; no job was begun\.\n\Z",
                 ("--list", jobs)),
                (log, r"\AThe job log .*log\.jsonl. cannot be read: .*error\.\n\Z", ("--list", short, "--job-log", log)),
                (large, r"\AThe edit .*edit\.json. cannot be read: .*error\.\n\Z", (pairs[0][0], "out.ply", large)),
                (mesh, r"\AThe mesh .*mesh\.off. cannot be read: .*error\.\n\Z", (mesh, "out.ply", edit))):
            with self.subTest(path.name):
                # Only the trace of that file: its first read works.
                code, output, errors = self.ended(self.start(
                    "strace", "--follow-forks", "--quiet=all", "--output=/dev/null", f"--trace-path={path}",
                    "--trace=read", "--inject=read:error=EIO:when=2+", COMMAND, *arguments,
                    environment={"LC_ALL": "C"}))
                self.assertEqual((code, output), (UNREADABLE, ""), errors)
                self.assertRegex(errors, sentence)
                self.assertEqual(sorted(self.place.rglob("*")), before)

    def test_what_is_done_again(self):
        pairs = self.family(4)
        command = ("--list", "family/jobs.tsv", "--job-log", self.log, "--resume")

        def redone(*options):
            before = len(self.entries())
            self.done(*command, *options)
            return [entry["line"] for entry in sorted(self.entries()[before:], key=lambda entry: entry["line"])]

        self.done(*command)
        self.assertEqual(redone(), [])
        pairs[1][1].unlink()
        self.assertEqual(redone(), [2])
        os.utime(pairs[2][0])
        self.assertEqual(redone(), [3])
        self.assertEqual(redone("--fraction", "0.5"), [1, 2, 3, 4])
        os.utime(self.place / "family" / "edit.json")
        self.assertEqual(redone(), [1, 2, 3, 4])
        # An output that was emptied, or lost its report.
        pairs[3][1].write_bytes(b"")
        self.assertEqual(redone(), [4])

    def test_lines_of_the_log_that_cannot_be_read(self):
        """What a power failure leaves is skipped, wherever it is, and its jobs are done again."""
        self.family(4)
        command = ("--list", "family/jobs.tsv", "--job-log", self.log, "--resume")
        self.done(*command)
        lines = self.log.read_bytes().splitlines(keepends=True)
        for count, where, text in (
                (1, "line 1 is no entry and is skipped; its job counts", b"".join([lines[0][:60] + b"\n", *lines[1:]])),
                (1, "line 4 is no entry and is skipped; its job counts", b"".join(lines)[:-20]),
                (2, "lines 1, 3 are no entries and are skipped; their jobs count",
                 b"".join([bytes(40) + b"\n", lines[1], b'{"began":1, "in"\n', lines[3]])),
                (4, "line 1 is no entry", lines[0][:5]),
                (4, "line 1 is no entry", bytes(4096))):
            with self.subTest(text[:20]):
                self.log.write_bytes(text)
                code, output, errors = self.run_command(*command)
                self.assertEqual(code, 0, errors)
                self.assertRegex(output, rf"\A4 of 4 jobs done( \({4 - count} of them before\))?, 0 failed\.\n\Z")
                self.assertRegex(errors, rf"\AThe job log .*log\.jsonl.: {where}[^\n]*\.\n\Z")
                self.assertEqual(self.log.read_bytes().splitlines(keepends=True)[:-count],
                                 (text if text.endswith(b"\n") else text + b"\n").splitlines(keepends=True))
                output = self.run_command(*command)[1]
                self.assertEqual(output, "4 of 4 jobs done (4 of them before), 0 failed.\n")

    def test_memory_and_processes_are_bounded(self):
        """What starts the jobs opens no mesh, has one thread, and has no more than so many jobs at once."""
        peaks = []
        for side in (15, 301):
            meshes = [write_ply(self.place / f"{side}-{k}.ply", *dome(side, side)) for k in range(4)]
            edit = {"region": {"radius": 0.2}, "handles": [{"vertices": "112", "translation": [0, 0, 0.1]}]}
            (self.place / "edit.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [edit]}))
            jobs = self.write_list(*((m, f"{m.stem}-out.ply", "edit.json") for m in meshes))
            log = self.place / f"{side}.jsonl"
            process = self.start(COMMAND, "--list", jobs, "--jobs", 2, "--job-log", log)
            peak = most = threads = 0
            while process.poll() is None:
                for parent in children(process.pid):
                    peak = max(peak, status(parent, "VmHWM"))
                    threads = max(threads, status(parent, "Threads"))
                    most = max(most, len(children(parent)))
                time.sleep(0.0005)
            code, _, errors = self.ended(process)
            self.assertEqual((code, errors), (0, ""))
            self.assertGreater(peak, 0)
            self.assertEqual(threads, 1)
            self.assertLessEqual(most, 2)
            peaks.append((peak, max(entry["most_memory"] for entry in self.entries(log)) // 1024))
        (small, small_job), (large, large_job) = peaks
        self.assertEqual(most, 2)
        self.assertGreater(large_job, small_job + 20000)
        self.assertLess(large, small + 4000)


class Poses(ListTest):
    FRACTIONS = ",".join(str(k / 20) for k in range(1, 21))

    def setUp(self):
        super().setUp()
        self.mesh = write_ply(self.place / "mesh.ply", *dome(61, 61))
        self.edit = self.place / "edit.json"
        self.edit.write_text(json.dumps({"laplacian_edit": 1, "steps": [
            {"region": {"radius": 0.3}, "handles": [{"vertices": "1860", "translation": [0, 0, 0.2]}]}]}))
        self.arguments = (self.mesh, "all.ply", self.edit, "--quiet", "--fractions", self.FRACTIONS)

    def outputs(self):
        return {path.name: path.read_bytes() for path in self.place.glob("all-*")}

    def unwritable(self, sentence, process):
        code, _, errors = self.ended(process)
        self.assertEqual(code, UNWRITABLE, errors)
        self.assertRegex(errors, rf"\A[^\n]*{sentence}[^\n]*\n\Z")
        self.assertEqual({path.name for path in self.place.iterdir()}, {"mesh.ply", "edit.json"})

    def test_several_processes_write_the_same_bytes(self):
        self.done(*self.arguments)
        alone = self.outputs()
        self.assertEqual(len(alone), 20)
        for jobs in (3, 50):
            for path in self.place.glob("all-*"):
                path.unlink()
            self.done(*self.arguments, "--jobs", jobs, "--report", "report.json")
            self.assertEqual(self.outputs(), alone)
        self.assertGreater(json.loads((self.place / "report.json").read_text())["milliseconds"]["write"], 0)

    def test_one_that_ends_by_a_signal_ends_all(self):
        process = self.start(COMMAND, *self.arguments, "--jobs", 2)

        def writers():
            return [writer for worker in children(process.pid) for writer in children(worker)]

        self.wait_until(lambda: len(writers()) == 2 and list(self.place.glob(".laplacian-edit-*/all-*")), process)
        os.kill(writers()[1], signal.SIGABRT)
        self.unwritable(r"stopped with an error of its own while writing .*signal 6.*nothing was written", process)

    def test_what_one_cannot_write_is_reported_once(self):
        def limited():
            resource.setrlimit(resource.RLIMIT_FSIZE, (50000, 50000))

        self.unwritable(r"output .*all-\d+\.ply.* cannot be written: ",
                        self.start(COMMAND, *self.arguments, "--jobs", 2, preexec_fn=limited))

    def test_what_does_not_arrive_to_the_last_byte_is_seen(self):
        sanitizer = [self.environment["LD_PRELOAD"]] if os.environ.get("LAPEDIT_PRELOAD") else []
        library = {"LD_PRELOAD": ":".join([*sanitizer, os.environ["LAPEDIT_SHORT_LIBRARY"]])}
        for options in ((), ("--jobs", 2)):
            self.unwritable(r"output .*all-\d+\.ply.* cannot be written: the written file is not complete",
                            self.start(COMMAND, *self.arguments, *options, environment=library))


@unittest.skipUnless(shutil.which("parallel"), "needs GNU parallel (Debian: parallel)")
class Parallel(ListTest):
    def joblog(self):
        path = self.place / "family" / "parallel.log"
        return path.read_text().splitlines()[1:] if path.exists() else []

    def test_killed_half_way_and_taken_up_again(self):
        pairs = self.family(200)
        process = self.start("bash", "-c", PARALLEL, start_new_session=True)
        self.wait_until(lambda: len(self.joblog()) > 80, process)
        os.killpg(process.pid, signal.SIGKILL)
        self.ended(process)
        first = len(self.joblog())
        self.assertLess(first, 200)
        code, _, errors = self.ended(self.start("bash", "-c", PARALLEL))
        self.assertEqual(code, 0, errors)
        self.assertEqual(sorted(int(line.split("\t")[0]) for line in self.joblog()), list(range(1, 201)))
        self.require_edited(pairs)

    def test_several_hosts(self):
        pairs = self.family(30)
        (self.place / "family" / "hosts").write_text("2/ada\n2/grace\n")
        stand_in = self.place / "ssh"
        stand_in.write_text("""#!/bin/sh
# Replaces ssh: the words after the host are the command. As on any host, a login has a shell.
export SHELL=/bin/sh
while [ $# -gt 0 ]; do
  word=$1
  shift
  case $word in ada | grace) echo "$word" >>"$HOSTS_SEEN"; break ;; esac
done
[ "$1" != -- ] || shift
exec sh -c "$*"
""")
        stand_in.chmod(0o755)
        seen = self.place / "seen"
        code, _, errors = self.ended(self.start("bash", "-c", HOSTS, environment={
            "PARALLEL_SSH": str(stand_in), "HOSTS_SEEN": str(seen)}))
        self.assertEqual(code, 0, errors)
        self.assertEqual(set(seen.read_text().split()), {"ada", "grace"})
        self.assertEqual({line.split("\t")[1] for line in self.joblog()}, {"ada", "grace"})
        self.require_edited(pairs)


class Slurm(ListTest):
    def task(self, number, first=1, step=2, count=3):
        return self.start(SLURM, "family/jobs.tsv", "family/logs", environment={
            "SLURM_ARRAY_TASK_ID": str(first + step * number), "SLURM_ARRAY_TASK_MIN": str(first),
            "SLURM_ARRAY_TASK_STEP": str(step), "SLURM_ARRAY_TASK_COUNT": str(count), "SLURM_CPUS_PER_TASK": "2"})

    def test_script_is_sound(self):
        subprocess.run(["bash", "-n", SLURM], check=True)
        if shutil.which("shellcheck"):
            subprocess.run(["shellcheck", SLURM], check=True)

    def test_tasks_of_an_array(self):
        pairs = self.family(20)
        for number in range(3):
            self.assertEqual(self.ended(self.task(number))[0], 0)
            made = sum(output.exists() for _, output in pairs)
            self.assertEqual(made, sum(1 for k in range(20) if k % 3 <= number))
        self.require_edited(pairs)
        made = {output: output.stat().st_mtime_ns for _, output in pairs}
        pairs[4][1].unlink()
        outputs = [self.ended(self.task(number))[1] for number in range(3)]
        self.assertEqual(outputs[1], "7 of 7 jobs done (6 of them before), 0 failed.\n")
        again = {output for output in made if output.stat().st_mtime_ns != made[output]}
        self.assertEqual(again, {pairs[4][1]})

    def test_without_an_array(self):
        code, _, errors = self.ended(self.start("env", "-u", "SLURM_ARRAY_TASK_COUNT", SLURM, "family/jobs.tsv"))
        self.assertNotEqual(code, 0)
        self.assertIn("sbatch --array", errors)


if __name__ == "__main__":
    unittest.main()
