# SPDX-License-Identifier: GPL-3.0-or-later
"""CMakeLists.txt has the version, and all else agrees with it."""
import email.utils
import os
import pathlib
import re
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

from documents import ROOT

PROGRAM = os.environ["LAPEDIT_COMMAND"]
METAINFO = next((pathlib.Path(os.environ["LAPEDIT_BINARY_DIR"]) / "package").glob("*.metainfo.xml"))

def text_of(path):
    return (ROOT / path).read_text(encoding="utf-8")


class Release(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.version = re.search(r"^project\(laplacian_edit VERSION (\S+) ", text_of("CMakeLists.txt"), re.M)[1]
        cls.date = re.search(r"^date-released: (\S+)$", text_of("CITATION.cff"), re.M)[1]

    def test_citation(self):
        self.assertEqual(re.search(r"^version: (\S+)$", text_of("CITATION.cff"), re.M)[1], self.version)

    def test_changes(self):
        newest = re.search(r"^## (.*)$", text_of("CHANGELOG.md"), re.M)[1]
        self.assertIn(newest, ("Unreleased", f"{self.version} ({self.date})"))

    def test_manual(self):
        manual = text_of("common/cli/laplacian-edit.1")
        self.assertIn(f'\n.TH LAPLACIAN-EDIT 1 {self.date} "laplacian-edit {self.version}" ', manual)

    def test_debian(self):
        changes = text_of("common/packaging/debian/changelog")
        self.assertRegex(changes, rf"\Ameshlab-laplacian-edit \({re.escape(self.version)}\+meshlab\d+\.\d+-\d+\)")
        # The second of source_tarball.sh's files, as all files of the package have one time.
        self.assertEqual(email.utils.parsedate_to_datetime(re.search(r"^ -- .*>  (.*)$", changes, re.M)[1]).isoformat(),
                         f"{self.date}T00:00:00+00:00")

    def test_program(self):
        told = subprocess.check_output([PROGRAM, "--version"], encoding="utf-8")
        self.assertEqual(told, f"laplacian-edit {self.version}\n")

    def test_plugins(self):
        """What they say of themselves in MeshLab."""
        told = f"aplacian editing for MeshLab {self.version}".encode()
        for variable in ("LAPEDIT_FILTER_PLUGIN", "LAPEDIT_TOOL_PLUGIN"):
            with self.subTest(plugin=variable):
                self.assertIn(told, pathlib.Path(os.environ[variable]).read_bytes())

    def test_metainfo(self):
        newest = xml.etree.ElementTree.parse(METAINFO).find("releases/release")
        self.assertEqual(newest.attrib, {"version": self.version, "date": self.date})

    @unittest.skipUnless(shutil.which("appstreamcli"), "no appstreamcli here")
    def test_metainfo_is_valid(self):
        done = subprocess.run(["appstreamcli", "validate", "--no-net", "--explain", METAINFO], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=60, encoding="utf-8", check=False)
        self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    unittest.main()
