# SPDX-License-Identifier: GPL-3.0-or-later
"""No binary that is built, installed, or staged for the demonstration takes a library from the current folder.

Environment:
  LAPEDIT_BUILD  the build folder
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "hosts"))

from host import COMMAND, HostTest, without_display  # noqa: E402
from library_folders import binaries, check, complaints  # noqa: E402

BUILD = pathlib.Path(os.environ["LAPEDIT_BUILD"])
NAMES = {"laplacian-edit", "libfilter_laplacian_edit.so", "libedit_laplacian_drag.so"}


class LibraryFolders(HostTest):
    screen = None

    def check(self, folder):
        self.assertEqual(check(folder)[1], [])

    def test_built(self):
        for part in ("filter_laplacian_edit", "edit_laplacian_drag", "libexec", "common", "tests"):
            self.check(BUILD / part)
        self.assertLessEqual(NAMES, {b.name for part in ("libexec", "filter_laplacian_edit", "edit_laplacian_drag")
                                     for b in binaries(BUILD / part)})
        self.assertEqual([b.name for b in binaries(BUILD / "libexec")], ["laplacian-edit"])

    def test_installed(self):
        place = self.folder / "installed"
        subprocess.run(["cmake", "--install", BUILD], env={**os.environ, "DESTDIR": str(place)}, check=True,
                       stdout=subprocess.PIPE)
        self.assertEqual({b.name for b in binaries(place)}, NAMES)
        self.check(place)

    def test_staged_for_the_demonstration(self):
        place = self.folder / "stage"
        servers = [path for path in map(shutil.which, ("meshlabserver", "meshlab")) if path]
        if not servers:
            self.skipTest("there is no MeshLab to be staged")
        subprocess.run([HERE.parents[1] / "common/demo/stage.sh", place,
                        BUILD / "filter_laplacian_edit/libfilter_laplacian_edit.so", *servers], check=True)
        self.assertEqual(len(list(binaries(place))), len(servers))
        self.check(place)

    def test_the_loader_tries_whole_paths_only(self):
        environment = {**without_display(self.environment), "LD_DEBUG": "libs"}
        done = subprocess.run([COMMAND, "--version"], env=environment, cwd=self.folder, check=True, timeout=60,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        tried = re.findall(r"trying file=(.*)", done.stderr.decode())
        self.assertTrue(any("libmeshlab-common" in path for path in tried), tried)
        hosts = [path for path in tried if "libmeshlab-common" in path and os.path.isfile(path)]
        if any(complaint for path in hosts for complaint in complaints(path)):
            self.skipTest("MeshLab's own library was built to look into the current folder")
        self.assertEqual([path for path in tried if not path.startswith("/")], [])

    def test_what_is_looked_for_is_seen(self):
        source = self.folder / "empty.c"
        source.write_text("")
        for folders, wrong in (("/usr/lib:", 1), (":", 2), ("lib", 1), ("$ORIGIN/lib:/opt", 0), ("$ORIGINAL", 1)):
            library = self.folder / "empty.so"
            subprocess.run(["cc", "-shared", f"-Wl,-rpath,{folders}", "-o", library, source], check=True)
            self.assertEqual(len(list(complaints(library))), wrong, folders)


if __name__ == "__main__":
    unittest.main()
