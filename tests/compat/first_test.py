# SPDX-License-Identifier: GPL-3.0-or-later
"""A newcomer's first minutes, in a bare root; then the same without any rights. Run by first.sh.

Environment:
  LAPEDIT_FIRST_ROOT  a root with nothing installed, and a copy of this project in /project; is changed
  LAPEDIT_OUTPUT      file for what is printed
"""
import math
import os
import pathlib
import re
import subprocess
import sys
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from ply import Ply  # noqa: E402

ROOT = pathlib.Path(os.environ["LAPEDIT_FIRST_ROOT"])
PROJECT = ROOT / "project"
DEMO = PROJECT / "build" / "demo"
USER = 1000
# No right is left, none can be had, nothing can be mounted, and there is no shared memory.
WITHOUT_RIGHTS = ["sh", "-euc", 'mount -t tmpfs -o ro none /dev/shm; exec "$@"', "sh",
                  "setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups", "--bounding-set=-all",
                  "--inh-caps=-all", "--ambient-caps=-all", "--no-new-privs"]
README = (HERE.parents[1] / "README.md").read_text(encoding="utf-8")


def readme(start):
    """The README's command that begins so."""
    found = set(re.findall(rf"(?:^    |`)({re.escape(start)}(?:'[^']*'|[^\n`'])*)", README, re.M))
    assert len(found) == 1, f"{start}: {found}"
    return found.pop()


def run(command, *options, rights=True, code=0, typed=""):
    """Runs shell commands in the root, in /project. @return what they print"""
    began = time.monotonic()
    if not rights:
        options += "--env", "HOME=/home/newcomer"
    done = subprocess.run(
        ["setpriv", "--pdeathsig", "TERM", str(HERE / "root.sh"), "run", str(ROOT), "--directory", "/project", *options, "--",
         *([] if rights else WITHOUT_RIGHTS), "sh", "-euc", command],
        input=typed.encode(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=1800, check=False)
    text = done.stdout.decode(errors="replace")
    with open(os.environ["LAPEDIT_OUTPUT"], "a", encoding="utf-8") as log:
        log.write(f"$ {command}\n{text}[{done.returncode}, {time.monotonic() - began:.0f} s]\n\n")
    if done.returncode != code:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{text}")
    return text


class First(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        pathlib.Path(os.environ["LAPEDIT_OUTPUT"]).write_text("", encoding="utf-8")

    def test_1_demonstration(self):
        self.assertFalse((ROOT / "usr/bin/cmake").exists(), "the root is not bare")
        self.check_demonstration(run(readme("common/demo/run")))

    def check_demonstration(self, printed):
        server = (ROOT / "usr/bin/meshlabserver").exists()
        self.assertEqual("The .mlx examples are skipped" in printed, not server)
        for before, after, picture in [("dragon", "dragon_after", "dragon"), ("before", "after", "before_after")] + [
                ("before", "after_replay", "before_after_replay"), ("before", "after_filter", "before_after")] * server:
            for path in (f"{before}.ply", f"{after}.ply", f"{picture}.png"):
                self.assertIn(f"/project/build/demo/{path}", printed)
            self.assertGreater((DEMO / f"{picture}.png").stat().st_size, 20000, "it shows little")
            plain, edited = Ply(DEMO / f"{before}.ply"), Ply(DEMO / f"{after}.ply")
            self.assertEqual(edited.faces(), plain.faces())
            self.assertGreater(sum(a != b for a, b in zip(edited.point_bits(), plain.point_bits())), 1000)

    def test_2_install(self):
        """As a package, then with CMake; the first script by the program that is installed. All is taken away again."""
        run("apt-get install -qy --no-install-recommends sudo")  # which a newcomer has
        run(readme("common/scripts/install_dependencies.sh"))
        run(readme("common/scripts/debian_package.sh"))
        run(readme("sudo apt install ./build/"), typed="y\n")
        self.check_first_script()
        run(readme("sudo apt purge meshlab-laplacian-edit"), typed="y\n")
        self.assertEqual(self.installed(), [])
        run(readme("cmake -S . -B build"))
        run(readme("sudo cmake --install build"))
        self.assertIn("/usr/local/bin/laplacian-edit", self.installed())
        self.check_first_script()
        run("xargs rm <build/install_manifest.txt")
        self.assertEqual(self.installed(), [])

    def test_3_without_rights(self):
        """All that is needed is installed by now; nobody is asked for a password or for the right to mount."""
        run(f"rm -r build/demo; mkdir /home/newcomer; chown -R {USER}:{USER} /project /home/newcomer")
        self.assertRegex(run("! mount -t tmpfs none /mnt 2>&1", rights=False), "superuser|denied|not permitted")
        self.check_demonstration(run(readme("common/demo/run"), rights=False))
        command = readme("cmake --build build --target install-user")
        if (ROOT / "usr/bin/meshlabserver").exists():
            refusal = run(f"! {command} 2>&1", rights=False)
            self.assertIn("has no plugin folder for users", " ".join(refusal.split()))
            folder = "/project/build/common/cli"
        else:
            run(command, rights=False)
            folder = "/home/newcomer/.local/bin"
        self.check_first_script("--env", f"PATH={folder}:/usr/bin:/bin", rights=False)
        run("cmake -S . -B build -DLAPEDIT_BUILD_TESTS=ON && ctest --test-dir build --output-on-failure --no-tests=error "
            r"--parallel $(nproc) -R '^(command\.program|host\.(stage|filter|refusal))$'", rights=False)

    def check_first_script(self, *options, **how):
        """A disc at the middle of the plate is lifted by 0.5 as a whole."""
        (PROJECT / "after.ply").unlink(missing_ok=True)
        run(readme("echo ") + "\n" + readme("laplacian-edit build/"), *options, **how)
        before, after = Ply(DEMO / "before.ply"), Ply(PROJECT / "after.ply")
        lifted = [math.dist(q, (p[0], p[1], p[2] + 0.5)) for p, q in zip(before.points(), after.points()) if math.dist(p, (2, 1, 0.12)) < 0.07]
        self.assertGreater(len(lifted), 10)
        self.assertLess(max(lifted), 1e-3)

    def installed(self):
        found = run("find /usr /home /root -name '*laplacian*' -not -type d")
        return found.split()


if __name__ == "__main__":
    unittest.main()
