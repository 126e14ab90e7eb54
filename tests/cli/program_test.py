# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit: options, exit codes, messages, pipes, and what it does where the system grants little."""
import json
import math
import os
import pathlib
import pty
import re
import resource
import shutil
import subprocess
import sys
import unittest

from program import (ADVISED, CENTRE, COMMAND, DOME, FACES, LEAN, LIFT, POINTS, REFUSED, SANITIZED, UNEXPECTED, UNREADABLE,
                     UNWRITABLE, WRONG_USAGE, MeshBytes, ProgramTest, files)
from shapes import dome, moved, together

SOURCES = pathlib.Path(__file__).parents[2] / "common" / "cli"
sys.path.append(str(pathlib.Path(__file__).parents[1] / "documents"))

from documents import Document, code  # noqa: E402

DOCUMENT = Document(SOURCES / "README.md")


def keys(value):
    """All keys in a JSON value."""
    if isinstance(value, dict):
        return set(value).union(*map(keys, value.values()))
    return set().union(*map(keys, value)) if isinstance(value, list) else set()


class Usage(ProgramTest):
    def test_help_page_and_completion_have_the_same_options(self):
        text = self.done("--help")
        known = {name for short, *words in re.findall(r"(?m)^  (?:(-\w), )?(--[\w-]+)(?: (\S+(?: \S+)*))?  ", text)
                 for name in (short, " ".join(words).strip()) if name}
        self.assertEqual({name for row in DOCUMENT.rows("Options") for name in code(row[0])}, known)
        options = {name.split()[0] for name in known if name.startswith("--")}
        self.assertLess(max(map(len, text.splitlines())), 82)
        codes = re.findall(r"(?m)^  (\d)  (.+)$", text)
        self.assertEqual([number for number, _ in codes], list("0123456"))
        page = (SOURCES / "laplacian-edit.1").read_text(encoding="utf-8").replace("\\-", "-")
        self.assertEqual(re.findall(r"(?m)^\.B (\d)\n(.+)$", page), codes)
        self.assertEqual([row[0] for row in DOCUMENT.rows("Exit codes")], [number for number, _ in codes])
        self.assertEqual(set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", page.split(".SH OPTIONS")[1].split(".SH EXIT")[0])),
                         {name.split()[0] for name in known})
        script = 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _laplacian_edit "$1"; printf "%s\\n" "${COMPREPLY[@]}"'
        for word, expected in (("--", options), ("--fr", {"--fraction", "--fractions"}), ("in", set())):
            done = subprocess.check_output(["bash", "-c", script, SOURCES / "completion.bash", COMMAND, word], encoding="utf-8")
            self.assertEqual(set(done.split()), expected)
        self.assertRegex(self.done("--version"), r"\Alaplacian-edit \d+\.\d+\.\d+\n\Z")

    @unittest.skipUnless(shutil.which("readelf"), "needs readelf")
    def test_loads_no_library_of_meshlab_or_qt_and_none_from_another_folder(self):
        self.assertNotRegex(subprocess.check_output(["readelf", "-d", COMMAND], encoding="utf-8"), r"meshlab|Qt5|R(UN)?PATH")

    def test_wrong_usage(self):
        two, points = (self.mesh, "out.ply"), self.folder / "from.csv"
        points.write_text("nose,0,0,0\n")
        good, landmarks = (*two, self.edit), ("--landmarks", points, points)
        for sentence, arguments in (
                (r"There are 0 file names", ()), (r"There are 2 file names", two), (r"There are 4 file names", (*good, "x")),
                (r'no option "--sideways"', (*good, "--sideways")), (r"--fraction takes a value", (*good, "--fraction")),
                (r"takes no value", (*good, "--quiet=1")), (r"--report is empty", (*good, "--report", "")),
                (r"begins with - as \./-name, or after --", (self.mesh, "-dash.ply", self.edit)),
                *((r"name of a file is empty", words) for words in (("", *good[1:]), (self.mesh, "", self.edit), (*two, ""))),
                *((rf'fraction is "{text}"', (*good, "--fraction=" + text)) for text in ("2", "nan", "half")),
                *((rf'fraction is "{re.escape(text)}": .* first:last:count', (*good, "--fractions", text))
                  for text in ("0.25,half", "0.25,,1", "0:2:3", "0:1", "0:1:1", "0:1:10000", "0:1:2.5")),
                (r"either --fraction, with one number, or --fractions", (*good, "--fraction", "1", "--fractions", "0,1")),
                (r"--fraction is given more than once", (*good, "--fraction", "1", "--fraction", "0")),
                (r"output .* and the report .* are the same file", (*good, "--report", "out.ply")),
                (r"--landmarks takes two files", (*two, "--landmarks", points)),
                (r"--landmarks takes two files", (*two, f"--landmarks={points}", points)),
                (r"There are 3 file names: .* with --landmarks", (*good, *landmarks)),
                (r"give the mesh alone with --nearest or --info", (*good, "--info")), (r"0 file names", ("--nearest", "0,0,0")),
                *((f'"{text}": give three numbers', (self.mesh, "--nearest", text)) for text in ("0,0", "0,0,nan", "0,0,0,0")),
                (r"--contact without --fit", (*two, "--contact", "--symmetrise")),
                (r"standard input is named twice", ("-", "out.ply", "-")),
                (r"standard input is named twice", ("-", "out.ply", "--landmarks", points, "-")),
                (r"report cannot be written to the standard output: give a file", (*good, "--report", "-")),
                (r"cannot be written to the standard output: give a file", (self.mesh, "-", self.edit, "--fractions", "0,1")),
                *((rf'"{name}" is in no format .* MeshLab or PyMeshLab', (self.mesh, name, self.edit))
                  for name in ("out.dae", "out", "out.ply.gz", "ply")),
                (r'"in\.xyz" is in no format', ("in.xyz", "out.ply", self.edit)),
                (r'output "out\.off" is of another format .* MeshLab or PyMeshLab', (self.mesh, "out.off", self.edit))):
            self.refused(WRONG_USAGE, sentence + r".* See --help\.", *arguments)

    def test_files_that_cannot_be_read(self):
        script = self.folder / "script.mlx"
        script.write_text("<!DOCTYPE FilterScript>\n<FilterScript></FilterScript>\n")
        self.refused(REFUSED, r"filter script: .*window.*meshlabserver.*2020\.09.*PyMeshLab", self.mesh, "out.ply", script)
        self.refused(UNREADABLE, r"mesh \"none\.ply\" cannot be read: it does not exist", "none.ply", "out.ply", self.edit)
        self.refused(UNREADABLE, r"edit \"none\.json\" .* does not exist", self.mesh, "out.ply", "none.json")
        self.refused(UNREADABLE, r"it is a folder", self.mesh, "out.ply", self.folder)
        for sentence, steps in ((r"441 vertices", [{**LIFT, "handles": [{"vertices": "441"}]}]),
                                (r"Step 2 of 2: .*radius is -1", [LIFT, {**LIFT, "region": {"radius": -1}}])):
            self.refused(REFUSED, sentence, self.mesh, "out.ply", self.write_edit(*steps))
        self.edit.write_text("{")
        self.refused(REFUSED, r"edit\.json\": .*line 1", self.mesh, "out.ply", self.edit)
        os.truncate(self.edit, 100 << 20)
        self.refused(UNREADABLE, r"edit\.json.* it is larger than \d+ bytes", self.mesh, "out.ply", self.edit)


class Edits(ProgramTest):
    def report(self, *arguments):
        self.done(self.mesh, "out.ply", *arguments, "--report", "report.json", "--quiet")
        return json.loads((self.work / "report.json").read_text())

    def test_each_pose_has_the_bytes_that_it_has_alone(self):
        edit = self.write_edit({**LIFT, "region": {"radius": 0.2}}, LEAN)
        report = self.report(edit, "--fractions", "0.25,1,0,0.5")
        self.assertEqual(len(list(self.work.iterdir())), 5)
        for k, fraction in enumerate((0.25, 1, 0, 0.5)):
            together = self.work / f"out-000{k + 1}.ply"
            self.assertEqual(together.read_bytes(), self.edited(edit, "--fraction", fraction))
            output = report["outputs"][k]
            self.assertEqual((output["file"], output["fraction"]), (str(together), fraction))
            self.assertEqual([step["milliseconds"]["factorisation"] > 0 for step in output["steps"]][0], k == 0)
        self.assertEqual((self.work / "out-0003.ply").read_bytes(), self.mesh.read_bytes())
        self.assertEqual([output["fraction"] for output in self.report(edit, "--fractions", "0:1:5")["outputs"]],
                         [0, 0.25, 0.5, 0.75, 1])

    def test_steps_apply_in_order_each_to_the_stored_result_of_the_one_before(self):
        for scalar in ("float", "double"):
            self.mesh.write_bytes(files.ply_plain(DOME, scalar))
            together = self.edited(self.write_edit(LIFT, LEAN))
            self.assertNotEqual(self.edited(self.write_edit(LEAN, LIFT)), together)
            self.mesh.write_bytes(self.edited(self.write_edit(LIFT)))
            self.assertEqual(self.edited(self.write_edit(LEAN)), together)

    def test_far_from_the_origin_single_precision_is_what_a_handle_is_off_by(self):
        edit = self.write_edit({**LIFT, "handles": [{"vertices": str(CENTRE), "translation": [0.01, 0, 0]}]})
        for scalar in ("float", "double"):
            self.mesh.write_bytes(files.ply_plain(([(x + 1e5, y, z) for x, y, z in POINTS], FACES), scalar))
            (step,) = self.report(edit)["outputs"][0]["steps"]
            before, after = (MeshBytes("a.ply", path.read_bytes()).points[CENTRE] for path in (self.mesh, self.work / "out.ply"))
            off = math.dist(after, (before[0] + 0.01, *before[1:]))
            self.assertAlmostEqual(step["handle_residual"], off, delta=1e-8)
            self.assertEqual(off > 1e-3, scalar == "float")  # numbers there are 1/128 apart
            self.assertEqual("mesh keeps coordinates in steps of 0.0119: move the mesh to the origin" in (step["advice"] or ""), scalar == "float")

    def test_report(self):
        edit = self.write_edit(LIFT, LEAN)
        report = self.report(edit)
        self.assertEqual(set(report), {"laplacian_edit_report", "program", "scalar", "input", "edit", "mesh", "outputs",
                                       "milliseconds"})
        first, all_keys = ({name for row in DOCUMENT.rows("The report") for cell in row[:cells] for name in code(cell)} for cells in (1, 2))
        self.assertLessEqual(first, keys(report))
        self.assertLessEqual(keys(report), all_keys)
        self.assertEqual((report["laplacian_edit_report"], report["scalar"], report["input"], report["edit"], report["mesh"]),
                         (1, "float", str(self.mesh), str(edit), {"vertices": 441, "faces": 800}))
        self.assertEqual(report["program"] + "\n", self.done("--version"))
        (output,) = report["outputs"]
        self.assertEqual(set(output), {"file", "fraction", "shared_normals", "steps"})
        self.assertEqual([step["handle"] for step in output["steps"]], [1, 1])
        self.assertRegex(self.done(self.mesh, "out.ply", edit), r"\AStep 1 of 2\nRegion: 1 handle, [^$]*\nStep 2 of 2\nRegion: ")
        self.mesh.write_bytes(files.ply_plain(DOME, "double"))
        self.assertEqual(self.report(edit)["scalar"], "double")

    def test_poses_take_the_memory_of_one(self):
        side = 120
        points = [(i / 10, j / 10, (i * j % 7) / 50) for j in range(side) for i in range(side)]
        corners = [j * side + i for j in range(side - 1) for i in range(side - 1)]
        self.mesh.write_bytes(files.ply_plain((points, [face for a in corners for face in ((a, a + 1, a + side), (a + 1, a + side + 1, a + side))])))
        edit, most = self.write_edit({"region": {"radius": 0.3}, "handles": [{"vertices": str(side * side // 2), "translation": [0, 0, 0.1]}]}), []
        for count in (2, 150):
            process = self.start("--quiet", self.mesh, "out.ply", edit, "--fractions", f"0:1:{count}")
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            process.communicate()
            self.assertEqual(process.returncode, 0)
            most.append(used.ru_maxrss)
        self.assertLess(most[1] - most[0], 20 * side * side * 24 / 1024, "kB: 20 poses of the whole mesh")

    def test_quality_counts_new_intersections(self):
        side = self.write_edit({"region": {"radius": 0.5}, "handles": [{"vertices": "220", "translation": [1.4, 0.1, -0.3]}]})
        code, _, errors = self.run_program(self.mesh, "out.ply", side, "--quality", "--report", "report.json")
        if code == WRONG_USAGE:
            self.skipTest(errors)
        (step,) = json.loads((self.work / "report.json").read_text())["outputs"][0]["steps"]
        self.assertGreater(step["new_intersections"], 0)
        self.assertIsNone(self.report(side)["outputs"][0]["steps"][0]["new_intersections"])

    def test_advice_is_an_error_with_strict(self):
        low, high = ({**LIFT, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, z]}]} for z in (0.02, 3))
        edit = self.write_edit(low, high)
        self.refused(ADVISED, r"\AWith --strict nothing was written: at fraction 1, step 2 of 2, .*: ", self.mesh, "out.ply", edit,
                     "--fractions", "0,1", "--strict")
        self.refused(ADVISED, r"nothing was written: step 2 of 2, ", self.mesh, "out.ply", edit, "--strict", "--quiet")
        self.done(self.mesh, "out.ply", self.write_edit(low), "--strict")

    def test_a_refusal_names_step_and_fraction(self):
        far = {**LIFT, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 1e39]}]}
        self.refused(REFUSED, r"\AStep 2 of 2: At fraction 0\.5: The result does not fit", self.mesh, "out.ply", self.write_edit(LIFT, far),
                     "--fractions", "0,0.5")

    def test_landmarks(self):
        start, end, (x, y, z) = self.work / "from.csv", self.work / "to.csv", POINTS[CENTRE]
        start.write_text(f"nose,{x},{y},{z}\nchin,0,0,0\n")
        end.write_text(f"nose,{x},{y},{z + 0.1}\nchin,0,0,0\n")
        report = self.report("--landmarks", start, end)
        self.assertEqual((report["edit"], report["targets"]), (str(start), str(end)))
        moved = MeshBytes("out.ply", (self.work / "out.ply").read_bytes()).points
        self.assertAlmostEqual(moved[CENTRE][2], z + 0.1, delta=0.01)
        end.unlink()
        self.refused(UNREADABLE, r"to\.csv.* does not exist", self.mesh, "out.ply", "--landmarks", start, end)

    def test_answers(self):
        self.assertRegex(self.done("--info", self.mesh), r"\Avertices: 441 \(0 without a face, 0 not finite\)\nfaces: 800\n"
                         r"box: 0,0,0 to 1,1,0\.\d+, diagonal \S+\npieces: 1, .*\nborders: 1 of 80 edges in all\nselected: 0 ")
        points, faces = DOME
        tetrahedron, holed = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], [*points[:30], (math.nan, 0, 0), *points[31:]]
        for mesh, words in (((points + [(9, 9, 9)], faces), r"442 \(1 without a face, 0 not finite\)"), ((holed, faces), "0 without a face, 1 not"),
                            (together(DOME, moved(DOME, 1, (2, 0, 0))), "pieces: 2, the largest of 441 vertices\nborders: 2 of 160 edges"),
                            ((points[:4], tetrahedron), "pieces: 1, .*\nborders: 0 of 0 edges"), ((points, []), r"\(441 without .*\n.*\n.*\npieces: 0, ")):
            (self.work / "any.ply").write_bytes(files.ply_plain(mesh, form="binary_little_endian"))
            self.assertRegex(self.done("--info", "any.ply"), words)
        for far in (1e308, 1e200, 1e-308):
            stray = [*points, (-far, far, 0), (far, -far, far), (0, far, far)], [*faces, (441, 442, 443)]
            (self.work / "stray.ply").write_bytes(files.ply_plain(stray, "double"))
            self.assertRegex(self.done("--nearest", "0.5,0.5,0.3", "stray.ply"), rf"\Avertex: {CENTRE}, ")
        text = self.done("--nearest", "0.5,0.5,0.3", "--nearest=0,0,0", self.mesh, "--info")
        self.assertRegex(text, rf"(?s)\Avertices: .*\nvertex: {CENTRE}, position: 0\.5,0\.5,\S+, distance: \S+\nvertex: 0, .*: 0\n\Z")

    def test_a_face_that_names_a_corner_twice_or_is_repeated_changes_no_bit(self):
        wide = {**LIFT, "region": {**LIFT["region"], "tips": True, "pieces": True, "connect": 0.1}}
        edits = [self.write_edit({**step, "method": method}, name=f"{method}{step is wide}.json")
                 for step in (LIFT, wide) for method in ("default", "paper", "linear")]

        def results():
            for edit in edits:
                (step,) = self.report(edit)["outputs"][0]["steps"]
                yield MeshBytes("out.ply", (self.work / "out.ply").read_bytes()).points, {**step, "milliseconds": None}
        expected = list(results())
        for faces in ([(a, b, c, c) for a, b, c in FACES],
                      [f for a, b, c in FACES for f in ((a, b, c), (b, a, b), (c, b, a), (b, c, a))]):
            self.mesh.write_bytes(files.ply_plain((POINTS, faces)))
            self.assertEqual(list(results()), expected)
            self.assertRegex(self.done("--info", self.mesh), r"\nfaces: \d+ \(\d+ ignored: .*\n.*\n.*\nborders: 1 of 80 edges")


class Streams(ProgramTest):
    def test_pipes(self):
        data, edit, expected = self.mesh.read_bytes(), self.edit.read_bytes(), self.edited()
        self.assertEqual(self.done("-", "-", self.edit, given=data), expected)
        self.assertEqual(self.done(self.mesh, "-", "-", given=edit), expected)
        self.done("-", "out.ply", self.edit, given=data)
        self.assertEqual((self.work / "out.ply").read_bytes(), expected)
        obj = files.obj(DOME)
        self.done("-", "out.obj", self.edit, "--fraction", "0", given=obj)
        self.assertEqual((self.work / "out.obj").read_bytes(), obj)
        self.assertIn(b"vertices: 441 ", self.done("--info", "-", given=data))
        self.refused(UNREADABLE, r"mesh from the standard input cannot be read: ", "-", "new.ply", self.edit, given=obj)
        for name in ("/dev/stdin", "/dev/fd/0"):
            self.done(self.mesh, "out.ply", name, "-q", given=edit)
            self.assertEqual((self.work / "out.ply").read_bytes(), expected)

    def test_progress_is_for_terminals(self):
        for quiet, kind in ((False, "xterm"), (True, "xterm"), (False, "dumb")):
            terminal, other_end = pty.openpty()
            with self.start(self.mesh, "out.ply", self.edit, *["--quiet"] * quiet, stderr=other_end,
                            env={**os.environ, "TERM": kind}) as process:
                os.close(other_end)
                text = b""
                try:
                    while part := os.read(terminal, 1000):
                        text += part
                except OSError:  # the other end is closed
                    pass
                process.communicate(timeout=60)
            os.close(terminal)
            self.assertEqual(process.returncode, 0)
            self.assertRegex(text, rb"\A\Z" if quiet or kind == "dumb" else rb"\r\x1b\[K +\d+ % factorisation.*\r\x1b\[K\Z")

    def test_standard_output_that_cannot_be_written(self):
        end, other_end = os.pipe()
        os.close(end)
        with open("/dev/full", "wb") as full:
            for output, why in ((other_end, "Broken pipe"), (full, "No space left.*")):
                for name, sentence in (("out.ply", "nothing was written; with --quiet"), ("-", "what arrived is not complete")):
                    self.refused(UNWRITABLE, rf"standard output .*\({why}\): {sentence}", self.mesh, name, self.edit, stdout=output)
            self.refused(UNWRITABLE, r"standard output cannot be written to \(it is closed\)", self.mesh, "out.ply", self.edit,
                         stdout=None, preexec_fn=lambda: os.close(1))
            self.refused(UNWRITABLE, r"standard output cannot", "--help", stdout=full)
            self.done(self.mesh, "quiet.ply", self.edit, "--quiet", stdout=full)
        os.close(other_end)


@unittest.skipIf(SANITIZED, "a sanitizer takes all address space")
class Limits(ProgramTest):
    def test_less_and_less_memory(self):
        """Down to where not even the libraries can be loaded: one message, and no output or all of it."""
        self.mesh.write_bytes(files.ply_plain(dome(151, 151)))
        expected, codes = self.edited(), []
        for megabytes in (*range(2, 12), *range(12, 60, 4), 400):
            output, size = self.work / f"{megabytes}.ply", megabytes << 20
            code, _, errors = self.run_program(self.mesh, output, self.edit, "-q",
                                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
            with self.subTest(megabytes=megabytes):
                codes.append(code)
                self.assertEqual(output.read_bytes() if output.exists() else None, expected if code == 0 else None, errors)
                if code == UNEXPECTED:
                    self.assertRegex(errors, r"\AThere was not enough memory: nothing was written; allow more [^\n]*\.\n\Z")
        # Below 12 MB the loader or the kernel may end the program before it begins.
        self.assertLessEqual(set(codes[10:]), {0, UNEXPECTED})
        self.assertEqual((codes[10], codes[-1]), (UNEXPECTED, 0))
        self.assertEqual([path for path in self.work.iterdir() if path.name[0] == "."], [])


if __name__ == "__main__":
    unittest.main()
