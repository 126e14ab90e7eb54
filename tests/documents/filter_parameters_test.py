# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of the filters' parameters say what the filters say, and their ranges are those that are refused beyond."""
import json
import os
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree

from documents import ROOT, Document, WithProgram, code, ranges

PROGRAM = os.environ["LAPEDIT_COMMAND"]
TYPES = {"Choice": "RichEnum", "Point": "RichPoint3f", "Length": "RichAbsPerc", "Real": "RichFloat",
         "Integer": "RichInt", "Text": "RichString"}


def default_of(parameter):
    value = parameter["default"]
    if isinstance(value, list):
        return ", ".join(f"{number:g}" for number in value)
    if isinstance(value, str):
        return value or "empty"
    return f"{value:g}" + (" % of the diagonal" if parameter["kind"] == "Length" and value else "")


class FilterParameters(WithProgram):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        document = Document(pathlib.Path("filter_laplacian_edit/README.md"))
        cls.filters = json.loads(subprocess.check_output([os.environ["LAPEDIT_DESCRIBE_FILTERS"]]))
        cls.tables = {name: document.rows(name) for name in cls.filters}

    def test_names_types_and_defaults(self):
        self.assertEqual(len(self.filters), 2)
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
        example = xml.etree.ElementTree.parse(ROOT / "common/demo/laplacian_edit.mlx")
        self.assertEqual([(p.get("name"), p.get("type")) for p in example.iter("Param")],
                         [(code(row[0])[0], row[1]) for row in self.tables["Laplacian Edit"]])

    def run_filter(self, **values):
        given = {"handle_source": 1, "radius": 0.45, "padding": 0.3} | values
        types = {code(row[0])[0]: row[1] for row in self.tables["Laplacian Edit"]}
        lines = [f'<Param type="{types[name]}" name="{name}" value="{value}" min="0" max="1" enum_cardinality="3"/>'
                 for name, value in given.items()]
        select = ('<filter name="Conditional Vertex Selection"><Param type="RichString" name="condSelect" '
                  'value="(x-0.5)*(x-0.5)+(y-0.5)*(y-0.5) &lt; 0.02"/></filter>')
        script = ("<!DOCTYPE FilterScript><FilterScript>" + select + '<filter name="Laplacian Edit">' + "".join(lines)
                  + '<Param type="RichPoint3f" name="translation" x="0" y="0" z="0.1"/></filter></FilterScript>')
        return self.edit(PROGRAM, script, "mlx", "--quiet")

    def test_ranges(self):
        tested = 0
        for row in self.tables["Laplacian Edit"]:
            name, (spans, above_zero) = code(row[0])[0], ranges(row[3])
            allowed, refused = [], ["0"] if above_zero else []
            for low, high in spans:
                allowed += [low, high]
                refused += [f"{float(low) - 1:.12g}" if row[1] == "RichInt" else f"{float(low) * 0.9 - 1e-9:.12g}",
                            f"{float(high) + 1:.12g}"]
            for value, code_wanted in [(v, 0) for v in allowed] + [(v, 1) for v in refused]:
                tested += 1
                with self.subTest(parameter=name, value=value):
                    done = self.run_filter(**{name: value})
                    self.assertEqual(done.returncode, code_wanted, done.stderr)
        self.assertGreaterEqual(tested, 22)


if __name__ == "__main__":
    unittest.main()
