# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents, comments and messages use the field's terms: some phrases that only this project had must not come back."""
import pathlib
import re
import unittest

from documents import ROOT, files

# What must not be written, and a plain replacement.
PHRASES = {
    "in the hand": "interactive, or first frame",
    "held by springs": "soft constraints",
    "bars that we": "targets, or thresholds",
    "so many-th": "every n-th",
    "so manieth": "every n-th",
    "ends with a sentence": "is reported as an error message",
    "of this system alone": "owned by this system",
    "is told": "is reported",
    "nothing but for": "null unless",
    "whoever": "the program, process or user that",
    "somebody": "the user, or another program",
    "once more": "again",
    "everybody's": "other",
    "made anew": "rebuilt, or recomputed",
    "takes the place of": "replaces",
    "gives way to": "is replaced by",
    "off its target by": "distance to its target",
    "nobody should": "say why",
}
# Phrases that have grown into a message that scripts may read stay as they are: none so far.
TEXT = {".md", ".h", ".cpp", ".py", ".sh", ".txt", ".cmake", ".in", ".1", ".json", ".mlx", ".cff", ".qrc", ""}
HERE = pathlib.Path(__file__).name


def plain(text):
    """The text in one line, without comment marks and line breaks of string literals; names as words."""
    text = re.sub(r'"\s*\n\s*"', "", text)
    text = re.sub(r"\n\s*(///?|#|\*)? ?", " ", text)
    text = re.sub(r"(?<=[a-z])(?=[A-Z])|_", " ", text)
    return " ".join(text.split()).lower()


class Words(unittest.TestCase):
    def test_finds_phrases_across_lines_and_in_names(self):
        for text in ("whoever", "// it is\n/// told why", '"is "\n   "told"', "SeesWhenSomebodyElse", "test_once_more"):
            self.assertTrue(any(phrase in plain(text) for phrase in PHRASES), text)

    def test_no_phrase_is_there(self):
        read = 0
        for path in files():
            if path.suffix not in TEXT or path.name == HERE or "corpus" in path.parts:
                continue
            read += 1
            text = plain((ROOT / path).read_text(encoding="utf-8", errors="replace"))
            for phrase, instead in PHRASES.items():
                for found in re.finditer(rf"\b{re.escape(phrase)}\b", text):
                    with self.subTest(file=path.as_posix(), phrase=phrase):
                        around = text[max(0, found.start() - 60):found.end() + 40]
                        self.fail(f"write instead: {instead}\n... {around} ...")
        self.assertGreater(read, 300)


if __name__ == "__main__":
    unittest.main()
