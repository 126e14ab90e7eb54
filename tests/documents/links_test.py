# SPDX-License-Identifier: GPL-3.0-or-later
"""Links lead somewhere, paths and names in code exist, the README is one page, and the documents can be read to the end."""
import fnmatch
import os
import pathlib
import re
import subprocess
import unittest

from documents import ROOT, Document, files

LONGEST_README = 100  # lines
MOST_WORDS = 19300  # of all documents, as wc counts them

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

    def test_settings_named_exist(self):
        sources = "\n".join((ROOT / path).read_text(encoding="utf-8", errors="replace") for path in self.files
                            if not path.endswith((".md", ".png", ".gif", ".svg")))
        for name, document in self.documents.items():
            for setting in set(re.findall(r"\b(?:LAPEDIT|MeshLab|MESHLAB|SPEED)_[A-Z_]*[A-Z]\b", document.text)):
                with self.subTest(document=name, setting=setting):
                    self.assertRegex(sources, rf"\b{setting}\b")

    def test_documents_can_be_read_to_the_end(self):
        words = {name: len(document.text.split()) for name, document in self.documents.items()}
        self.assertLessEqual(sum(words.values()), MOST_WORDS, sorted(words.items(), key=lambda row: -row[1]))

    def test_readme_is_one_page_with_two_pictures_and_a_film(self):
        readme = self.documents["README.md"]
        self.assertLessEqual(len(readme.text.splitlines()), LONGEST_README)
        pictures = [pathlib.Path(name) for name in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", readme.text)]
        self.assertEqual(sorted(picture.suffix for picture in pictures), [".gif", ".png", ".png"])
        self.assertLess(sum((ROOT / picture).stat().st_size for picture in pictures), 3e6)

    def test_the_citation_has_the_paper(self):
        doi = re.search(r"\n    doi: (\S+)\n", (ROOT / "CITATION.cff").read_text(encoding="utf-8"))[1]
        self.assertIn(f"(https://doi.org/{doi})", self.documents["README.md"].text)

    def test_every_picture_is_shown(self):
        shown = {os.path.normpath(os.path.join(os.path.dirname(name), link))
                 for name, document in self.documents.items() for link in document.links()}
        for path in self.files:
            if path.startswith("common/docs/pictures/"):
                self.assertIn(path, shown)

    def test_the_architecture_names_all_layers_and_targets(self):
        architecture = self.documents["common/docs/architecture.md"]
        tree = architecture.blocks[0][1]
        layers = {path.split("/")[2] for path in self.files if re.match(r"common/lapedit/\w+/", path)}
        self.assertLessEqual({f"lapedit_{layer}" for layer in layers}, set(re.findall(r"\w+", tree)))
        build = os.environ["LAPEDIT_BINARY_DIR"]
        known = subprocess.run(["cmake", "--build", build, "--target", "help"], capture_output=True, encoding="utf-8",
                               check=True).stdout
        built = set(re.findall(r"[\w-]+", known))
        if "lapedit_host" not in built:
            return  # without MeshLab there are few
        optional = {"speed_bench", "real_tests"}
        for target in set(re.findall(r"\b(?:lapedit|laplacian|filter|edit|gui|make|speed|bridge|real)_\w+", tree)):
            if target not in optional and not self.exists(target):
                self.assertIn(target, built)


if __name__ == "__main__":
    unittest.main()
