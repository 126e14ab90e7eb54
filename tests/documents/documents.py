# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the documents of this repository, for the tests that compare them with what there is.

Environment:
  LAPEDIT_BINARY_DIR        the build folder
  LAPEDIT_COMMAND           the program laplacian-edit
  LAPEDIT_DESCRIBE_FILTERS  the program that prints the filters' own descriptions
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def files():
    """All files of the repository but builds, as paths from its root."""
    def walk(folder):
        for path in sorted(folder.iterdir()):
            if path.is_dir():
                hidden = path.name.startswith(".") and path.name not in (".ci", ".github")
                if not (hidden or path.name.startswith("build") or (path / "CMakeCache.txt").exists()):
                    yield from walk(path)
            else:
                yield path.relative_to(ROOT)
    return list(walk(ROOT))


class Document:
    """A Markdown file: its lines outside of code, and its code."""

    def __init__(self, path):
        self.path = path  # from the root
        self.text = (ROOT / path).read_text(encoding="utf-8")
        self.prose, self.code, self.blocks = [], [], []  # lines; lines of code; fenced blocks as (language, text)
        fence, in_code, after_blank = None, False, True
        for line in self.text.splitlines():
            mark = re.match(r"\s*```(\w*)", line)
            if mark:
                if fence is None:
                    self.blocks.append((mark[1], ""))
                fence = mark[1] if fence is None else None
            elif fence is not None:
                self.blocks[-1] = (fence, self.blocks[-1][1] + line + "\n")
                self.code.append(line)
            elif line.startswith("    ") and (after_blank or in_code):
                in_code = True
                self.code.append(line)
            elif line:
                in_code = False
                self.prose.append(line)
            after_blank = not line
        assert fence is None, f"{path}: a block of code does not end"

    def inline_code(self):
        return re.findall(r"`([^`]+)`", "\n".join(self.prose))

    def links(self):
        """Targets of links and pictures."""
        prose = re.sub(r"`[^`]*`", "", "\n".join(self.prose))
        return re.findall(r"\]\(([^)\s]+)\)", prose)

    def anchors(self):
        """What a link may name after #, as GitHub makes it of headings."""
        headings = [re.sub(r"[`*]|\]\([^)]*\)|\[", "", line.lstrip("#").strip())
                    for line in self.prose if re.match(r"#+ ", line)]
        return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}

    def section(self, heading):
        """The lines below a heading, up to the next of its level or above."""
        lines = self.text.splitlines()
        begin = next(i for i, line in enumerate(lines) if re.fullmatch(r"#+ " + re.escape(heading), line))
        level = len(lines[begin].split()[0])
        end = next((i for i in range(begin + 1, len(lines)) if re.match(r"#{1,%d} " % level, lines[i])), len(lines))
        return lines[begin + 1:end]

    def rows(self, heading):
        """The cells of the section's tables, without their heads."""
        rows = []
        lines = [line for line in self.section(heading)]
        for i, line in enumerate(lines):
            head = i + 1 < len(lines) and re.fullmatch(r"\|[ :|-]+\|", lines[i + 1])
            if line.startswith("|") and not head and not re.fullmatch(r"\|[ :|-]+\|", line):
                rows.append([cell.strip() for cell in line.strip("|").split("|")])
        return rows


def code(cell):
    """The names in backticks of a cell."""
    return re.findall(r"`([^`]+)`", cell)


def ranges(cell):
    """What a cell says of the numbers that are allowed, as "1 to 3" or "greater than 0"."""
    return re.findall(r"(?<![\d.])(\d[\d.]*) (?:\([^)]*\) )?to (\d[\d.]*\d|\d)", cell), "greater than 0" in cell


def _complete(text):
    """If a shell would not wait for more of a command."""
    try:
        shlex.split(text, comments=True)
    except ValueError:
        return False
    return not text.endswith("\\")


def _in_block(lines):
    """The commands of (number, line), as (number, text): those joined by && apart, but with the variables set before."""
    settings, begin, text = "", None, ""
    for number, line in lines:
        if not text:
            begin = number
            if not line.strip() or line.lstrip().startswith("#"):
                continue
        text += ("\n" if text else "") + re.sub(r"\s{2,}# .*", "", line)
        if not _complete(text):
            continue
        if re.match(r"(export )?\w+=\S*$", text):
            settings += text + "\n"
        else:
            # What is in quotes or parentheses is not cut.
            for part in [text] if re.match(r"\(|.*[\"'].* && ", text) else text.split(" && "):
                yield begin, settings + part
        text = ""
    assert not text, f"line {begin}: a command does not end"


def commands(path):
    """All commands that a document shows: (line number, text) of blocks marked sh, of indented blocks that begin as a command
    does, and of code within lines that names one of the repository's programs, or another program with what it is given."""
    lines = list(enumerate((ROOT / path).read_text(encoding="utf-8").splitlines(), 1))
    if path.suffix == ".1":
        return _of_manual(lines)
    own_files = set(files())  # builds may be there or not
    found, block, language, indent, blank = [], [], None, 0, True  # the block that is being read
    for number, line in lines + [(len(lines) + 1, "")]:
        fence = re.match(r"\s*```(\w*)", line)
        if fence and language is None:
            language = fence[1]
        elif fence:
            found += _in_block(block) if language == "sh" else []
            language, block = None, []
        elif language is not None:
            block.append((number, line))
        elif line.startswith("    ") and (blank or block):
            indent = indent if block else len(line) - len(line.lstrip())
            block.append((number, line[indent:]))
        else:
            if block:
                found += _in_block(block) if re.match(r"[a-z./(]|[A-Z_]+=", block[0][1]) else []
                block = []
            for span in re.findall(r"`([^`]+)`", line):
                program, *arguments = span.split() or [""]
                own = pathlib.Path(program) in own_files and os.access(ROOT / program, os.X_OK)
                if own or arguments and re.fullmatch(r"sudo|c(make|test|pack)|apt(-get)?|pip|git|build[\w-]*/\S+", program):
                    found.append((number, span))
        blank = not line
    return found


def _of_manual(lines):
    """Of a manual page, those between .EX and .EE that begin as a command does."""
    found, block = [], None
    for number, line in lines:
        if line == ".EX":
            block = []
        elif line == ".EE":
            found += _in_block(block) if re.match("[a-z]", block[0][1]) else []
            block = None
        elif block is not None:
            block.append((number, line.replace("\\-", "-")))
    return found


class WithProgram(unittest.TestCase):
    """A test that runs laplacian-edit in a folder of its own, on a small curved sheet."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        side = 12
        points = [f"{i / 10} {j / 10} {(3 * i + 5 * j) % 7 / 100}" for i in range(side) for j in range(side)]
        corners = [side * i + j for i in range(side - 1) for j in range(side - 1)]
        faces = [f"3 {q} {q + side} {q + 1}\n3 {q + 1} {q + side} {q + side + 1}" for q in corners]
        (cls.folder / "sheet.off").write_text(
            f"OFF\n{len(points)} {2 * len(faces)} 0\n" + "\n".join(points + faces) + "\n", encoding="utf-8")

    def run_program(self, program, *arguments):
        return subprocess.run([program, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=120, encoding="utf-8", errors="replace", check=False)

    def edit(self, program, edit, *options):
        """Applies an edit, a dictionary, to the sheet."""
        (self.folder / "edit.json").write_text(json.dumps(edit), encoding="utf-8")
        return self.run_program(program, *options, "sheet.off", "out.off", "edit.json")
