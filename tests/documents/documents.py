# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the documents of this repository, for the tests that compare them with what there is.

Environment:
  LAPEDIT_BINARY_DIR        the build folder
  LAPEDIT_COMMAND           the program laplacian-edit
  LAPEDIT_DESCRIBE_FILTERS  the program that prints the filters' own descriptions
"""
import json
import pathlib
import re
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
