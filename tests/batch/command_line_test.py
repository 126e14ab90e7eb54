# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit: options, exit codes, formats, and that nobody's files suffer."""
import json
import os
import pathlib
import pty
import re
import resource
import struct
import subprocess
import time
import unittest

from host import COMMAND, HostTest, laplacian_edit, replay, select_faces, select_vertices, without_display
from ply import SCALAR, Ply, bits_of, write_ply
from shapes import dome, moved, together

CENTRE = 21 * 10 + 10  # vertex in the middle of the dome
DOCUMENTS = pathlib.Path(__file__).parents[2] / "filter_laplacian_edit" / "command_line"
PAGE, COMPLETION = DOCUMENTS / "laplacian-edit.1", DOCUMENTS / "completion.bash"
REFUSED, WRONG_USAGE, UNREADABLE, UNWRITABLE, UNEXPECTED, ADVISED = 1, 2, 3, 4, 5, 6


def version():
    text = subprocess.run([COMMAND, "--version"], stdout=subprocess.PIPE, check=True).stdout.decode()
    return re.fullmatch(r"laplacian-edit [\d.]+ on (MeshLab (\d{4})\.\S+)\n", text)


class CommandTest(HostTest):
    screen = None

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points, cls.faces = dome()
        cls.home = cls.folder / "home"
        cls.home.mkdir()
        cls.lift = {"region": {"radius": 0.35}, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 0.2]}]}
        cls.lean = {"region": {"radius": 0.3}, "handles": [{"vertices": "155", "translation": [0.05, 0, 0.1]}]}

    def setUp(self):
        self.place = self.folder / self.id().rsplit(".", 1)[1]
        self.place.mkdir()
        self.mesh = write_ply(self.folder / "dome.ply", self.points, self.faces)
        self.edit = self.write_edit(self.lift)

    def write_edit(self, *steps, name="edit.json"):
        path = self.folder / name
        path.write_text(json.dumps({"laplacian_edit": 1, "steps": steps}))
        return path

    def write_script(self, *filters, name="script.mlx"):
        path = self.folder / name
        path.write_text("<!DOCTYPE FilterScript>\n<FilterScript>\n" + "\n".join(filters) + "\n</FilterScript>\n")
        return path

    def start(self, *arguments, **options):
        environment = without_display(self.environment)
        environment.update(options.pop("environment", {}))
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        return subprocess.Popen([COMMAND, *(a if isinstance(a, bytes) else str(a) for a in arguments)], env=environment,
                                cwd=self.place, **{**streams, **options})

    def run_command(self, *arguments, **options):
        """@return exit code, standard output, standard error"""
        with self.start(*arguments, **options) as process:
            try:
                output, errors = process.communicate(timeout=120)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
        return process.returncode, (output or b"").decode(), (errors or b"").decode(errors="replace")

    def done(self, *arguments, **options):
        """Runs what must work, without a word on the standard error. @return the standard output"""
        code, output, errors = self.run_command(*arguments, **options)
        self.assertEqual((code, errors), (0, ""))
        return output

    def refused(self, code, sentence, *arguments, **options):
        """The exit code, one sentence and nothing else; no file is left, changed or new."""
        before = self.snapshot()
        with self.subTest(sentence):
            ended, output, errors = self.run_command(*arguments, **options)
            self.assertEqual(ended, code, errors)
            self.assertRegex(errors, r"\A[^\n]+[.?]\n\Z")
            self.assertRegex(errors, sentence)
            self.assertEqual(self.snapshot(), before)
        return output

    def snapshot(self):
        return {str(path): path.read_bytes() if path.is_file() else None for path in self.place.rglob("*")}

    def writing(self, *arguments, **options):
        """A run that writes for a while, when it has begun to."""
        process = self.start(self.mesh, "all.ply", self.edit, "--fractions", ",".join(["0.5"] * 400), "--quiet", *arguments,
                             **options)
        end = time.monotonic() + 60
        while not list(self.place.glob(".laplacian-edit-*/all-0003.ply")):
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.002)
        return process

    def bits(self, path):
        return Ply(path).point_bits()

    def edited_bits(self, *arguments):
        self.done(self.mesh, "bits.ply", *arguments)
        return self.bits(self.place / "bits.ply")


class Usage(CommandTest):
    def test_help_tells_options_and_exit_codes(self):
        text = self.done("--help")
        for word in ("--fraction ", "--fractions", "--report", "--quality", "--strict", "--also", "--plugins", "--timeout", "--list",
                     "--version"):
            self.assertIn(word, text)
        for code in range(7):
            self.assertRegex(text, rf"\n  {code}  \w+")
        self.assertLess(max(map(len, text.splitlines()[1:])), 82)

    def test_manual_page_has_the_options_and_exit_codes_of_the_help(self):
        page = PAGE.read_text(encoding="utf-8").replace("\\-", "-")
        text = self.done("--help")
        self.assertEqual(set(re.findall(r"(?m)^\.B\w* .*?(--\w+)", page)), set(re.findall(r"--\w+", text)) - {"--options"})
        codes = re.findall(r"(?m)^  (\d)  (.+)$", text)
        self.assertEqual(re.findall(r"(?m)^\.B (\d)\n(.+)$", page), codes)
        self.assertEqual(len(codes), 7)

    def test_completion_has_the_options_of_the_help(self):
        def completed(*words):
            script = 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _laplacian_edit "$1"; printf "%s\\n" "${COMPREPLY[@]}"'
            return set(subprocess.check_output(["bash", "-c", script, COMPLETION, COMMAND, *words], encoding="utf-8").split())

        options = set(re.findall(r"(?m)^ +(?:-\w, )?(--[a-z-]+)", self.done("--help")))
        self.assertEqual(completed("--"), options)
        self.assertGreater(len(options), 15)
        self.assertEqual(completed("--fr"), {"--fraction", "--fractions"})
        self.assertEqual(completed("--also", "n"), {"normals", "normals,selection"})
        self.assertEqual(completed("in"), set())

    def test_version_names_the_host(self):
        self.assertTrue(version())

    def test_wrong_usage(self):
        good = (self.mesh, "out.ply", self.edit)
        script = self.write_script(laplacian_edit())
        for sentence, arguments in (
                (r"There are 0 file names", ()),
                (r"There are 2 file names", good[:2]),
                (r"There are 4 file names", (*good, "x")),
                (r"nknown option.*sideways", (*good, "--sideways")),
                (r"issing value.*fraction", (*good, "--fraction")),
                (r"nknown option.* Give a file name that begins with - as \./-name, or after --\.",
                 (self.mesh, "-dash.off", self.edit)),
                (r"name of the mesh is empty", ("", "out.ply", self.edit)),
                (r"name of the output is empty", (self.mesh, "", self.edit)),
                (r"name of the edit is empty", (self.mesh, "out.ply", "")),
                (r'fraction is "2": give a number from 0', (*good, "--fraction", "2")),
                (r'fraction is "nan"', (*good, "--fraction", "nan")),
                (r'fraction is "half"', (*good, "--fractions", "0.25,half")),
                (r'fraction is ""', (*good, "--fractions", "0.25,,1")),
                (r"either --fraction or --fractions", (*good, "--fraction", "1", "--fractions", "0,1")),
                (r"--fraction is given more than once", (*good, "--fraction", "1", "--fraction", "0")),
                (r'no "colours" to be kept: give normals, selection', (*good, "--also", "colours")),
                (r'time limit is "0": give the seconds', (*good, "--timeout", "0")),
                (r'time limit is "nan"', (*good, "--timeout", "nan")),
                (r"--report is empty", (*good, "--report", "")),
                (r"in a script, give the parameter fraction", (self.mesh, "out.ply", script, "--fraction", "1")),
                (r"in a script, give the parameter fraction", (self.mesh, "out.ply", script, "--fractions", "0,1"))):
            self.refused(WRONG_USAGE, sentence + r".* See --help\.", *arguments)
        self.refused(WRONG_USAGE, r"output .* and the report .* are the same file", *good, "--report", "out.ply")

    def test_wrong_usage_of_places(self):
        table = self.folder / "from.csv"
        table.write_text("nose,0,0,0\n")
        two, landmarks = (self.mesh, "out.ply"), ("--landmarks", table, table)
        for sentence, arguments in (
                (r"--landmarks takes two files: the points, and their targets", (*two, "--landmarks")),
                (r"--landmarks takes two files", (*two, "--landmarks", table)),
                (r"--landmarks takes two files", (*two, "--landmarks", table, "--quiet")),
                (r"--landmarks takes two files", (*two, "--landmarks", "", table)),
                (r"--landmarks", (*two, f"--landmarks={table}", table)),
                (r"--landmarks is given more than once", (*two, *landmarks, *landmarks)),
                (r"There are 3 file names: with --landmarks give the mesh and the output", (*two, self.edit, *landmarks)),
                (r"There are 1 file names: with --landmarks give", (self.mesh, *landmarks)),
                (r"are for one mesh, not for --list", ("--list", "jobs.tsv", *landmarks)),
                (r"are for one mesh, not for --list", ("--list", "jobs.tsv", "--info")),
                (r"There are 3 file names: give the mesh alone with --nearest or --info", (*two, self.edit, "--info")),
                (r"There are 0 file names: give the mesh alone", ("--nearest", "0,0,0")),
                (r'"0,0": give', (self.mesh, "--nearest", "0,0")),
                (r'"0,0,nan": give', (self.mesh, "--nearest", "0,0,nan")),
                (r'"0,0,0,0": give', (self.mesh, "--nearest", "0,0,0,0")),
                (r'fractions are "0:1": give first:last:count', (*two, self.edit, "--fractions", "0:1")),
                (r"a count from 2 to 9999", (*two, self.edit, "--fractions", "0:1:1")),
                (r"a count from 2 to 9999", (*two, self.edit, "--fractions", "0:1:10000")),
                (r"a count from 2 to 9999", (*two, self.edit, "--fractions", "0:1:2.5")),
                (r'fraction is "2": give a number from 0', (*two, self.edit, "--fractions", "0:2:3")),
                (r'fraction is ""', (*two, self.edit, "--fractions", ":1:3")),
                (r"standard input is named twice", ("-", "out.ply", "-"))):
            with self.subTest(sentence):
                self.refused(WRONG_USAGE, sentence + r".* See --help\.", *arguments)
        missing = ("--landmarks", table, "none.csv")
        self.refused(UNREADABLE, r"none\.csv.* does not exist", *two, *missing)
        for content, sentence in (("", "has no landmarks"), ("nose,nan,0,0\n", 'the x of landmark "nose" is "nan"'),
                                  ("nose,0,0,9\nchin,0,0,9\n", '"chin" is only in')):
            targets = self.folder / "to.csv"
            targets.write_text(content)
            self.refused(REFUSED, sentence, *two, "--landmarks", table, targets)
        table.write_text("nose,50,0,0\n")
        self.refused(REFUSED, r'"nose".*diagonal', *two, *landmarks)


class Edits(CommandTest):
    def test_json_has_the_bits_of_the_filter(self):
        edit = self.write_edit(self.lift, self.lean)
        bits = self.edited_bits(edit)
        self.assertEqual(bits, self.edited_bits(self.write_script(replay(self.lift), replay(self.lean))))
        before = [tuple(map(bits_of, p)) for p in self.points]
        self.assertEqual(bits[0], before[0])
        self.assertNotEqual(bits[CENTRE], before[CENTRE])

    def test_reports_are_on_the_standard_output_unless_quiet(self):
        text = self.done(self.mesh, "out.ply", self.write_edit(self.lift, self.lean))
        self.assertRegex(text, r"\AStep 1 of 2\nRegion: 1 handle, [^$]*\nStep 2 of 2\nRegion: ")
        script = self.write_script(select_vertices("x>0.9"), laplacian_edit(handle_source=1, radius=0.3))
        self.assertRegex(self.done(self.mesh, "out.ply", script), r"\Aselected \d+ vert[^\n]*\nRegion: ")
        for edit in (self.edit, script):
            self.assertEqual(self.done(self.mesh, "out.ply", edit, "--quiet"), "")

    def test_edits_are_recognised_by_their_text(self):
        bits = self.edited_bits(self.edit)
        for source in (self.edit, self.write_script(replay(self.lift))):
            unnamed = self.folder / "unnamed"
            unnamed.write_text("\n " + source.read_text())
            if source.suffix == ".mlx":
                unnamed.write_text(source.read_text())
            self.assertEqual(self.edited_bits(unnamed), bits)

    def test_refusals(self):
        def refused(sentence, edit):
            self.refused(REFUSED, sentence, self.mesh, "out.ply", edit)

        refused(r"Step 2 of 2: .*radius is -1", self.write_edit(self.lift, {**self.lift, "region": {"radius": -1}}))
        refused(r"441 vertices", self.write_edit({**self.lift, "handles": [{"vertices": "441"}]}))
        broken = self.folder / "broken.json"
        broken.write_text("{")
        refused(r"line 1", broken)
        huge = self.folder / "huge.json"
        with open(huge, "wb") as file:
            file.write(b"{")
            file.truncate(100 << 20)
        refused(r"104857600 bytes", huge)
        self.refused(UNREADABLE, r"edit .*none\.json.* does not exist", self.mesh, "out.ply", "none.json")
        self.refused(UNREADABLE, r"edit .* is a folder", self.mesh, "out.ply", self.folder)

    def test_progress_is_for_terminals(self):
        for quiet in (False, True):
            terminal, other_end = pty.openpty()
            environment = dict(without_display(self.environment), TERM="xterm")
            with subprocess.Popen(
                    [COMMAND, self.mesh, "out.ply", self.edit] + ["--quiet"] * quiet, cwd=self.place, env=environment,
                    stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=other_end) as process:
                os.close(other_end)
                text = b""
                try:
                    while part := os.read(terminal, 1000):
                        text += part
                except OSError:  # the other end is closed
                    pass
                self.assertNotIn(b"%", process.communicate(timeout=60)[0].split(b"Region")[0])
            os.close(terminal)
            self.assertEqual(process.returncode, 0)
            if quiet:
                self.assertEqual(text, b"")
            else:
                self.assertRegex(text, rb"\r\x1b\[K +\d+ % factorisation\r\x1b\[K")
                self.assertTrue(text.endswith(b"\r\x1b[K"), text)


class Fractions(CommandTest):
    def test_each_pose_has_the_bytes_that_it_has_alone(self):
        # So high that the second region, measured along the surface, ends beyond the first one or within it.
        high = {"region": {"radius": 0.2}, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 1]}]}
        beside = {"region": {"radius": 0.55}, "handles": [{"vertices": "215", "translation": [0.05, 0, 0.1]}]}
        edit = self.write_edit(high, beside)
        fractions = ("0.25", "1", "0", "0.5")
        self.done(self.mesh, "all.ply", edit, "--fractions", ",".join(fractions), "--also", "normals")
        self.assertEqual(len(list(self.place.iterdir())), 4)
        for k, fraction in enumerate(fractions, start=1):
            self.done(self.mesh, "one.ply", edit, "--fraction", fraction, "--also", "normals")
            together = (self.place / f"all-000{k}.ply").read_bytes()
            self.assertEqual(together, (self.place / "one.ply").read_bytes(), fraction)
        self.done(self.mesh, "one.ply", edit, "--fractions", "0,1", "--report", "report.json")
        outputs = json.loads((self.place / "report.json").read_text())["outputs"]
        self.assertNotEqual(*(output["steps"][1]["fixed"] for output in outputs))
        self.assertEqual(self.bits(self.place / "all-0003.ply"), [tuple(map(bits_of, p)) for p in self.points])

    def test_one_factorisation_serves_all(self):
        self.done(self.mesh, "all.ply", self.edit, "--fractions", "0.25,0.5,1", "--report", "report.json")
        outputs = json.loads((self.place / "report.json").read_text())["outputs"]
        self.assertEqual([output["fraction"] for output in outputs], [0.25, 0.5, 1])
        self.assertEqual([pathlib.Path(output["file"]).name for output in outputs],
                         ["all-0001.ply", "all-0002.ply", "all-0003.ply"])
        steps = [output["steps"][0] for output in outputs]
        self.assertEqual([step["factor_taken_over"] for step in steps], [False, True, True])
        self.assertEqual([step["milliseconds"]["factorisation"] > 0 for step in steps], [True, False, False])
        self.assertAlmostEqual(steps[1]["handle_displacement"], 0.1, delta=1e-12)

    def test_either_all_files_are_written_or_none(self):
        (self.place / "all-0002.ply").mkdir()
        (self.place / "all-0001.ply").write_text("old")
        self.refused(UNWRITABLE, r"all-0002\.ply.* is a folder", self.mesh, "all.ply", self.edit, "--fractions", "0,1")
        far = self.write_edit({**self.lift, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 3e38]}]})
        if SCALAR == "float":
            far.write_text(far.read_text().replace("3e+38", "6e+38"))
            self.refused(REFUSED, r"At fraction 1: .*single precision", self.mesh, "other.ply", far, "--fractions",
                         "0.25,1")


class Reports(CommandTest):
    def test_figures_of_an_edit(self):
        self.done(self.mesh, "out.ply", self.write_edit(self.lift, self.lean), "--report", "report.json")
        report = json.loads((self.place / "report.json").read_text())
        self.assertEqual(report["laplacian_edit_report"], 1)
        self.assertEqual(report["host"], version()[1])
        self.assertEqual(report["scalar"], SCALAR)
        self.assertEqual(report["input"], str(self.mesh))
        self.assertEqual(report["edit"], str(self.edit))
        self.assertEqual(report["mesh"], {"vertices": 441, "faces": 800})
        for name in ("read", "edit", "write"):
            self.assertGreater(report["milliseconds"][name], 0)
        (output,) = report["outputs"]
        self.assertEqual((output["file"], output["fraction"]), (str(self.place / "out.ply"), 1))
        first, second = output["steps"]
        for step, way in ((first, 0.2), (second, (0.05 ** 2 + 0.1 ** 2) ** 0.5)):
            self.assertEqual(sum(step[name] for name in ("handle", "free", "anchors", "fixed")), 441)
            self.assertAlmostEqual(step["handle_displacement"], way, delta=1e-12)
            self.assertLess(step["handle_residual"], 0.005 * way)
            self.assertLess(step["normal_equation_residual"], 1e-12)
            self.assertGreater(step["stretch_max"], step["stretch_rms"])
            self.assertEqual((step["laplacian"], step["order"], step["flipped"]), ("mean value", 1, 0))
            self.assertRegex(step["solver"], "supernodal|Eigen")
            self.assertGreater(step["milliseconds"]["factorisation"], 0)

    def test_steps_of_a_script(self):
        script = self.write_script(replay(self.lift), laplacian_edit(handle_point=self.points[155], radius=0.3))
        self.done(self.mesh, "out.ply", script, "--report", "report.json")
        (output,) = json.loads((self.place / "report.json").read_text())["outputs"]
        self.assertNotIn("fraction", output)
        self.assertEqual([step["handle_displacement"] for step in output["steps"]], [0.2, 0])

    def test_new_self_intersections_are_counted_where_asked_for(self):
        # Far enough to the side for what follows to go through what stays.
        edit = {"region": {"radius": 0.5}, "handles": [{"vertices": "220", "translation": [0.9, 0.1, -0.02]}]}
        script = self.write_script(replay(edit))
        for file in (self.write_edit(edit), script):
            for asked in (False, True):
                text = self.done(self.mesh, "out.ply", file, "--report", "report.json", *["--quality"] * asked)
                (output,) = json.loads((self.place / "report.json").read_text())["outputs"]
                (step,) = output["steps"]
                self.assertEqual("new self-intersections: " in text, asked)
                if asked:
                    self.assertGreater(step["new_intersections"], 0)
                    self.assertTrue(step["advice"])
                else:
                    self.assertIsNone(step["new_intersections"])
        self.done(self.mesh, "out.ply", self.write_edit(self.lift), "--report", "report.json", "--quality")
        (step,) = json.loads((self.place / "report.json").read_text())["outputs"][0]["steps"]
        self.assertEqual((step["new_intersections"], step["folded"], step["advice"]), (0, 0, ""))

    def test_place_that_cannot_be_written(self):
        for report in ("none/report.json", self.place):
            self.refused(UNWRITABLE, r"report .* cannot be written", self.mesh, "out.ply", self.edit, "--report", report)


class Scripts(CommandTest):
    def filter(self, *parameters, name="Laplacian Edit"):
        return f'<filter name="{name}">' + "".join(f"<Param {p}/>" for p in parameters) + "</filter>"

    def short(self, *more, point="RichPoint3f", length="RichAbsPerc"):
        x, y, z = self.points[CENTRE]
        return self.filter(f'type="{point}" name="handle_point" x="{x}" y="{y}" z="{z}"',
                           f'type="{point}" name="translation" x="0" y="0" z="0.2"',
                           f'type="{length}" name="radius" value="0.35"', *more)

    def refused_script(self, sentence, *filters):
        self.refused(REFUSED, sentence, self.mesh, "out.ply", self.write_script(*filters))

    def test_missing_parameters_take_their_defaults(self):
        full = laplacian_edit(handle_point=self.points[CENTRE], radius=0.35, translation=(0, 0, 0.2))
        bits = self.edited_bits(self.write_script(full))
        self.assertEqual(self.edited_bits(self.write_script(self.short())), bits)
        self.assertNotEqual(
            self.edited_bits(self.write_script(self.short('type="RichInt" name="order" value="2"'))), bits)
        # A length's default is a part of the mesh's size.
        x, y, z = self.points[CENTRE]
        part = self.filter(f'type="RichPoint3f" name="handle_point" x="{x}" y="{y}" z="{z}"')
        self.assertRegex(self.done(self.mesh, "out.ply", self.write_script(part)), r"1 handle, [1-9]\d+ free")

    def test_order_of_parameters_does_not_matter(self):
        forward = self.short('type="RichFloat" name="padding" value="0.3"')
        parameters = re.findall("<Param .*?/>", forward)
        backward = '<filter name="Laplacian Edit">' + "".join(reversed(parameters)) + "</filter>"
        self.assertNotEqual(forward, backward)
        self.assertEqual(self.edited_bits(self.write_script(forward)), self.edited_bits(self.write_script(backward)))

    def test_all_hosts_names_of_types_are_understood(self):
        bits = self.edited_bits(self.write_script(self.short()))
        for point in ("RichPosition", "RichDirection"):
            self.assertEqual(self.edited_bits(self.write_script(self.short(point=point, length="RichPercentage"))), bits)

    def test_selections_reach_the_filter(self):
        select = self.filter('type="RichString" name="condSelect" value="(x-0.5)*(x-0.5)+(y-0.5)*(y-0.5)&lt;0.0144"',
                             name="Conditional Vertex Selection")
        picked = [v for v, p in enumerate(self.points) if (p[0] - 0.5) ** 2 + (p[1] - 0.5) ** 2 < 0.0144]
        text = self.done(self.mesh, "out.ply", self.write_script(
            select, self.short('type="RichEnum" name="handle_source" value="1"')))
        self.assertIn(f"{len(picked)} handle", text)
        same = self.edited_bits(self.write_edit(
            {"region": {"radius": 0.35}, "handles": [{"vertices": ",".join(map(str, picked)),
                                                      "translation": [0, 0, 0.2]}]}))
        self.assertEqual(self.bits(self.place / "out.ply"), same)
        inside = select_faces("x0<0.8 && x1<0.8 && x2<0.8")
        text = self.done(self.mesh, "out.ply", self.write_script(
            inside, self.short('type="RichEnum" name="region_source" value="1"')))
        self.assertRegex(text, r"1 handle, \d+ free, \d+ anchor vertices; 105 fixed of 441")

    def test_what_filters_need_is_made_for_them(self):
        """What is connected is seen by the faces' neighbours, which meshes do not have at first."""
        two = together((self.points, self.faces), moved((self.points, self.faces), offset=(2, 0, 0)))
        mesh = write_ply(self.place / "two.ply", *two)
        script = self.write_script(select_faces("x0<0.1"), self.filter(name="Select Connected Faces"))
        self.done(mesh, "out.ply", script, "--also", "selection")
        selected = [f for f, flags in enumerate(Ply(self.place / "out.ply").elements["face"]["flags"]) if flags & 32]
        self.assertEqual(selected, list(range(800)))

    def test_script_without_filters_copies(self):
        self.assertEqual(self.edited_bits(self.write_script()), [tuple(map(bits_of, p)) for p in self.points])

    def test_unknown_names(self):
        self.refused_script(r'filter "Laplacian Edit" has no parameter "strength": it has handle_source, handle_point,',
                            self.short('type="RichFloat" name="strength" value="1"'))
        self.refused_script(r'no filter "Laplacian Edits" .*did you mean "Laplacian Edit"',
                            self.filter(name="Laplacian Edits"))
        self.refused_script(r'no filter "Knit a sock" .*: correct the script', self.filter(name="Knit a sock"))
        self.refused_script(r'Filter 1 of 2 .*"Conditional Vertex Selection" has no parameter "condition": it has .*'
                            r"condSelect", self.filter('type="RichString" name="condition" value="x"',
                                                       name="Conditional Vertex Selection"), self.short())

    def test_values_that_are_none(self):
        for sentence, parameter in (
                (r'padding is "wide", which is no number', 'type="RichFloat" name="padding" value="wide"'),
                (r'padding is "1e99", which is no number', 'type="RichFloat" name="padding" value="1e99"'),
                (r'padding is "", which is no number', 'type="RichFloat" name="padding" value=""'),
                (r'padding has no attribute "value"', 'type="RichFloat" name="padding"'),
                (r'order is "1\.5", which is no whole number', 'type="RichInt" name="order" value="1.5"'),
                (r'order is "99999999999"', 'type="RichInt" name="order" value="99999999999"'),
                (r"laplacian is 7: give 0 \(Umbrella\) or 1 \(Cotangent\)", 'type="RichEnum" name="laplacian" value="7"'),
                (r"laplacian is -1: give 0", 'type="RichEnum" name="laplacian" value="-1"'),
                (r'rotation_axis has no attribute "y"', 'type="RichPoint3f" name="rotation_axis" x="1"'),
                (r'rotation_axis is "up", which is no number',
                 'type="RichPoint3f" name="rotation_axis" x="1" y="up" z="0"'),
                (r"order is a RichFloat in the script, .* it is a RichInt", 'type="RichFloat" name="order" value="1"'),
                (r"order is a RichShotf in the script", 'type="RichShotf" name="order"'),
                (r'"padding" is given twice', 'type="RichFloat" name="padding" value="0"/>'
                                              '<Param type="RichFloat" name="padding" value="1"'),
                (r"line 3: a parameter needs a name and a type", 'name="padding" value="1"'),
                (r"line 3: a parameter needs a name and a type", 'type="RichFloat" value="1"')):
            self.refused_script(sentence, self.short(parameter))

    def test_scripts_that_are_none(self):
        for sentence, text in (
                (r"line 1: the outermost element is \"html\"", "<html></html>"),
                (r"line 2: there is an element \"xmlfilter\"", '<FilterScript>\n<xmlfilter name="x"/></FilterScript>'),
                (r"line 2: there is an element \"param\"",
                 '<FilterScript><filter name="Laplacian Edit">\n<param/></filter></FilterScript>'),
                (r"line 1: a filter needs a name", "<FilterScript><filter/></FilterScript>"),
                (r"The script cannot be read, line 1: ", "<FilterScript>"),
                (r"The script cannot be read, line 1: ", '<FilterScript><filter name="a"'),
                (r"The script cannot be read, line 1: ", ""),
                (r"The script cannot be read, line 1: ", "<FilterScript></FilterScript>x"),
                (r"The script cannot be read, line 1: ", "<FilterScript>&bomb;</FilterScript>")):
            script = self.folder / "none.mlx"
            script.write_text(text)
            self.refused(REFUSED, sentence, self.mesh, "out.ply", script)

    def test_plugin_that_cannot_be_loaded_is_reported_when_a_filter_is_missing(self):
        plugins = self.place / "plugins"
        plugins.mkdir()
        directory = re.search(r" in (/[^\s:]+)", self.run_command(self.mesh, "out.ply", self.write_script(
            self.filter(name="Knit a sock")))[2])[1]
        (plugins / "libio_base.so").symlink_to(directory + "/libio_base.so")
        (plugins / "libfilter_knit.so").write_text("no library")
        self.refused(REFUSED, r"no filter .* in .*/plugins \(not loaded: libfilter_knit\.so: .*\): correct the script",
                     self.mesh, "out.ply", self.write_script(self.filter(name="Knit a sock")), "--plugins", plugins)
        self.done(self.mesh, "out.ply", self.edit, "--plugins", plugins)

    def test_filters_that_draw(self):
        self.refused_script(r'filter "Ambient Occlusion" draws', self.filter(name="Ambient Occlusion"), self.short())

    def test_script_that_leaves_no_layer(self):
        self.refused_script(r"leaves no layer", self.short(), self.filter(name="Delete Current Mesh"))

    def test_refusal_names_the_filter_when_there_are_several(self):
        self.refused_script(r"Filter 2 of 2 \(Laplacian Edit\): .*order .*is 9", self.short(),
                            self.short('type="RichInt" name="order" value="9"'))


class Formats(CommandTest):
    def test_formats_of_the_host(self):
        bits = self.edited_bits(self.edit)
        off = self.place / "dome.off"
        off.write_text(f"OFF\n{len(self.points)} {len(self.faces)} 0\n"
                       + "".join("%r %r %r\n" % p for p in self.points)
                       + "".join("3 %d %d %d\n" % f for f in self.faces))
        self.done(off, "from_off.ply", self.edit)
        self.assertEqual(self.bits(self.place / "from_off.ply"), bits)
        for suffix, looks in (("off", rb"\AN?OFF\s+441 800 0"), ("obj", rb"\nv \S+ \S+ \S+\n"), ("stl", rb"\A.{80}\x20\x03\0\0"),
                              ("PLY", rb"\Aply\nformat binary"), ("wrl", rb"\A#VRML"), ("dxf", rb"SECTION")):
            self.done(self.mesh, "out." + suffix, self.edit)
            self.assertRegex((self.place / ("out." + suffix)).read_bytes(), re.compile(looks, re.DOTALL))
        # Back again. Text has fewer digits than the mesh, STL another order of the vertices.
        nothing = self.write_script(name="nothing.mlx")
        self.done("out.off", "back.ply", nothing)
        back = Ply(self.place / "back.ply")
        self.assertEqual([tuple(f) for f in back.faces()], [tuple(f) for f in self.faces])
        for row, exact in zip(back.points(), Ply(self.place / "bits.ply").points()):
            for number, expected in zip(row, exact):
                self.assertAlmostEqual(number, expected, delta=1e-5)
        self.done("out.stl", "back.ply", nothing)
        back = Ply(self.place / "back.ply")
        self.assertEqual((len(back.points()), len(back.faces())), (441, 800))

    def write_obj(self, corners, begin="", colour=lambda k: ""):
        """corners: of each face, in OBJ's words."""
        obj = self.place / "dome.obj"
        obj.write_text(begin + "".join("v %r %r %r" % p + colour(k) + "\n" for k, p in enumerate(self.points))
                       + "".join("vt %r %r\n" % p[:2] for p in self.points) + "vn 0 0 1\nusemtl red\n"
                       + "".join("f " + " ".join(face) + "\n" for face in corners))
        return obj

    def test_obj_is_read_by_every_version(self):
        """MeshLab 2020.09 itself refuses faces with the first vertex, or aborts."""
        (self.place / "dome.mtl").write_text("newmtl red\nKd 1 0 0\nmap_Kd skin.png\n")
        obj = self.write_obj(([f"{v + 1}/{v + 1}/1" for v in face] for face in self.faces), "mtllib dome.mtl\n# made\n",
                             lambda k: f" {k / 500} 0.5 1")
        self.done(obj, "out.ply", self.edit)
        edited = Ply(self.place / "out.ply")
        self.assertEqual(edited.point_bits(), self.edited_bits(self.edit))
        self.assertEqual([tuple(face) for face in edited.faces()], self.faces)
        self.assertEqual(edited.elements["vertex"]["red"], [int(k / 500 * 255) for k in range(len(self.points))])
        self.assertEqual([struct.pack("<6I", *corners) for corners in edited.elements["face"]["texcoord"]],
                         [struct.pack("<6f", *(c for v in face for c in self.points[v][:2])) for face in self.faces])

    def test_obj_has_polygons_and_counts_from_the_end(self):
        quads = [(a, a + 21, a + 22, a + 1) for row in range(20) for a in range(21 * row, 21 * row + 20)]
        obj = self.write_obj([[f"{v - 441}" for v in quad] for quad in quads])
        self.done(obj, "out.ply", self.edit, "--fraction", "0")
        read = Ply(self.place / "out.ply")
        self.assertEqual(sum(len(face) - 2 for face in read.faces()), 800)
        self.assertEqual({frozenset(face) for face in read.faces() if 0 in face} - {frozenset((0, 21, 22, 1))},
                         set() if len(read.faces()) == 400 else {frozenset((0, 21, 22)), frozenset((0, 22, 1))})

    @unittest.skipUnless(version()[2] == "2020", "MeshLab's reader skips such faces")
    def test_numbers_in_obj_that_are_not_there(self):
        faces = [[str(v + 1) for v in face] for face in self.faces]
        for corner, number in (("442/1", 442), ("0/1", 0), ("-442/1", -442), ("1/442", 442)):
            obj = self.write_obj([*faces[:400], [corner, "2/2/1", "3/3/1"], *faces[400:]])
            self.refused(UNREADABLE, rf"dome\.obj\" cannot be read: a face names vertex, .* normal {number}, where \d+ of them "
                                     "come before it: correct that face", obj, "out.ply", self.edit)
        for text, reason in (("", "the file is empty"), ("f 1 2 3\n", "No vertex found"), ("v 0 0\n", "fewer than 3")):
            obj.write_text(text)
            self.refused(UNREADABLE, reason, obj, "out.ply", self.edit)

    def test_materials_come_along(self):
        mesh = write_ply(self.place / "coloured.ply", self.points, self.faces,
                         face_extra="property uchar red\nproperty uchar green\nproperty uchar blue\n",
                         face_values=["200 10 10"] * len(self.faces))
        self.done(mesh, "out.obj", self.edit)
        text = (self.place / "out.obj").read_text()
        library = re.search(r"^mtllib (.*)$", text, re.MULTILINE)[1]
        self.assertIn("newmtl", (self.place / library).read_text())
        self.assertEqual({path.name for path in self.place.iterdir()},
                         {"coloured.ply", "out.obj", pathlib.Path(library).name})

    def test_unknown_and_broken_files(self):
        self.refused(UNWRITABLE, r'No plugin .* can write .*out\.knit": the suffixes are .*\bply\b', self.mesh,
                     "out.knit", self.edit)
        self.refused(UNWRITABLE, r"can write .*out\"", self.mesh, "out", self.edit)
        unknown = self.place / "in.knit"
        unknown.write_text("x")
        self.refused(UNREADABLE, r"can read .*in\.knit", unknown, "out.ply", self.edit)
        self.refused(UNREADABLE, r"none\.ply.* does not exist", "none.ply", "out.ply", self.edit)
        self.refused(UNREADABLE, r"is not an ordinary file", self.place, "out.ply", self.edit)
        for name, data in (("text.ply", b"knitting"), ("short.ply", self.binary()[:-40]), ("empty.ply", b""),
                           ("empty.off", b""), ("text.off", b"OFF\nx y z\n")):
            broken = self.place / name
            broken.write_bytes(data)
            code, _, errors = self.run_command(broken, "out.ply", self.edit)
            self.assertIn(code, (UNREADABLE, REFUSED), (name, errors))
            self.assertRegex(errors.splitlines()[-1], r"\.$")
            self.assertFalse((self.place / "out.ply").exists())

    def binary(self):
        self.done(self.mesh, "binary.ply", self.edit)
        return (self.place / "binary.ply").read_bytes()

    def test_plugins_of_another_folder(self):
        empty = self.place / "plugins"
        empty.mkdir()
        self.refused(UNWRITABLE, r"no plugins .* in .*/plugins: give their folder with --plugins", self.mesh, "out.ply",
                     self.edit, "--plugins", empty)
        (empty / "libio_base.so").write_text("no library")
        (empty / "libfilter_knit.so").write_text("no library")
        self.refused(UNWRITABLE, r"no plugins .*/plugins \(not loaded: libio_base\.so: .*\): give their folder", self.mesh,
                     "out.ply", self.edit, "--plugins", "plugins")


class Digits(CommandTest):
    """What MeshLab's writers round is written with all digits, or said."""

    def coordinates(self, path):
        lines = path.read_text().splitlines()
        if path.suffix == ".off":
            lines = lines[2:2 + len(self.points)]
        elif path.suffix == ".obj":
            lines = [line[2:] for line in lines if line.startswith("v ")]
        return [tuple(bits_of(float(word)) for word in line.split()[:3]) for line in lines]

    def test_text_formats_keep_every_bit(self):
        for scale, offset in ((1, (0, 0, 0)), (2e-9, (0, 0, 0)), (3e5, (7e6, 0.1, -7e6))):
            points = moved((self.points, self.faces), scale, offset)[0]
            mesh = write_ply(self.place / "mesh.ply", points, self.faces)
            edit = self.write_edit({"region": {"radius": 0.35 * scale},
                                    "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 0.2 * scale]}]})
            self.done(mesh, "out.ply", edit)
            expected = self.bits(self.place / "out.ply")
            self.assertNotEqual(expected[CENTRE], bits_of(points[CENTRE][2]))
            for suffix in ("off", "obj", "xyz"):
                text = self.done(mesh, "out." + suffix, edit, "--report", "report.json", "--strict")
                with self.subTest((suffix, scale)):
                    self.assertEqual(self.coordinates(self.place / ("out." + suffix)), expected)
                    self.assertNotIn("coordinates in", text)
                    (output,) = json.loads((self.place / "report.json").read_text())["outputs"]
                    self.assertEqual(output["coordinate_error"], 0)
            self.done(self.place / "out.off", "again.ply", edit, "--fraction", "0")
            self.assertEqual(self.bits(self.place / "again.ply"), expected)

    def test_all_else_in_the_file_stays(self):
        mesh = write_ply(self.place / "coloured.ply", self.points, self.faces,
                         vertex_extra="property uchar red\nproperty uchar green\nproperty uchar blue\n",
                         vertex_values=[f"{k % 200} 10 20" for k in range(len(self.points))])
        self.done(mesh, "out.off", self.edit)
        lines = (self.place / "out.off").read_text().splitlines()
        self.assertEqual((lines[0], lines[1].split()[:2], len(lines)), ("COFF", ["441", "800"], 2 + 441 + 800))
        self.assertEqual([line.split()[3:] for line in lines[2:443]], [[str(k % 200), "10", "20", "255"] for k in range(441)])
        self.assertEqual([tuple(map(int, line.split()[1:4])) for line in lines[443:]], self.faces)
        self.done(self.place / "out.off", "again.off", self.edit, "--fraction", "0")
        self.assertEqual((self.place / "again.off").read_text(), (self.place / "out.off").read_text())

    def test_what_a_format_loses_is_said(self):
        compared = 0
        for suffix in ("dae", "wrl", "3ds"):
            code, text, errors = self.run_command(self.mesh, "out." + suffix, self.edit, "--report", "report.json")
            if code == UNWRITABLE and "No plugin" in errors:
                continue
            self.assertEqual((code, errors), (0, ""))
            (output,) = json.loads((self.place / "report.json").read_text())["outputs"]
            lost = output["coordinate_error"]
            with self.subTest(suffix):
                if lost is None:  # only where MeshLab was built without a reader
                    self.assertIn("cannot be compared with the result, since MeshLab does not read the format: write", text)
                    self.refused(UNREADABLE, rf"can read .*out\.{suffix}", "out." + suffix, "again.ply", self.edit)
                    continue
                self.assertLess(lost, 1e-4)
                said = re.search(r"(?m)^The coordinates in \".*/out\.\w+\" are up to (\S+) from the result: write PLY, OFF or "
                                 r"OBJ, which keep them\.$", text)
                self.assertEqual(said is not None, lost > 0)
                if lost > 0:
                    compared += 1
                    self.assertAlmostEqual(float(said[1]), lost, delta=0.01 * lost)
                    self.assertEqual(self.done(self.mesh, "out." + suffix, self.edit, "--quiet"), "")
                    self.refused(ADVISED, r"\AWith --strict nothing was written: The coordinates in .* are up to", self.mesh,
                                 "strict." + suffix, self.edit, "--strict", "--quiet")
                    little = self.write_edit(
                        {**self.lift, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 20 * lost]}]})
                    self.refused(UNWRITABLE, r"its coordinates are up to \S+ from the result, of an edit by \S+: write PLY",
                                 self.mesh, "little." + suffix, little)
                    self.edit = self.write_edit(self.lift)
        self.assertGreater(compared, 0)
        text = self.done(self.mesh, "out.dxf", self.edit, "--report", "report.json")
        (output,) = json.loads((self.place / "report.json").read_text())["outputs"]
        self.assertIsNone(output["coordinate_error"])
        self.assertRegex(text, r"out\.dxf\" cannot be compared with the result, since MeshLab does not read the format: write")

    def test_custom_properties_are_kept_or_named(self):
        mesh = write_ply(self.place / "labels.ply", self.points, self.faces, "property int label\nproperty float quality\n",
                         [f"{k} 0.5" for k in range(len(self.points))], "property float area\n", ["2"] * len(self.faces))
        for name, named in (("out.ply", ["vertex label", "face area"]), ("out.off", ["vertex label", "face area"]),
                            ("out.xyz", ["vertex label", "face area", "faces"])):
            text = self.done(mesh, name, self.edit, "--report", "report.json", "--strict")
            if name == "out.ply":  # later versions of MeshLab may keep some
                header = (self.place / name).read_bytes().split(b"end_header")[0].decode().splitlines()
                kept = [line.split()[-1] for line in header]
                named = [one for one in named if one.split()[1] not in kept]
            with self.subTest(name):
                self.assertEqual(json.loads((self.place / "report.json").read_text())["not_kept"], named)
                sentence = f'The output does not keep "{", ".join(named)}" of the mesh'
                self.assertEqual(sentence in text, bool(named))
        text = self.done(self.mesh, "out.ply", self.edit, "--report", "report.json")
        self.assertNotIn("does not keep", text)
        self.assertEqual(json.loads((self.place / "report.json").read_text())["not_kept"], [])

    def test_each_pose_is_compared(self):
        self.done(self.mesh, "all.dxf", self.edit, "--fractions", "0.5,1", "--jobs", "2", "--report", "report.json")
        self.done(self.mesh, "all.off", self.edit, "--fractions", "0.5,1", "--jobs", "2", "--report", "off.json")
        for name, lost in (("report.json", None), ("off.json", 0)):
            outputs = json.loads((self.place / name).read_text())["outputs"]
            self.assertEqual([output["coordinate_error"] for output in outputs], [lost, lost])


class Strict(CommandTest):
    def test_advice_is_an_error(self):
        far = write_ply(self.place / "far.ply", *moved((self.points, self.faces), 100, (1e8, 1e8, 0)))
        side = [{"region": {"component": True}, "order": 3,
                 "handles": [{"vertices": "0-20"}, {"vertices": "220-222", "translation": [0, 0, 4],
                                                    "rotation": {"axis": [0, 1, 0], "degrees": 120}}]}]
        ring = [{"region": {"radius": 0.45}, "detail_rotation": "local_global", "iterations": 2,
                 "handles": [{"vertices": "219-221,240-242,198-200", "translation": [0.3, 0, 0.5]}]}]
        shift = [{"region": {"radius": 35}, "handles": [{"vertices": "220", "translation": [0.4, 0, 0]}]}]
        for sentence, mesh, steps in (
                (r"100 % of its displacement, .*: move the mesh to the origin", far, shift),
                (r"became \S+ times as long: ", self.mesh, side),
                (r"rotations have not converged after \d+ passes, ", self.mesh, ring)):
            if SCALAR == "double" and mesh == far:
                continue
            edit = self.write_edit(*steps)
            self.refused(ADVISED, r"\AWith --strict nothing was written: [^\n]*" + sentence, mesh, "out.ply", edit, "--quiet",
                         "--strict")
            self.assertRegex(self.done(mesh, "lax.ply", edit), sentence)
            (self.place / "lax.ply").unlink()
        self.done(self.mesh, "out.ply", self.write_edit(self.lift), "--quiet", "--strict")

    def test_step_and_fraction_are_named(self):
        high = {**self.lift, "handles": [{"vertices": str(CENTRE), "translation": [0, 0, 3]}]}
        edit = self.write_edit(self.lift, high)
        self.refused(ADVISED, r"at fraction 1, step 2 of 2, ", self.mesh, "all.ply", edit, "--fractions", "0,1", "--strict")
        script = self.write_script(replay(self.lift), replay(high))
        self.refused(ADVISED, r"step 2 of 2, ", self.mesh, "out.ply", script, "--strict")


class Files(CommandTest):
    def limited(self):
        """Writes of more than 8 KB fail as on a full disk."""
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))

    def test_output_may_be_the_input(self):
        bits = self.edited_bits(self.edit)
        mesh = write_ply(self.place / "same.ply", self.points, self.faces)
        self.done(mesh, mesh, self.edit)
        self.assertEqual(self.bits(mesh), bits)
        self.assertEqual({path.name for path in self.place.iterdir()}, {"same.ply", "bits.ply"})

    def test_full_disk_leaves_the_output_alone(self):
        # The last one's writer does not look whether its output arrives.
        for suffix in ("ply", "off", "obj", "stl", "xyz"):
            (self.place / ("out." + suffix)).write_text("old")
            self.refused(UNWRITABLE, r"output .*out\." + suffix + r".* cannot be written: it is larger than a file may be here: "
                         r"raise the limit \(ulimit -f\)", self.mesh, "out." + suffix, self.edit, preexec_fn=self.limited)

    @unittest.skipUnless(os.geteuid() == 0, "needs root's rights to mount")
    def test_disk_that_is_full_says_so(self):
        disk = self.place / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", disk], check=False).returncode != 0:
            self.skipTest("nobody may mount here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        for suffix in ("ply", "off", "obj", "stl", "xyz", "dae", "dxf"):
            self.refused(UNWRITABLE, r"output .*out\.\w+.* cannot be written: the disk is full: free some space, or write to another",
                         self.mesh, "disk/out." + suffix, self.edit)

    def test_places_that_cannot_be_written(self):
        (self.place / "folder.ply").mkdir()
        for sentence, place in ((r"none/out\.ply.* folder does not exist", "none/out.ply"),
                                (r"folder\.ply.* is a folder", "folder.ply"),
                                (r"/dev/full.* not an ordinary file", "/dev/full"),
                                (r"/proc/out\.ply.* cannot be written", "/proc/out.ply")):
            self.refused(UNWRITABLE, sentence, self.mesh, place, self.edit)
        if os.geteuid() != 0:
            closed = self.place / "closed"
            closed.mkdir(0o555)
            self.refused(UNWRITABLE, r"closed/out\.ply.* written to", self.mesh, "closed/out.ply", self.edit)


if __name__ == "__main__":
    unittest.main()
