# SPDX-License-Identifier: GPL-3.0-or-later
"""No binary that is built or installed loads a library from the current folder.

Environment:
  LAPEDIT_BUILD  the build folder
"""
import os
import pathlib
import re
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from host import COMMAND, HostTest, without_display  # noqa: E402
from library_folders import binaries, complaints  # noqa: E402

BUILD = pathlib.Path(os.environ["LAPEDIT_BUILD"])
NAMES = {"laplacian-edit", "libfilter_laplacian_edit.so", "libedit_laplacian_drag.so"}


class LibraryFolders(HostTest):
    def check(self, *folders):
        """@return the names of the binaries, in which nothing is wrong"""
        found = [binary for folder in folders for binary in binaries(folder)]
        self.assertEqual([wrong for binary in found for wrong in complaints(binary)], [])
        return {binary.name for binary in found}

    def test_built(self):
        parts = ("filter_laplacian_edit", "edit_laplacian_drag", "common", "tests")
        self.assertLessEqual(NAMES, self.check(*(BUILD / part for part in parts)))

    def test_installed(self):
        installed = self.folder / "installed"
        subprocess.run(["cmake", "--install", BUILD], env={**os.environ, "DESTDIR": str(installed)}, check=True,
                       stdout=subprocess.PIPE)
        self.assertEqual(self.check(installed), NAMES)

    def test_the_program_loads_no_library_of_meshlab_or_qt(self):
        done = subprocess.run([COMMAND, "--version"], env={**without_display(self.environment), "LD_DEBUG": "libs"}, check=True,
                              cwd=self.folder, timeout=60, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        tried = re.findall(r"trying file=(.*)", done.stderr.decode())
        self.assertEqual([path for path in tried if not path.startswith("/") or re.search("meshlab-common|Qt5", path)], [])
        self.assertTrue(any("libc.so" in path for path in tried), tried)


if __name__ == "__main__":
    unittest.main()
