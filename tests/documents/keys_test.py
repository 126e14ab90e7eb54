# SPDX-License-Identifier: GPL-3.0-or-later
"""The window's document has the keys that the session has, each with its sentence."""
import os
import pathlib
import subprocess
import unittest

from documents import Document, code


class Keys(unittest.TestCase):
    def test_keys(self):
        printed = subprocess.run([os.environ["LAPEDIT_DESCRIBE_KEYS"]], check=True, capture_output=True, text=True).stdout
        known = [line.split("\t") for line in printed.splitlines()]
        self.assertGreater(len(known), 15)
        document = Document(pathlib.Path("edit_laplacian_drag/README.md"))
        self.assertEqual([[", ".join(code(row[0])), row[1]] for row in document.rows("Keys")], known)


if __name__ == "__main__":
    unittest.main()
