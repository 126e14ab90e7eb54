# SPDX-License-Identifier: GPL-3.0-or-later
"""Links lead somewhere, paths and names in code exist, and the documents can be read to the end."""
import fnmatch
import os
import re
import unittest

from documents import ROOT, Document, code, files

MOST_WORDS = 17500  # of all documents, as wc counts them

# Files that are named but are not part of the repository.
OF_THE_READER = {"edit.json", "edit.mlx", "script.mlx"}  # in examples


class Links(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.files = {path.as_posix() for path in files()}
        cls.folders = {folder.as_posix() for path in files() for folder in path.parents} - {"."}
        cls.documents = {path.as_posix(): Document(path) for path in files() if path.suffix == ".md"}

    def exists(self, pattern):
        """@param pattern  may have * in it; a slash at the end says that it is a folder"""
        names = self.folders if pattern.endswith("/") else self.files | self.folders
        return any(fnmatch.fnmatchcase(name, pattern.rstrip("/")) for name in names)

    def test_links_lead_to_files_and_headings(self):
        for name, document in self.documents.items():
            for link in document.links():
                with self.subTest(document=name, link=link):
                    if re.match(r"https?://", link):
                        continue
                    path, _, anchor = link.partition("#")
                    target = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
                    self.assertTrue(self.exists(target), "no such file")
                    if anchor:
                        self.assertIn(anchor, self.documents[target].anchors(), "no such heading")

    def test_every_document_is_found_from_the_readme(self):
        found, todo = set(), ["README.md"]
        while todo:
            name = todo.pop()
            if name in self.documents and name not in found:
                found.add(name)
                todo += [os.path.normpath(os.path.join(os.path.dirname(name), link.partition("#")[0] or "."))
                         for link in self.documents[name].links()]
        self.assertEqual(found, set(self.documents))

    def test_paths_in_code_exist(self):
        tops = {path.split("/")[0] for path in self.files if "/" in path}
        seen = 0
        for name, document in self.documents.items():
            codes = document.inline_code() + document.code
            for token in {token for text in codes for token in re.split(r"[\s\"',;:()=]+", text)}:
                token = re.sub(r"<[^>]*>", "*", token).rstrip(".")
                if token.split("/")[0] in tops and "/" in token:
                    seen += 1
                    with self.subTest(document=name, path=token):
                        self.assertTrue(self.exists(token), "no such path")
        self.assertGreater(seen, 50)

    def test_files_named_alone_exist(self):
        names = {path.rsplit("/", 1)[-1] for path in self.files}
        for name, document in self.documents.items():
            for token in document.inline_code():
                if re.fullmatch(r"[\w-]+\.(h|cpp|py|sh|md|cmake|mlx|json|qrc|1|cff)", token) and token not in OF_THE_READER:
                    with self.subTest(document=name, file=token):
                        self.assertIn(token, names)
                elif re.fullmatch(r"\w+_test", token):
                    with self.subTest(document=name, test=token):
                        self.assertTrue(names & {f"{token}.cpp", f"{token}.py"})

    def test_promises_are_shown_by_tests_that_exist(self):
        tests = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*_test.*") if path.suffix != ".pyc")
        rows = [code(row.strip("|").split("|")[-1]) for row in self.documents["common/docs/promises.md"].prose if row.startswith("|")]
        self.assertGreater(sum(map(bool, rows)), 30)
        for name in {name for row in rows for name in row}:
            self.assertTrue(name in self.files or re.search(rf"(\b|_){re.escape(name)}[()\"]", tests), f"no {name}")

    def test_documents_can_be_read_to_the_end(self):
        words = {name: len(document.text.split()) for name, document in self.documents.items()}
        self.assertLessEqual(sum(words.values()), MOST_WORDS, sorted(words.items(), key=lambda row: -row[1]))

    def test_every_picture_is_shown(self):
        shown = {os.path.normpath(os.path.join(os.path.dirname(name), link))
                 for name, document in self.documents.items() for link in document.links()}
        for path in self.files:
            if path.startswith("common/docs/pictures/"):
                self.assertIn(path, shown)


if __name__ == "__main__":
    unittest.main()
