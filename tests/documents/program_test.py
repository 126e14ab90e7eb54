# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's document and its manual page name the options, exit codes and figures that laplacian-edit has."""
import json
import os
import pathlib
import re
import unittest

from documents import ROOT, Document, WithProgram, code

PROGRAM = os.environ["LAPEDIT_COMMAND"]


def keys(value):
    """All keys in a JSON value."""
    if isinstance(value, dict):
        return set(value).union(*map(keys, value.values()))
    return set().union(*map(keys, value)) if isinstance(value, list) else set()


class Program(WithProgram):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.document = Document(pathlib.Path("common/cli/README.md"))
        cls.manual = (ROOT / "common/cli/laplacian-edit.1").read_text(encoding="utf-8")

    def help(self):
        return self.run_program(PROGRAM, "--help").stdout

    def test_options(self):
        known = set()
        for short, name, argument in re.findall(r"^  (?:(-\w), )?(--[\w-]+)(?: (\S+(?: \S+)*))?  ", self.help(), re.M):
            known |= {f"{name} {argument}".strip()} | ({short} - {""})
        self.assertGreater(len(known), 8)
        self.assertEqual({name for row in self.document.rows("Options") for name in code(row[0])}, known)
        self.assertEqual({name.split()[0] for name in known},
                         set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", self.manual.split(".SH OPTIONS")[1].split(".SH EXIT")[0]
                                        .replace("\\-", "-"))))

    def test_exit_codes(self):
        known = re.findall(r"^  (\d)  ", self.help(), re.M)
        self.assertEqual(known, ["0", "1", "2", "3", "4", "5", "6"])
        self.assertEqual([row[0] for row in self.document.rows("Exit codes")], known)

    def test_keys_of_the_report(self):
        done = self.edit(PROGRAM, {"laplacian_edit": 1, "steps": [
            {"region": {"radius": 0.4}, "handles": [{"vertices": "66", "translation": [0, 0, 0.1]}]}]}, "--report", "report.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        written = keys(json.loads((self.folder / "report.json").read_text(encoding="utf-8")))
        rows = self.document.rows("The report")
        first = {name for row in rows for name in code(row[0])}
        self.assertLessEqual(first, written)
        self.assertLessEqual(written, first | {name for row in rows for name in code(row[1])})


if __name__ == "__main__":
    unittest.main()
