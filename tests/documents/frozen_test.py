# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts and programs rely on is as frozen.txt has it: nothing of it may change or go, and what is new is added to it.

It is read from the documents' tables, which json_keys_test.py, filter_parameters_test.py and program_test.py compare with the
program and the filters, and from the sources of the Python package.

usage: frozen_test.py --list   prints the lines as they are now
"""
import ast
import pathlib
import re
import sys
import unittest

from documents import ROOT, Document, code, ranges

PYTHON = ROOT / "common/python/laplacian_edit"
CHOICES = ("mode", "align", "method", "laplacian", "rough")  # keys of the JSON format whose values have names


def json_keys():
    for row in Document(pathlib.Path("common/docs/json-format.md")).rows("Keys"):
        key, default, meaning = [*row, "", ""][:3]
        spans, above_zero = ranges(meaning)
        choices = dict.fromkeys(code(meaning)) if key.strip("`").rsplit(".")[-1] in CHOICES else []
        facts = [default.replace("`", ""), *(f"{low} to {high}" for low, high in spans), *["greater than 0"] * above_zero, *choices]
        yield ": ".join(filter(None, [f"JSON {code(key)[0]}", "; ".join(filter(None, facts))]))


def filters():
    document = Document(pathlib.Path("filter_laplacian_edit/README.md"))
    for name in ("Laplacian Edit", "Laplacian Edit Replay", "Laplacian Fit"):
        for row in document.rows(name):
            choices = re.findall(r"(?<![\d.])\d(?=: )", row[3]) if row[1] == "RichEnum" else []
            yield f"filter {name}: {code(row[0])[0]}, {row[1]}, {row[2]}" + f"; choices {', '.join(choices)}" * bool(choices)


def program():
    document = Document(pathlib.Path("common/cli/README.md"))
    for row in document.rows("Options"):
        for option in code(row[0]):
            yield f"program: {option}"
    for row in document.rows("Exit codes"):
        yield f"program ends with {row[0]}: {row[1]}"
    for row in document.rows("The report"):
        for key in code(row[0]):
            yield f"report: {key}"


def public(body):
    return [node for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and
            (node.name == "__init__" or not node.name.startswith("_"))]


def signature(function):
    for argument in [*function.args.args, *function.args.kwonlyargs]:
        argument.annotation = None
    return f"{function.name}({ast.unparse(function.args)})"


def python():
    exported = next(ast.literal_eval(node.value) for node in ast.parse((PYTHON / "__init__.py").read_text()).body
                    if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
    for name in ("_edit.py", "_errors.py", "pymeshlab.py"):
        prefix = "laplacian_edit.pymeshlab" if name == "pymeshlab.py" else "laplacian_edit"
        for node in public(ast.parse((PYTHON / name).read_text()).body):
            if name != "pymeshlab.py" and node.name not in exported:
                continue
            if isinstance(node, ast.FunctionDef):
                yield f"Python {prefix}.{signature(node)}"
                continue
            yield f"Python {prefix}.{node.name}"
            for member in node.body:
                if isinstance(member, ast.AnnAssign):
                    yield f"Python {prefix}.{node.name}.{member.target.id}"
            for member in public(node.body):
                yield f"Python {prefix}.{node.name}.{signature(member)}"


def lines():
    return [*json_keys(), *filters(), *program(), *python()]


class Frozen(unittest.TestCase):
    def test_nothing_changes_and_what_is_new_is_listed(self):
        now, listed = lines(), (pathlib.Path(__file__).parent / "frozen.txt").read_text(encoding="utf-8").splitlines()
        self.assertGreater(len(now), 150)
        self.assertEqual(sorted(set(listed) - set(now)), [], "scripts that rely on this would fail: it has to come back")
        self.assertEqual(sorted(set(now) - set(listed)), [], "this is new, and is to be added to tests/documents/frozen.txt")
        self.assertEqual(listed, now, "the order differs")


if __name__ == "__main__":
    if sys.argv[1:] == ["--list"]:
        print("\n".join(lines()))
    else:
        unittest.main()
