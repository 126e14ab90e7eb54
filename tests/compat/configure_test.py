# SPDX-License-Identifier: GPL-3.0-or-later
"""A missing MeshLab, other coordinates than given, and headers of another version are reported while configuring.

Environment:
  LAPEDIT_BUILD  the build folder
"""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["LAPEDIT_BUILD"])
CACHE = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")


def cached(name):
    return re.search(rf"^{name}:\w+=(.*)$", CACHE, re.M)[1]


class Configure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refused(self, sentence, **settings):
        settings = {"MeshLab_LIBRARY": cached("MeshLab_LIBRARY"), **settings}
        done = subprocess.run(["cmake", "-S", ROOT, "-B", self.folder, *(f"-D{k}={v}" for k, v in settings.items())],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(" ".join(done.stderr.decode().split()), f"CMake Error.*{sentence}")

    def test_library_that_is_not_there(self):
        self.refused("MeshLab_LIBRARY is /nowhere/libmeshlab-common.so, where there is no file",
                     MeshLab_LIBRARY="/nowhere/libmeshlab-common.so")

    def test_coordinates_of_another_precision(self):
        ours = cached("MeshLab_SCALAR")
        other = {"float": "double", "double": "float"}[ours]
        self.refused(f"MeshLab_SCALAR is {other}, but .* has coordinates in {ours}: give", MeshLab_SCALAR=other)

    def test_headers_of_another_version(self):
        given = cached("MESHLAB_SOURCE_DIR")
        ours = pathlib.Path(given) if given else next(BUILD.glob("meshlab-source/*/unpacked/*/ML_VERSION")).parent
        version = (ours / "ML_VERSION").read_text(encoding="utf-8").strip()
        source = self.folder / "source"
        source.mkdir()
        for path in ours.iterdir():
            if path.name != "ML_VERSION":
                (source / path.name).symlink_to(path)
        (source / "ML_VERSION").write_text("2019.03\n", encoding="utf-8")
        self.refused(rf"The headers in .*/source are MeshLab 2019.03's, but .* is of MeshLab {version}: give that version's "
                     "source", MESHLAB_SOURCE_DIR=source)


if __name__ == "__main__":
    unittest.main()
