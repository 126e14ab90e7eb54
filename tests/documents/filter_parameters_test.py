# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of the filters' parameters say what the filters say, and their ranges are those that are refused beyond."""
import json
import os
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree
import xml.sax.saxutils

from documents import ROOT, Document, WithProgram, code, ranges

PROGRAM = os.environ["LAPEDIT_COMMAND"]
TYPES = {"Choice": "RichEnum", "Point": "RichPoint3f", "Length": "RichAbsPerc", "Real": "RichFloat",
         "Integer": "RichInt", "Text": "RichString"}

EDIT = ('{"laplacian_edit": 1, "steps": [{"region": {"radius": 0.4}, '
        '"handles": [{"vertices": "66", "translation": [0, 0, 0.1]}]}]}')


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
        script = xml.etree.ElementTree.parse(ROOT / "common/demo/laplacian_edit.mlx")
        example = script.findall("filter[@name='Laplacian Edit']/Param")
        self.assertEqual([(p.get("name"), p.get("type")) for p in example],
                         [(code(row[0])[0], row[1]) for row in self.tables["Laplacian Edit"]])

    def run_filter(self, filter_name, **values):
        """Runs a filter on the middle of the sheet, with defaults that fit it; in most regions anchors as weak as they
        may be are too ill-conditioned."""
        given = {"handle_source": 1, "radius": 0.43, "padding": 0.3, "edit": EDIT} | values
        lines = []
        for row in self.tables[filter_name]:
            name, kind = code(row[0])[0], row[1]
            if name in given:
                value = xml.sax.saxutils.quoteattr(str(given[name]))
                lines.append(f'<Param type="{kind}" name="{name}" value={value} min="0" max="1" enum_cardinality="3"/>')
        select = ('<filter name="Conditional Vertex Selection"><Param type="RichString" name="condSelect" '
                  'value="(x-0.5)*(x-0.5)+(y-0.5)*(y-0.5) &lt; 0.02"/></filter>')
        script = (f'<!DOCTYPE FilterScript><FilterScript>{select}<filter name="{filter_name}">{"".join(lines)}'
                  "</filter></FilterScript>")
        return self.edit(PROGRAM, script, "mlx", "--quiet")

    def test_ranges(self):
        tested = 0
        for filter_name, table in self.tables.items():
            for row in table:
                name, (spans, above_zero) = code(row[0])[0], ranges(row[3])
                allowed, refused = [], ["0"] if above_zero else []
                for low, high in spans:
                    allowed += [low, high]
                    below = float(low) - 1 if row[1] == "RichInt" else 0.9 * float(low) - 1e-9
                    refused += [f"{below:.12g}", f"{float(high) + 1:.12g}"]
                for value, wanted in [(v, 0) for v in allowed] + [(v, 1) for v in refused]:
                    tested += 1
                    with self.subTest(filter=filter_name, parameter=name, value=value):
                        done = self.run_filter(filter_name, **{name: value})
                        self.assertEqual(done.returncode, wanted, done.stderr)
        self.assertGreaterEqual(tested, 26)


if __name__ == "__main__":
    unittest.main()
