# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the package as a user would, uses it in the stock MeshLab, removes it. Run by package_test.sh.

Environment:
  LAPEDIT_PACKAGE     the .deb
  LAPEDIT_CLEAN_ROOT  a root with nothing but the packaged MeshLab; may be changed
  LAPEDIT_USER_ROOT   a root in which the project can be built; may be changed
  LAPEDIT_DEBIAN      the folder in which it was built, in source/
  LAPEDIT_OUTPUT      where to leave what MeshLab printed
"""
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from ply import Ply, bits_of, write_ply  # noqa: E402
from shapes import dome  # noqa: E402
from x_server import XProgram, start_x_server  # noqa: E402

PACKAGE = pathlib.Path(os.environ["LAPEDIT_PACKAGE"])
CLEAN_ROOT = pathlib.Path(os.environ["LAPEDIT_CLEAN_ROOT"])
USER_ROOT = pathlib.Path(os.environ["LAPEDIT_USER_ROOT"])
DEBIAN = pathlib.Path(os.environ["LAPEDIT_DEBIAN"])
OUTPUT = pathlib.Path(os.environ["LAPEDIT_OUTPUT"])
NAME = "meshlab-laplacian-edit"
PATIENCE = 60  # seconds
SIZE = 1280, 900
USER = 1000
SIDE = 81  # vertices

# Kept by apt and dpkg themselves; what they know of packages is compared by asking them.
NOT_COMPARED = re.compile(
    r"/(data|src|build|var/cache/apt|var/lib/apt|var/log/(apt|dpkg\.log|alternatives\.log)|var/cache/ldconfig/aux-cache"
    r"|var/lib/dpkg/(status|available|lock|lock-frontend|[a-z]+-old)|var/cache/debconf/.*)(/.*)?")


def tree(root):
    """All files, each as a line that begins with its path: mode, owner, group, target; and a second one with the checksum."""
    printed = subprocess.check_output(["sh", "-c", r"find . -printf '%p\t%m %U %G %l\n'; find . -type f -exec sha256sum {} + | sed -E "
                                       r"'s/^(\S+) +(.*)/\2\t\1/'"], cwd=root, encoding="utf-8")
    return {line for line in printed.replace("\n.", "\n").splitlines() if not NOT_COMPARED.fullmatch(line.split("\t")[0])}


def paths(lines):
    return {line.split("\t")[0] for line in lines}


class Root:
    """A Debian root with a folder of this machine at /data, which belongs to an ordinary user."""

    def __init__(self, folder, data, display, binds=()):
        self.folder = folder
        self.data = data
        self.display = display
        self.binds = [word for bind in binds for word in ("--bind", bind)]

    def command(self, *words, user=USER):
        environment = {"HOME": "/data/home", "XDG_RUNTIME_DIR": "/data/home", "LIBGL_ALWAYS_SOFTWARE": "1"}
        drop = ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups"]
        if user == 0:
            environment = {"DEBIAN_FRONTEND": "noninteractive"}
            drop = []
        settings = [word for name, value in environment.items() for word in ("--env", f"{name}={value}")]
        return [str(HERE / "root.sh"), "run", str(self.folder), "--bind", f"{self.data}=/data", *self.binds, *settings,
                "--directory", "/data", "--", *drop, *map(str, words)]

    def environment(self, screen=True):
        environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
        return dict(environment, DISPLAY=self.display) if screen else environment

    def run(self, *words, user=USER, code=0, screen=False):
        """@return what it prints; code: what it must end with, None for anything but 0"""
        done = subprocess.run(self.command(*words, user=user), env=self.environment(screen), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300, check=False)
        text = done.stdout.decode(errors="replace")
        if done.returncode != code and not (code is None and done.returncode != 0):
            raise AssertionError(f"{' '.join(map(str, words))} ended with {done.returncode}:\n{text}")
        return text

    def complete(self):
        """Installs what MeshLab recommends, as apt does for users. Without it some of MeshLab's own plugins cannot be
        loaded; it says so in a box, and leaves out the user's folder."""
        text = self.run("dpkg-query", "-W", "-f", "${Recommends}", "meshlab", user=0)
        names = re.findall(r"(?:^|, )([a-z0-9.+-]+)", text)
        self.run("apt-get", "-q", "update", user=0)
        self.run("apt-get", "install", "-qy", "--no-install-recommends", *names, user=0)

    def packages(self):
        return self.run("dpkg-query", "-W", "-f", "${Package} ${Version} ${Status}\\n", user=0)


class Window(XProgram):
    """The stock MeshLab with a mesh, driven by X events only."""

    def __init__(self, root, mesh):
        super().__init__(root.command("meshlab", mesh), root.environment())

    def __enter__(self):
        try:
            self.wait_output("All files opened")
            self.main = self.find("Project_")
            self.x("windowmove", self.main, 0, 0, "windowsize", self.main, *SIZE, "sleep", 0.5)
            self.focus()
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, *_error):
        self.end()

    def end(self):
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(PATIENCE)
        self.reader.join(5)
        self.process.stdout.close()
        (OUTPUT / "meshlab.log").write_text(self.text() + "\n")

    def fail(self, sentence):
        titles = self.x("search", "--onlyvisible", "--name", ".", "getwindowname", "%@", check=False)
        if shutil.which("import"):
            subprocess.run(["import", "-window", "root", str(OUTPUT / "screen.png")], env=self.environment,
                           timeout=PATIENCE, check=False)
        raise AssertionError(f"{sentence}\nWindows:\n{titles}\nOutput of MeshLab:\n{self.text()}")

    def wait_output(self, pattern):
        """Until a line of MeshLab's output matches."""
        self.wait(lambda: any(re.search(pattern, line) for line in self.output),
                  f"no {pattern!r} in MeshLab's output")

    def windows(self, title):
        """The numbers of those on the screen that have such a title."""
        return re.findall(r"^\d+$", self.x("search", "--onlyvisible", "--name", title, check=False), re.M)

    def find(self, title):
        return self.wait(lambda: self.windows(title), f"no window with the title {title!r}")[-1]

    def focus(self):
        """Gives the keyboard to the main window: there is no window manager that would."""
        self.x("windowfocus", "--sync", self.main, "sleep", 0.2)

    def keys(self, *keys):
        for key in keys:
            self.x("key", key, "sleep", 0.3)

    def save(self):
        self.focus()
        self.keys("ctrl+e")
        self.find("Choose Saving Options")
        # A window that has just come loses keys until it has the keyboard.
        self.wait(lambda: not self.windows("Choose Saving Options") or self.x("key", "Return", "sleep", 2),
                  "the window for saving does not go away")
        self.wait_output("Saved Mesh")
        self.focus()

    def quit(self):
        self.focus()
        self.keys("ctrl+q")
        self.wait(lambda: self.process.poll() is not None, "MeshLab does not end")
        if self.process.returncode != 0:
            self.fail(f"MeshLab ended with {self.process.returncode}")


class Archive(unittest.TestCase):
    """The .deb itself."""

    def test_lintian_is_content(self):
        """This machine's lintian."""
        done = subprocess.run(["lintian", "--fail-on", "error,warning", PACKAGE], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=PATIENCE, encoding="utf-8", check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_survives_a_rebuild_of_meshlab(self):
        """Which adds +b1 to the version; a later version is another one."""
        depends = subprocess.check_output(["dpkg-deb", "-f", PACKAGE, "Depends"], encoding="utf-8")
        bounds = re.findall(r"meshlab \((>=|<<) (\S+)\)", depends)
        self.assertEqual([bound[0] for bound in bounds], [">=", "<<"], depends)
        version = bounds[0][1]
        number = int(re.search(r"\d+$", version)[0])
        for suffix, fits in (("", True), ("+b1", True), ("+deb12u1", True), (".1", False)):
            with self.subTest(suffix=suffix):
                self.assertEqual(fits, all(subprocess.run(
                    ["dpkg", "--compare-versions", version + suffix, *bound], check=False).returncode == 0 for bound in bounds))
        later = re.sub(r"\d+$", str(number + 1), version)
        self.assertNotEqual(subprocess.run(["dpkg", "--compare-versions", later, *bounds[1]], check=False).returncode, 0)

    def test_is_hardened(self):
        """Each binary: symbols bound when it is loaded, no folders of its own for libraries, checked C functions, relocations read-only, a stack protector."""
        folder = pathlib.Path(tempfile.mkdtemp(prefix="lapedit-"))
        self.addCleanup(shutil.rmtree, folder)
        subprocess.run(["dpkg-deb", "-x", PACKAGE, folder], check=True, timeout=PATIENCE)
        found = [path for path in folder.rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]
        self.assertEqual(len(found), 3)
        for binary in found:
            with self.subTest(binary=binary.name):
                told = subprocess.check_output(["readelf", "-dlW", "--dyn-syms", binary], encoding="utf-8")
                missing = [sign for sign in (r"\bBIND_NOW\b", "GNU_RELRO", "__stack_chk_fail", r"__\w+_chk@")
                           if not re.search(sign, told)]
                self.assertEqual(missing, [])
                self.assertNotRegex(told, r"\(R(UN)?PATH\)", "it takes libraries from another folder")


class Package(unittest.TestCase):
    def setUp(self):
        self.display = start_x_server(self.addCleanup, "%dx%d" % SIZE)
        self.data = pathlib.Path(tempfile.mkdtemp(prefix="lapedit-"))
        self.addCleanup(shutil.rmtree, self.data)
        (self.data / "home").mkdir(mode=0o700)
        self.points, self.faces = dome(SIDE, SIDE)
        write_ply(self.data / "flat.ply", self.points, self.faces)
        self.bits = [tuple(map(bits_of, p)) for p in self.points]
        shutil.copy(self.data / "flat.ply", self.data / "mesh.ply")
        self.give(self.data)

    def give(self, folder):
        for path in [folder, *folder.rglob("*")]:
            os.chown(path, USER, USER, follow_symlinks=False)

    def require_moved(self, path):
        """Some vertices moved, and all others kept their bits."""
        saved = Ply(path)
        self.assertEqual(saved.faces(), self.faces)
        bits = saved.point_bits()
        moved = sum(a != b for a, b in zip(bits, self.bits))
        self.assertEqual(len(bits), len(self.bits))
        self.assertGreater(moved, 100)
        self.assertLess(moved, len(bits) - 100)

    def drag_and_save(self, window):
        """With the tool, from about the middle of the sheet."""
        window.keys("ctrl+alt+l")
        window.wait_output("Started Mode Laplacian Drag")
        window.x_drag((450, 480), (510, 400))  # on the sheet, however wide the panel is
        window.wait_output("Laplacian Drag: step 1: ")
        window.save()

    def test_package(self):
        root = Root(CLEAN_ROOT, self.data, self.display)
        shutil.copy(PACKAGE, self.data)
        root.complete()
        files, packages = tree(CLEAN_ROOT), root.packages()
        self.assertNotIn(NAME, packages)

        # As a user would, without a word about dependencies.
        root.run("apt-get", "install", "-qy", "--no-install-recommends", f"./{PACKAGE.name}", user=0)
        self.assertRegex(root.packages(), rf"(?m)^{NAME} \S+ install ok installed$")
        added = paths(tree(CLEAN_ROOT) - files)
        self.assertLessEqual({"/usr/bin/laplacian-edit", "/usr/share/man/man1/laplacian-edit.1.gz"}, added)
        names = {pathlib.Path(path).name for path in added}
        self.assertLessEqual({"libedit_laplacian_drag.so", "libfilter_laplacian_edit.so"}, names)
        self.check_documents(added)

        # The package's own test, with meshlabserver where there is one.
        shutil.copy(HERE.parent.parent / "common/packaging/debian/tests/edit", self.data)
        told = root.run("env", "AUTOPKGTEST_TMP=/data", "./edit", screen=True)
        self.assertEqual("meshlabserver: the same coordinates" in told, (CLEAN_ROOT / "usr/bin/meshlabserver").exists(), told)
        self.check_window(root)

        root.run("apt-get", "purge", "-qy", "--autoremove", NAME, user=0)
        self.assertEqual(root.packages(), packages)
        self.assertEqual(files ^ tree(CLEAN_ROOT), set())

    def test_install_user(self):
        """Without root's rights."""
        root = Root(USER_ROOT, self.data, self.display, [f"{DEBIAN}=/debian"])
        root.complete()
        self.give(DEBIAN / "source")
        folder = next((DEBIAN / "source").glob("obj-*")).name
        build = ["cmake", "--build", f"/debian/source/{folder}", "--target"]
        install, uninstall = [*build, "install-user"], [*build, "uninstall-user"]
        home = self.data / "home"
        (home / ".local").mkdir()
        self.give(home)
        empty = tree(home)
        if (USER_ROOT / "usr/bin/meshlabserver").exists():
            self.assertIn("has no plugin folder for users", " ".join(root.run(*install, code=None).split()))
            self.assertEqual(tree(home), empty)
            return

        root.run(*install)
        installed = {path.name for path in home.rglob("*") if path.is_file()}
        self.assertEqual(installed, {"libedit_laplacian_drag.so", "libfilter_laplacian_edit.so", "laplacian-edit"})
        root.run(*uninstall)
        self.assertEqual(empty ^ tree(home), set())
        root.run(*uninstall, code=None)

        root.run(*install)
        step = {"region": {"radius": 0.4}, "handles": [{"vertices": str(SIDE * SIDE // 2), "translation": [0, 0, 0.3]}]}
        (self.data / "edit.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [step]}))
        root.run("home/.local/bin/laplacian-edit", "flat.ply", "edited.ply", "edit.json")
        self.require_moved(self.data / "edited.ply")
        self.check_window(root)
        # MeshLab has made folders and settings of its own meanwhile, and the tool keeps the user's.
        root.run(*uninstall)
        self.assertEqual([path for path in (home / ".local").rglob("*") if "laplacian" in path.name], [])

        # Both at once would be loaded twice.
        root.run("cmake", "--install", build[2], user=0)
        refusal = " ".join(root.run(*install, code=None).split())
        self.assertIn("is installed for all users, and MeshLab would load both: remove it first", refusal)
        self.assertEqual([path for path in (home / ".local").rglob("*") if "laplacian" in path.name], [])

    def check_window(self, root):
        with Window(root, "/data/mesh.ply") as window:
            self.drag_and_save(window)
            window.quit()
        self.require_moved(self.data / "mesh.ply")

    def check_documents(self, added):
        """What the manual page sends a reader to is there."""
        folder = f"/usr/share/doc/{NAME}"
        manual = gzip.decompress((CLEAN_ROOT / "usr/share/man/man1/laplacian-edit.1.gz").read_bytes()).decode()
        named = re.findall(r"/usr/share/doc/[a-z/.-]*[a-z]", manual.replace("\\-", "-"))
        self.assertGreater(len(named), 1)
        for path in named:
            self.assertTrue((CLEAN_ROOT / path[1:]).exists(), path)
        self.assertLessEqual({"/usr/share/bash-completion/completions/laplacian-edit", f"{folder}/examples/dragon.json",
                              f"{folder}/changelog.gz"}, added)


if __name__ == "__main__":
    unittest.main()
