# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured numbers in the documents: what a quick test prints is printed again and compared; findings agree with their
tables, ratios with the times that they are of; and each section with measurements names what prints them.

Environment as for documents.py.
"""
import os
import pathlib
import re
import subprocess
import unittest

from documents import Document

TESTS = pathlib.Path(os.environ["LAPEDIT_BINARY_DIR"]) / "tests"
METHOD, PERFORMANCE, PEERS = (Document(pathlib.Path(f"common/docs/{name}.md")) for name in ("method", "performance", "peers"))


def numbers(text):
    """All numbers of a text; 1/8 is one."""
    found = re.findall(r"(1/)?(?<![\w.])([-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?)", text)
    return [1 / float(value.replace(",", "")) if inverse else float(value.replace(",", "")) for inverse, value in found]


def tables(document, heading):
    """The tables of a section by their heads' first cells: rows by first cells."""
    found, rows = {}, None
    for line in document.section(heading):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            rows = None
        elif rows is None:
            rows = found.setdefault(line.strip("|").split("|")[0].strip(), {})
            rows[""] = cells[1:]
        elif not re.fullmatch(r"[|: -]+", line):
            rows[cells[0]] = cells[1:]
    return found


@unittest.skipUnless((TESTS / "deform_tests").exists(), "the core's tests are not built")
class OfTests(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        done = subprocess.run([TESTS / "deform_tests", "--gtest_filter=DetailOrientation*"], check=False,
                              stdout=subprocess.PIPE, encoding="utf-8", timeout=250)
        assert done.returncode == 0, done.stdout
        cls.printed = done.stdout

    def test_tilt_of_details(self):
        """The rows that the document has are those that the test prints, without its columns of references."""
        printed = [[cell.strip() for cell in line.strip("|").split("|")] for line in self.printed.splitlines()
                   if line.startswith("| ")]
        printed = {tuple(row[:4]) + (row[5], row[6], row[8]) for row in printed}
        told = [tuple(row) for row in PEERS.rows("The three methods") if row[0] in ("umbrella", "cotangent")]
        self.assertGreater(len(told), 7)
        for row in told:
            self.assertIn(row, printed)


class Agreement(unittest.TestCase):
    def test_findings_on_speed(self):
        times = tables(PERFORMANCE, "Region and frames")["ms"]
        ratios = tables(PERFORMANCE, "Region and frames")["ratio"]
        findings = " ".join(" ".join(PERFORMANCE.text.split("\n## ")[0].split()).split())

        def range_of(row, digits):
            values = [number for cell in row[:len(times[""])] for number in numbers(cell)]
            return [f"{value:.{digits}f}" for value in (min(values), max(values))]
        low, high = range_of(times["first frame"], 0)
        self.assertIn(f"first frame appears {low} to {high} ms", findings)
        low, high = range_of(times["frame"], 0)
        self.assertRegex(findings, rf"A frame takes {low}|{low}\.\d ms at 4,685 vertices and {high} ms")
        low, high = range_of(ratios["region ready / CHOLMOD"], 2)
        self.assertIn(f"takes {low} to {high} times as long as CHOLMOD", findings)

    def test_ratios_are_of_the_times(self):
        found = tables(PERFORMANCE, "Region and frames")
        times, ratios = found["ms"], found["ratio"]
        names = {"region ready / CHOLMOD": ("region ready", "CHOLMOD"), "first frame / CHOLMOD": ("first frame", "CHOLMOD"),
                 "frame / CGAL's iteration": ("frame", "CGAL's iteration"),
                 "next vertex / region ready": ("next handle in the same region: a vertex", "region ready"),
                 "next disc / region ready": ("next handle in the same region: the tool's disc", "region ready")}
        self.assertLessEqual(set(names), set(ratios))
        for ratio, (above, below) in names.items():
            for k, told in enumerate(ratios[ratio][:-1]):
                with self.subTest(ratio=ratio, size=times[""][k]):
                    real = numbers(times[above][k])[0] / numbers(times[below][k])[0]
                    self.assertAlmostEqual(numbers(told.strip("*"))[0] / real, 1, delta=0.06)

    def test_findings_on_shape(self):
        rows = tables(PEERS, "Against as-rigid-as-possible deformation")["edits"]
        edits, rms, rms100, _largest, flipped, pairs = rows["all"]
        findings = " ".join(PEERS.text.split("\n| ")[0].split()).replace(",", "")
        flipped, pairs = flipped.split(", "), pairs.split(", ")
        self.assertIn(f"over {edits} edits {flipped[0]} flipped triangles and {pairs[0]} new intersecting pairs ARAP "
                      f"{flipped[1]} and {pairs[1]}", findings)
        self.assertIn(f"is {rms} times ARAP's after ten iterations {rms100} times after 100", findings)

    def test_figures_of_the_readme_are_of_the_tables(self):
        """Those of what the method is good at and what not."""
        def of(text):
            return {number.replace(",", "") for number in re.findall(r"(?<![\w.])\d[\d,]*(?:\.\d+)?", re.sub(r"\]\([^)]*\)", "", text))}
        told = of("\n".join(Document(pathlib.Path("README.md")).section("What it is good at, and what not")))
        self.assertGreater(len(told), 10)
        self.assertEqual(told - of(PEERS.text) - of(PERFORMANCE.text), set())

    def test_measurements_name_what_prints_them(self):
        """A section with measurements names a command, a test or a benchmark."""
        measured = re.compile(r"\d (%|ms|MB|GB|degrees|times|milliseconds|seconds)\b|\d %|^\|.*\d\.\d", re.M)
        source = re.compile(r"tests/[\w/]+\.(sh|py|cpp|h)|build/tests/\w+|quality_bench|speed_bench|"
                            r"laplacian-edit --report|\]\((performance|peers|decisions|\.\./\.\./tests/\w*/?README)\.md")
        for document in (METHOD, PERFORMANCE, PEERS, Document(pathlib.Path("common/docs/paper.md"))):
            sections = re.split(r"^#+ (.*)$", document.text, flags=re.M)
            seen = 0
            for heading, text in zip(sections[3::2], sections[4::2]):
                if measured.search(text):
                    seen += 1
                    with self.subTest(document=document.path.as_posix(), section=heading):
                        self.assertRegex(text, source)
            self.assertTrue(seen)


if __name__ == "__main__":
    unittest.main()
