# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command in the documents is run: here, or by another test that the table below names.

A new command in a document needs nothing where it is of a kind that is run here; else it fails until it has a row in the
table. Environment as for documents.py, and:
  LAPEDIT_MAKE_MESH  the program that generates the demonstration's mesh
  LAPEDIT_PLUGIN     the filter plugin
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from documents import ROOT, Document, commands, files

BINARY_DIR = pathlib.Path(os.environ["LAPEDIT_BINARY_DIR"])
PROGRAM = pathlib.Path(os.environ["LAPEDIT_COMMAND"])
LONGEST = 600  # seconds

# Which commands are run by another test: its name in CTest, or None for what runs the tests themselves; the file that
# does it, and what is in it then.
FIRST, RUN = "tests/hosts/first_test.py", "tests/run"
ELSEWHERE = [
    (r"common/demo/run", "hosts.first_trixie", FIRST, '"common/demo/run"'),
    (r"common/scripts/install_dependencies\.sh", "hosts.first_trixie", FIRST, '"common/scripts/install_dependencies.sh"'),
    (r"cmake --build build --parallel .*", "hosts.first_trixie", FIRST, '"cmake --build build --parallel'),
    (r"common/scripts/debian_package\.sh", "hosts.first_trixie", FIRST, "common/scripts/debian_package.sh"),
    (r"sudo apt install \./build/\S*\.deb", "hosts.first_trixie", FIRST, '"sudo apt install'),
    (r"sudo apt purge \S+", "hosts.first_trixie", FIRST, '"sudo apt purge'),
    (r"sudo cmake --install build", "hosts.first_trixie", FIRST, '"sudo cmake --install build"'),
    (r"cmake --build build --target install-user", "hosts.first_trixie", FIRST, "--target install-user"),
    (r"tests/run", None, ".ci/run", "\ntests/run\n"),
    (r"tests/run --(rest|everything)", None, ".ci/run", "exec tests/run --rest\n"),
    (r"cmake --build build", None, RUN, 'cmake --build "$folder"'),
    (r"ctest --test-dir build", None, RUN, 'ctest --test-dir "$1"'),
    (r"tests/fuzz/run .*", None, RUN, "if tests/fuzz/run --quick;"),
    (r"tests/scripts/coverage\.sh build-coverage", None, RUN, "if tests/scripts/coverage.sh build-coverage;"),
    (r"tests/scripts/faults\.sh", None, RUN, "if tests/scripts/faults.sh;"),
    (r"tests/scripts/where_it_runs\.py .*", None, RUN, "tests/scripts/where_it_runs.py build/tests_run*.log"),
    (r"tests/scripts/reproducible\.sh", None, RUN, "if tests/scripts/reproducible.sh;"),
    (r"tests/scripts/upstream_patch\.sh", "documents.release", "tests/documents/release_test.py", "upstream_patch.sh"),
    (r"tests/hosts/check\.sh trixie", "hosts.trixie", "tests/hosts/CMakeLists.txt", "check.sh"),
    (r"tests/hosts/first\.sh trixie", "hosts.first_trixie", "tests/hosts/CMakeLists.txt", "first.sh"),
    (r"tests/hosts/double\.sh", "hosts.double", "tests/hosts/CMakeLists.txt", "double.sh"),
    (r"tests/hosts/package_test\.sh trixie", "hosts.package_trixie", "tests/hosts/CMakeLists.txt", "package_test.sh"),
    (r"tests/scripts/release\.sh", "hosts.release", "tests/hosts/CMakeLists.txt", "release.sh"),
    (r"tests/hosts/compare\.py", "hosts.same_coordinates", "tests/hosts/CMakeLists.txt", "compare.py"),
    (r"tests/hosts/root\.sh", "hosts.root", "tests/hosts/root_test.sh", "root.sh"),
    (r"(laplacian-edit|cat nose\.json|awk) (.|\n)*head(.|\n)*|build/common/demo/make_mesh head head\.ply|"
     r"echo '(.|\n)*' > (?!edit)\w+\.\w+", "documents.scripts_by_position", "tests/documents/scripts_by_position_test.py",
     "for line, text in commands(PAGE)"),
    (r"laplacian-edit --fit .*", "command.fit", "tests/batch/fit_test.py", "--fit"),
    (r"python3 -m venv v|v/bin/pip install .*|pip install( \.)?", "python.newest", "tests/python/run.sh", "-m venv"),
    (r"tests/processors/run\.sh", "processors.plain", "tests/processors/CMakeLists.txt", "run.sh"),
    (r"(parallel|make) (.|\n)*", "command.many", "tests/batch/many_test.py",
     r'PARALLEL, HOSTS, MAKE = re.findall(r"```sh\n(.*?)```", DOCUMENT, re.S)'),
    (r"sbatch .* slurm_array\.sh .*", "command.many", "tests/batch/many_test.py", "slurm_array.sh"),
]

# What no test runs, and why. Of this project's programs among it is checked that they are there, that scripts can be
# read, and that they know the options.
EXCEPTIONS = [
    (r"tests/run --quick", "builds and runs a part of what tests/run does"),
    (r"\./MeshLab\.AppImage .*|common/scripts/build_for\.sh squashfs-root", "official builds come from the network"),
    (r"(\w+=.*\n)?(xvfb-run -a )?tests/(scripts/(speed|quality|fit)\.sh|bench/quality_(pictures|page)\.py)(.|\n)*|"
     r"(cmake --build )?build/speed.*", "measures for minutes up to hours, beside CGAL and Blender"),
    (r"tests/scripts/(gallery|window_pictures)\.sh( paper| cells)?|"
     r"tests/scripts/idea\.py common/docs/pictures", "makes the documents' pictures, to be looked at"),
    (r"tests/scripts/upstream_patch\.sh --(build|extra)", "builds MeshLab's library: minutes, in a root of sid"),
    (r"tests/hosts/compare\.py --store", "replaces what the test compares with"),
    (r"git tag .*", "makes a release"),
    (r"build-fuzz/tests/fuzz/\w+_fuzzer .*", "wants a finding of the fuzzer's"),
]

# Where the options of these scripts are.
OPTIONS = {"quality": "tests/bench/quality_bench.cpp", "speed": "tests/bench/speed_bench.cpp"}


def copy_of_the_project(folder):
    for path in files():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / path, folder / path)


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # (document, line number, text), those of a document in its order
        cls.commands = [(path.as_posix(), *command) for path in files() if path.suffix in (".md", ".1")
                        for command in commands(path)]
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        cls.addClassCleanup(folder.cleanup)
        cls.clone = pathlib.Path(folder.name) / "project"
        copy_of_the_project(cls.clone)
        # So that nothing is fetched.
        (cls.clone / "build").mkdir()
        (cls.clone / "build/meshlab-source").symlink_to(BINARY_DIR / "meshlab-source")
        cls.environment = {name: value for name, value in os.environ.items()
                           if not name.startswith(("LAPEDIT_", "DISPLAY", "PARALLEL"))}
        cls.environment["PATH"] = f"{PROGRAM.parent}:{cls.environment['PATH']}"

    def run_in_clone(self, command, code=0, **environment):
        done = subprocess.run(["bash", "-euc", command], cwd=self.clone, env=self.environment | environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8",
                              errors="replace", timeout=LONGEST, check=False)
        self.assertEqual(done.returncode, code, f"{command}\n{done.stdout}")
        return done.stdout

    def of_kind(self, pattern):
        found = [(document, line, text) for document, line, text in self.commands if re.fullmatch(pattern, text)]
        self.assertTrue(found, f"no command in the documents is as {pattern}")
        return found

    # What is run here: the kinds of commands, and how.

    CONFIGURE = r"cmake -S \. -B build( -D.*)?"
    SELECT = r"ctest --test-dir build -[LR] \S+"
    SOME_TESTS = r"build/tests/\w+ --gtest_filter=\S+"
    MAKE_FAMILY = r"common/demo/make_family\.py .*"
    EDIT_FILE = r"echo '(.|\n)*' > edit\.json"
    EDIT = r"laplacian-edit (?!--fit|(.|\n)*head)(.|\n)*"
    SERVER = r"xvfb-run -a meshlabserver .*"
    HERE = [CONFIGURE, SELECT, SOME_TESTS, MAKE_FAMILY, EDIT_FILE, EDIT, SERVER]

    def test_every_command_is_run_somewhere(self):
        self.assertGreater(len(self.commands), 60)
        known = self.HERE + [row[0] for row in ELSEWHERE + EXCEPTIONS]
        for document, line, text in self.commands:
            with self.subTest(position=f"{document}:{line}", command=text):
                self.assertTrue(any(re.fullmatch(pattern, text) for pattern in known),
                                "nothing runs this command: see ELSEWHERE in commands_test.py")

    def test_blocks_are_of_known_kinds(self):
        """No command hides in a block that is not read for commands."""
        for path in files():
            if path.suffix == ".md":
                languages = {language for language, _ in Document(path).blocks}
                plain = {""} if path.name in ("architecture.md", "method.md") else set()  # drawings, formulas
                # C++ is compiled by documents.example, a makefile run by command.many.
                self.assertLessEqual(languages, {"sh", "json", "python", "cpp", "make"} | plain, path)

    def test_selections_and_tests_that_are_named(self):
        """They configure, select some tests each, and the tests that the table names are there."""
        cache = (BINARY_DIR / "CMakeCache.txt").read_text(encoding="utf-8")
        source = re.search(r"^MESHLAB_SOURCE_DIR:PATH=(.+)$", cache, re.M)
        given = f" -DMESHLAB_SOURCE_DIR={source[1]}" if source else ""
        meshes = os.environ.get("LAPEDIT_MESHES", "")
        settings = f"-DLAPEDIT_MESHES={meshes} -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_TEST_HOSTS=ON"
        for _document, _line, text in self.of_kind(self.CONFIGURE):
            self.assertIn("Build files have been written to", self.run_in_clone(text + given))
        self.run_in_clone(f"cmake -S . -B build {settings}")
        known = self.run_in_clone("ctest --test-dir build --show-only=json-v1")
        names = {test["name"] for test in json.loads(known[known.index("{"):])["tests"]}
        for _document, _line, text in self.of_kind(self.SELECT):
            with self.subTest(command=text):
                self.assertRegex(self.run_in_clone(text + " -N"), r"Total Tests: [1-9]")
        for pattern, test, source, evidence in ELSEWHERE:
            with self.subTest(pattern=pattern):
                self.of_kind(pattern)
                self.assertTrue(evidence in (ROOT / source).read_text(encoding="utf-8"), f"{source} has no {evidence}")
                self.assertTrue(test is None or test in names, test)

    def test_some_tests_of_one_program(self):
        for _document, _line, text in self.of_kind(self.SOME_TESTS):
            program, arguments = text.split(" ", 1)
            program = BINARY_DIR / pathlib.Path(program).relative_to("build")
            with self.subTest(command=text):
                if program.exists():
                    self.assertRegex(self.run_in_clone(f"{program} {arguments} --gtest_list_tests"), r"(?m)^\w+\.\n  \w+")
                else:
                    self.assertTrue("real_tests" in text or not list(BINARY_DIR.glob("tests/*_tests")), "is not built")

    def test_edits(self):
        """The documents' own files, in the order of the documents; a mesh is the demonstration's."""
        build = self.clone / "build/demo"
        build.mkdir()
        subprocess.run([os.environ["LAPEDIT_MAKE_MESH"], "letters", build / "before.ply"], check=True, capture_output=True)
        shutil.copy(build / "before.ply", self.clone / "in.ply")
        shutil.copy(ROOT / "common/demo/laplacian_edit.mlx", self.clone / "edit.mlx")
        server = shutil.which("meshlabserver") and shutil.which("xvfb-run")
        if server:
            self.run_in_clone(f"common/demo/stage.sh stage {os.environ['LAPEDIT_PLUGIN']}")
        # First the README, which makes edit.json.
        order = sorted(self.commands, key=lambda command: (command[0] != "README.md",))
        results = set()
        for document, line, text in order:
            if re.fullmatch("|".join([self.EDIT_FILE, self.MAKE_FAMILY]), text):
                self.run_in_clone(text)
            elif re.fullmatch("|".join([self.EDIT] + [self.SERVER] * bool(server)), text):
                with self.subTest(position=f"{document}:{line}", command=text):
                    for out in [*self.clone.glob("out*.ply"), *self.clone.glob("after.ply")]:
                        out.unlink()
                    path = f"{self.clone}/stage/bin:{self.environment['PATH']}"
                    self.run_in_clone(text, PATH=path, HOME=str(self.clone))
                    made = [*self.clone.glob("out*.ply"), *self.clone.glob("after.ply")]
                    self.assertEqual(len(made), 3 if "--fractions" in text else 1)
                    results |= {path.read_bytes() for path in made if "out-0002" in path.name or "-" not in path.name}
        self.assertNotIn((self.clone / "in.ply").read_bytes(), results)

    def test_exceptions(self):
        print()
        for pattern, reason in EXCEPTIONS:
            texts = sorted({text for _document, _line, text in self.of_kind(pattern)})
            print(f"Not run, {len(texts)} commands: {reason}: {', '.join(' '.join(t.split())[:60] for t in texts)}")
            for text in texts:
                for program in re.findall(r"\w+_(?:bench|fuzzer)\b", text):
                    self.assertTrue(list(ROOT.glob(f"tests/*/{program}.cpp")), program)
                for script in re.findall(r"tests/[\w/]+\.(?:sh|py)", text):
                    with self.subTest(script=script):
                        source = (ROOT / script).read_text(encoding="utf-8")
                        self.assertTrue(os.access(ROOT / script, os.X_OK))
                        if script.endswith(".py"):
                            compile(source, script, "exec")
                        else:
                            self.run_in_clone(f"{source.splitlines()[0].lstrip('#! ').split()[-1]} -n {script}")
                        extra = OPTIONS.get(pathlib.Path(script).stem)
                        source += (ROOT / extra).read_text(encoding="utf-8") if extra else ""
                        for option in re.findall(r" --([a-z-]+)", text):
                            self.assertIn(option, source)


if __name__ == "__main__":
    unittest.main()
