# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON format's document names the keys that laplacian-edit accepts, all of them and no others, and it or the cookbook shows
each in an example."""
import copy
import functools
import json
import os
import pathlib
import re
import unittest

from documents import Document, WithProgram, code, ranges

PROGRAM = os.environ["LAPEDIT_COMMAND"]


def objects_in(value, path="", way=()):
    """The objects in a JSON value: pairs of a path, as in steps[].region, and the way there."""
    if isinstance(value, dict):
        yield path, way
        for key, inner in value.items():
            yield from objects_in(inner, f"{path}.{key}".lstrip("."), way + (key,))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from objects_in(inner, path + "[]", way + (i,))


def value_at(value, way):
    return functools.reduce(lambda inner, step: inner[step], way, value)


def with_value(edit, way, key, value):
    """A copy of the edit in which the object at the end of the way has this key."""
    changed = copy.deepcopy(edit)
    value_at(changed, way)[key] = value
    return changed


# Of settings that the method default lacks, or has with one value.
METHODS = {"order": "linear", "normal_radius": "paper", "rough": "paper"}


class JsonKeys(WithProgram):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # What the example names.
        (cls.folder / "from.pp").write_text('<PickedPoints><point x="0" y="0" z="0" name="a"/></PickedPoints>', encoding="utf-8")
        for name in ("from.csv", "to.csv"):
            (cls.folder / name).write_text("a,0,0,0\n", encoding="utf-8")
        (cls.folder / "to.mrk.json").write_text(
            '{"markups": [{"controlPoints": [{"label": "a", "position": [0, 0, 1]}]}]}', encoding="utf-8")
        cls.document = Document(pathlib.Path("common/docs/json-format.md"))
        documents = cls.document, Document(pathlib.Path("common/docs/cookbook.md"))
        cls.examples = [json.loads(text) for document in documents for language, text in document.blocks if language == "json"]
        cls.rows = {code(row[0])[0]: row for row in cls.document.rows("Keys")}
        cls.objects = {}  # path -> (an example that has such an object, the way there)
        for example in cls.examples:
            for path, way in objects_in(example):
                cls.objects.setdefault(path, (example, way))

    def refusal(self, edit):
        done = self.edit(PROGRAM, edit)
        self.assertEqual(done.returncode, 1, done.stderr)
        return " ".join(done.stderr.split())

    def known_keys(self, refusal):
        found = re.search(r'unknown key "\?"; known keys are ([\w, ]+)\.', refusal)
        return found[1].split(", ") if found else None

    def test_keys_are_those_that_are_accepted(self):
        accepted = set()
        for path, (example, way) in self.objects.items():
            refusal = self.refusal(with_value(example, way, "?", 0))
            keys = self.known_keys(refusal)
            self.assertIsNotNone(keys, f"{path}: {refusal}")
            accepted |= {f"{path}.{key}".lstrip(".") for key in keys}
        self.assertEqual(accepted, set(self.rows))

    def test_every_key_is_in_an_example_and_no_object_is_missing(self):
        shown = set()
        for example in self.examples:
            for path, way in objects_in(example):
                for key, value in value_at(example, way).items():
                    full = f"{path}.{key}".lstrip(".")
                    if full not in shown and full not in self.objects and f"{full}[]" not in self.objects:
                        # The reader says if it wants an object here.
                        self.assertIsNone(self.known_keys(self.refusal(with_value(example, way, key, {"?": 0}))), full)
                    shown.add(full)
        self.assertEqual(shown, set(self.rows))

    def test_examples_are_read(self):
        for example in self.examples:
            done = self.edit(PROGRAM, example)
            # They are for other meshes. What cannot be read is refused with the position in the text.
            self.assertNotRegex(done.stderr, r"unknown key|expected|steps\[[^:]*: (?!vertex \d+ is outside)", example)

    def settings(self):
        return {path.rsplit(".", 1)[1]: row for path, row in self.rows.items() if path.count(".") == 1 and "steps" in path
                and path not in ("steps[].region", "steps[].handles", "steps[].mirror")}

    def choices(self, name):
        """The names that the reader knows for a value, none if it wants something else."""
        example, way = self.objects["steps[]"]
        if name in METHODS:
            example = with_value(example, way, "method", METHODS[name])
        found = re.search(r"expected one of ([^.]*), found", self.refusal(with_value(example, way, name, "?")))
        return re.findall(r'"(\w+)"', found[1]) if found else []

    def test_choices_are_those_that_are_accepted(self):
        known = {name: self.choices(name) for name in self.settings()}
        self.assertTrue(any(known.values()))
        for name, row in self.settings().items():
            with self.subTest(setting=name):
                self.assertEqual(set(code(row[1]) + code(row[2])), set(known[name]))

    def test_numbers_beyond_a_range_are_refused(self):
        """On the middle of the sheet; in most regions anchors as weak as they may be are too ill-conditioned."""
        step = {"region": {"radius": 0.43, "padding": 0.3}, "handles": [{"vertices": "52-54,64-66,76-78", "translation": [0, 0, 0.1]}]}
        edit = {"laplacian_edit": 1, "steps": [step]}
        rows = {("steps", 0, name): row for name, row in self.settings().items()} | {
            ("steps", 0, "region", "padding"): self.rows["steps[].region.padding"],
            ("steps", 0, "handles", 0, "scale"): self.rows["steps[].handles[].scale"]}
        tested = 0
        for (*way, name), row in rows.items():
            spans, above_zero = ranges(row[2])
            values = [(0, 1)] * above_zero
            for low, high in (map(float, span) for span in spans):
                whole = name in ("order", "iterations")
                values += [(low, 0), (high, 0), (low - 1 if whole else 0.9 * low - 1e-9, 1), (high + 1, 1)]
                values = [(int(value), code) for value, code in values] if whole else values
            for value, wanted in values:
                tested += 1
                with self.subTest(key=name, value=value):
                    by_method = with_value(edit, ("steps", 0), "method", METHODS.get(name, "default"))
                    done = self.edit(PROGRAM, with_value(by_method, way, name, value))
                    self.assertEqual(done.returncode, wanted, done.stderr)
        self.assertGreaterEqual(tested, 25)

    def test_defaults_and_ranges_are_the_filters(self):
        filters = {code(row[0])[0]: row for row in
                   Document(pathlib.Path("filter_laplacian_edit/README.md")).rows("Laplacian Edit")}
        both = set(self.settings()) & set(filters)
        self.assertEqual(both, {"method", "laplacian", "order", "membrane"})
        for name in both:
            with self.subTest(setting=name):
                self.assertEqual(ranges(self.settings()[name][2]), ranges(filters[name][3]))
        self.assertEqual(self.rows["steps[].region.padding"][1], filters["padding"][2])


if __name__ == "__main__":
    unittest.main()
