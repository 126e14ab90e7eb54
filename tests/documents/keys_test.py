# SPDX-License-Identifier: GPL-3.0-or-later
"""The window's document has the keys that the session has."""
import os
import pathlib
import subprocess
import unittest

from documents import Document, code


class Keys(unittest.TestCase):
    def test_keys(self):
        printed = subprocess.run([os.environ["LAPEDIT_DESCRIBE_KEYS"]], check=True, capture_output=True, text=True).stdout
        known = {name for line in printed.splitlines() for name in line.split("\t")[0].split(", ")}
        self.assertGreater(len(known), 15)
        document = Document(pathlib.Path("edit_laplacian_drag/README.md"))
        self.assertEqual({name for row in document.rows("Keys") for name in code(row[0])}, known)


if __name__ == "__main__":
    unittest.main()
