# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands of the documents: edits run on the demonstration's mesh, selections of tests select some, and scripts and programs
are there. The cookbook's commands are run by cookbook_test.py, those of the README also by tests/hosts/first_test.py.

Environment as for documents.py, and:
  LAPEDIT_MAKE_MESH  the program that generates the demonstration's mesh
  LAPEDIT_PLUGIN     the filter plugin
"""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from documents import ROOT, commands, files

BINARY_DIR = pathlib.Path(os.environ["LAPEDIT_BINARY_DIR"])
PROGRAM = pathlib.Path(os.environ["LAPEDIT_COMMAND"])
EDIT_FILE = r"echo '(.|\n)*' > edit\.json"
EDIT = r"laplacian-edit (?!--fit)(.|\n)*"
SERVER = r"xvfb-run -a meshlabserver .*"


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # (document, line number, text), those of a document in its order; first the README's, which make edit.json
        cls.commands = [(path.as_posix(), *command) for path in files() if path.suffix in (".md", ".1")
                        for command in commands(path) if path.name != "cookbook.md"]
        cls.commands.sort(key=lambda command: command[0] != "README.md")
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.environment = {name: value for name, value in os.environ.items() if not name.startswith(("LAPEDIT_", "DISPLAY"))}
        cls.environment |= {"PATH": f"{cls.folder}/stage/bin:{PROGRAM.parent}:{os.environ['PATH']}", "HOME": folder.name}

    def run_command(self, command):
        done = subprocess.run(["bash", "-euc", command], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", errors="replace", timeout=300,
                              check=False)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}")
        return done.stdout

    def test_edits(self):
        (self.folder / "build/demo").mkdir(parents=True)
        (self.folder / "common").symlink_to(ROOT / "common")
        subprocess.run([os.environ["LAPEDIT_MAKE_MESH"], "letters", self.folder / "in.ply"], check=True, capture_output=True)
        shutil.copy(self.folder / "in.ply", self.folder / "build/demo/before.ply")
        shutil.copy(ROOT / "common/demo/laplacian_edit.mlx", self.folder / "edit.mlx")
        kinds = [EDIT]
        if shutil.which("meshlabserver") and shutil.which("xvfb-run"):
            self.run_command(f"{ROOT}/common/demo/stage.sh stage {os.environ['LAPEDIT_PLUGIN']}")
            kinds.append(SERVER)
        run = 0
        for document, line, text in self.commands:
            if re.fullmatch(EDIT_FILE, text):
                self.run_command(text)
            elif re.fullmatch("|".join(kinds), text):
                run += 1
                with self.subTest(position=f"{document}:{line}", command=text):
                    for out in [*self.folder.glob("out*.ply"), *self.folder.glob("after.ply")]:
                        out.unlink()
                    self.run_command(text)
                    made = [*self.folder.glob("out*.ply"), *self.folder.glob("after.ply")]
                    self.assertEqual(len(made), 3 if "--fractions" in text else 1)
                    self.assertNotEqual(sorted(made)[-1].read_bytes(), (self.folder / "in.ply").read_bytes())
        self.assertGreater(run, 3)

    def test_selections_select_some_tests(self):
        known = 0
        for _document, _line, text in self.commands:
            found = re.fullmatch(r"ctest --test-dir build (-[LR]) (\S+)", text)
            if found:
                known += 1
                with self.subTest(command=text):
                    self.assertRegex(self.run_command(f"ctest --test-dir {BINARY_DIR} {found[1]} {found[2]} -N"), r"Total Tests: [1-9]")
        self.assertGreater(known, 1)

    def test_scripts_and_programs_are_here(self):
        for _document, _line, text in self.commands:
            for script in re.findall(r"(?:tests|common)/[\w/]+(?:\.(?:sh|py)|/run)\b", text):
                self.assertTrue(os.access(ROOT / script, os.X_OK), script)
            for program in re.findall(r"\w+_(?:bench|fuzzer)\b", text):
                self.assertTrue(list(ROOT.glob(f"tests/*/{program}.cpp")), program)


if __name__ == "__main__":
    unittest.main()
