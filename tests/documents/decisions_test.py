# SPDX-License-Identifier: GPL-3.0-or-later
"""The records of decisions.md are numbered, dated, complete and in the index; superseded ones name their successor."""
import pathlib
import re
import unittest

from documents import Document

DECISIONS = Document(pathlib.Path("common/docs/decisions.md"))


class Decisions(unittest.TestCase):
    def test_records(self):
        records = re.findall(r"^## (\d+)\. ([^\n]+)\n(\d{4}-\d\d-\d\d), ([^.]+)\. (\*\*.+?)(?=\n#|\Z)", DECISIONS.text, re.M | re.S)
        numbers = [int(number) for number, *_ in records]
        self.assertGreater(len(numbers), 25)
        self.assertEqual(numbers, sorted(set(numbers)))  # replaced records leave gaps
        self.assertEqual(len(numbers), len(re.findall(r"^## ", DECISIONS.text, re.M)), "a record has no date or status")
        for number, title, _date, status, text in records:
            with self.subTest(record=number, title=title):
                successor = re.fullmatch(r"accepted|superseded by (\d+)", status)
                self.assertTrue(successor, status)
                if successor[1]:
                    self.assertIn(int(successor[1]), numbers)
                    self.assertNotEqual(successor[1], number)
                self.assertIn("**Decision:**", text)
                self.assertIn("**Consequences:**", text)

    def test_index(self):
        head = DECISIONS.text.split("\n# ")[0]
        rows = [int(number) for number in re.findall(r"(?:\||, )(\d+) [^,|]+", head)]
        self.assertEqual(rows, [int(number) for number in re.findall(r"^## (\d+)\. ", DECISIONS.text, re.M)])


if __name__ == "__main__":
    unittest.main()
