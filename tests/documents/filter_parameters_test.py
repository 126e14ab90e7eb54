# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of the filters' parameters have the names, types, defaults and choices that the filters have. The ranges are those
of the JSON keys, which json_keys_test.py tries; tests/cli/refusal_test.py shows that a filter refuses other values."""
import json
import os
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree

from documents import ROOT, Document, code

TYPES = {"Choice": "RichEnum", "Point": "RichPoint3f", "Length": "RichAbsPerc", "Real": "RichFloat",
         "Integer": "RichInt", "Text": "RichString"}


def default_of(parameter):
    value = parameter["default"]
    if isinstance(value, list):
        return ", ".join(f"{number:g}" for number in value)
    if isinstance(value, str):
        return value or "empty"
    return f"{value:g}" + (" % of the diagonal" if parameter["kind"] == "Length" and value else "")


class FilterParameters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        document = Document(pathlib.Path("filter_laplacian_edit/README.md"))
        cls.filters = json.loads(subprocess.check_output([os.environ["LAPEDIT_DESCRIBE_FILTERS"]]))
        cls.tables = {name: document.rows(name) for name in cls.filters}

    def test_names_types_and_defaults(self):
        self.assertEqual(len(self.filters), 3)
        for name, parameters in self.filters.items():
            self.assertEqual([(code(row[0])[0], row[1], row[2]) for row in self.tables[name]],
                             [(p["name"], TYPES[p["kind"]], default_of(p)) for p in parameters])

    def test_choices(self):
        for name, parameters in self.filters.items():
            for row, parameter in zip(self.tables[name], parameters):
                if parameter["kind"] == "Choice":
                    told = re.findall(r"(?<![\d.])(\d): ", row[3])
                    self.assertEqual(told, [str(k) for k in range(parameter["choices"])], row[0])

    def test_the_example_is_complete(self):
        script = xml.etree.ElementTree.parse(ROOT / "common/demo/laplacian_edit.mlx")
        example = script.findall("filter[@name='Laplacian Edit']/Param")
        self.assertEqual([(p.get("name"), p.get("type")) for p in example],
                         [(code(row[0])[0], row[1]) for row in self.tables["Laplacian Edit"]])


if __name__ == "__main__":
    unittest.main()
