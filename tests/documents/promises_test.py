# SPDX-License-Identifier: GPL-3.0-or-later
"""Each promise names tests that there are."""
import pathlib
import re
import unittest

from documents import ROOT, Document


class Promises(unittest.TestCase):
    def test_each_names_tests_that_exist(self):
        rows = [row.strip().strip("|").split("|") for row in Document(pathlib.Path("common/docs/promises.md")).prose
                if row.startswith("|")]
        rows = [row for row in rows if not row[-1].strip() in ("Shown by", "---")]
        self.assertGreater(len(rows), 30)
        for row in rows:
            with self.subTest(promise=row[0].strip()):
                self.assertEqual(len(row), 3)
                shown = row[-1].strip()
                self.assertTrue(shown)
                for part in shown.split(";"):
                    path, *names = re.findall(r"`([^`]+)`", part)
                    text = (ROOT / path).read_text(encoding="utf-8")
                    for name in names:
                        self.assertTrue(re.search(rf"\b{name}\b", text), f"no {name} in {path}")
                    self.assertTrue(names or "tests/hosts/" in path or "tests/fuzz/" in path, path)


if __name__ == "__main__":
    unittest.main()
