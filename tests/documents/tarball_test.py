# SPDX-License-Identifier: GPL-3.0-or-later
"""The source tarball: the same bytes from a clone and from itself, the files that git tracks and no others, and it builds
where git must not be called.

Environment: as for documents.py, and
  LAPEDIT_MESHLAB  CMake's options for the MeshLab of this build, with semicolons between
"""
import hashlib
import os
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest

from documents import ROOT, files


class Tarball(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.tarball = cls.make(ROOT, cls.folder / "first", 0o022)
        with tarfile.open(cls.tarball) as tar:
            cls.members = tar.getmembers()
            tar.extractall(cls.folder)
        cls.source = cls.folder / cls.members[0].name.split("/")[0]

    @staticmethod
    def make(source, folder, umask, **settings):
        script = source / "common/scripts/source_tarball.sh"
        done = subprocess.run([script, folder], env=dict(os.environ, **settings), umask=umask, stdout=subprocess.PIPE,
                              timeout=300, encoding="utf-8", check=True)
        return pathlib.Path(done.stdout.strip())

    def test_has_all_files_and_no_others(self):
        packed = {member.name[len(self.source.name) + 1:] for member in self.members if not member.isdir()}
        if (ROOT / ".git").exists() and shutil.which("git"):
            listed = subprocess.run(["git", "ls-files"], cwd=ROOT, stdout=subprocess.PIPE, encoding="utf-8", check=True).stdout
            ours = set(listed.splitlines())
        else:
            ours = {path.as_posix() for path in files() if path.suffix not in (".pyc", ".user")}
        self.assertEqual(packed, ours)

    @unittest.skipUnless(shutil.which("git"), "needs git")
    def test_nothing_that_git_does_not_track(self):
        clone = self.folder / "clone"
        shutil.copytree(self.source, clone, symlinks=True)
        for words in (["init", "--quiet"], ["add", "--all"]):
            subprocess.run(["git", *words], cwd=clone, check=True)
        (clone / "v").mkdir()
        (clone / "v" / "pyvenv.cfg").write_text("a virtual environment")
        (clone / "common" / "notes").write_text("not of the project")
        other = self.make(clone, self.folder / "other", 0o022)
        self.assertEqual(*(hashlib.sha256(path.read_bytes()).hexdigest() for path in (other, self.tarball)))

    def test_tells_nothing_of_who_made_it(self):
        self.assertEqual({(member.uid, member.gid, member.uname, member.gname) for member in self.members}, {(0, 0, "", "")})
        self.assertEqual(len({member.mtime for member in self.members}), 1)
        self.assertLessEqual({oct(member.mode) for member in self.members}, {"0o644", "0o755"})

    def test_same_bytes_from_itself(self):
        for path in self.source.rglob("*"):
            if not path.is_symlink():
                path.chmod(0o700 if path.is_dir() or os.access(path, os.X_OK) else 0o600)
        (self.source / "build").mkdir()
        (self.source / "build" / "other").write_text("not of the project")
        second = self.make(self.source, self.source / "build", 0o077, TZ="Asia/Tokyo", XZ_DEFAULTS="-9")
        self.assertEqual(second.name, self.tarball.name)
        self.assertEqual(*(hashlib.sha256(path.read_bytes()).hexdigest() for path in (second, self.tarball)))

    def test_builds_without_git(self):
        (self.folder / "bin").mkdir()
        git = self.folder / "bin" / "git"
        git.write_text(f"#!/bin/sh\ntouch {self.folder}/git-was-called\nexit 1\n")
        git.chmod(0o755)
        build = self.folder / "made"
        environment = dict(os.environ, PATH=f"{git.parent}:{os.environ['PATH']}")
        for words in (["cmake", "-S", self.source, "-B", build, "-DLAPEDIT_BUILD_TESTS=ON", "-DLAPEDIT_MESHES=", "-DCMAKE_UNITY_BUILD=ON",
                       *filter(None, os.environ.get("LAPEDIT_MESHLAB", "").split(";"))],
                      ["cmake", "--build", build, "--target", "lapedit_base"]):
            done = subprocess.run(words, env={name: value for name, value in environment.items() if name != "CI"},
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300, encoding="utf-8", check=False)
            self.assertEqual(done.returncode, 0, done.stdout)
        self.assertFalse((self.folder / "git-was-called").exists())


if __name__ == "__main__":
    unittest.main()
