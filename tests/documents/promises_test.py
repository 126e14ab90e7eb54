# SPDX-License-Identifier: GPL-3.0-or-later
"""Each promise names tests that there are."""
import pathlib
import re
import unittest

from documents import ROOT, Document, code


class Promises(unittest.TestCase):
    def test_each_names_tests_that_exist(self):
        sources = {path: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*_test.*")}
        known = set(re.findall(r"\bTEST(?:_[FP])?\(\s*\w+,\s*(\w+)\)|\bdef (test_\w+)\(", "\n".join(sources.values())))
        known = {name for pair in known for name in pair}
        rows = [row.strip("|").split("|") for row in Document(pathlib.Path("common/docs/promises.md")).prose if row.startswith("|")]
        rows = [row for row in rows if row[-1] not in ("Shown by", "---")]
        self.assertGreater(len(rows), 30)
        for row in rows:
            with self.subTest(promise=row[0]):
                self.assertEqual(len(row), 3)
                self.assertTrue(code(row[-1]))
                for name in code(row[-1]):
                    self.assertTrue(name in known or (ROOT / name).is_file(), f"no {name}")


if __name__ == "__main__":
    unittest.main()
