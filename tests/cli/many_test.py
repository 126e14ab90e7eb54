# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of the cookbook's section on many meshes, as they are printed there, run LAPEDIT_COMMAND, the program laplacian-edit."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "common" / "demo"))
import make_family  # noqa: E402

COMMAND = pathlib.Path(os.environ["LAPEDIT_COMMAND"])
DOCUMENT = (ROOT / "common" / "docs" / "cookbook.md").read_text(encoding="utf-8").split("\n## Edit 200 meshes\n")[1]
PARALLEL, MAKE = re.findall(r"```sh\n(.*?)```", DOCUMENT, re.S)
MAKEFILE = re.search(r"```make\n(.*?)```", DOCUMENT, re.S)[1]
SLURM = ROOT / "common" / "cli" / "recipes" / "slurm_array.sh"


class ManyMeshes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="lapedit-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith(("PARALLEL", "SLURM"))}
        self.environment |= {"PATH": f"{COMMAND.parent}:{os.environ['PATH']}", "HOME": folder.name}

    def family(self, count):
        subprocess.run([ROOT / "common/demo/make_family.py", str(count), "family"], cwd=self.folder, check=True)
        return [self.folder / "family" / f"edited-{k:04}.off" for k in range(1, count + 1)]

    def start(self, command, **environment):
        return subprocess.Popen(["bash", "-c", command], cwd=self.folder, env=self.environment | environment, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)

    def finish(self, command, code=0, **environment):
        with self.start(command, **environment) as process:
            printed = process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, code, printed)
        return printed

    def joblog(self):
        return "".join(path.read_text() for path in self.folder.glob("family/parallel.log")).splitlines()[1:]

    def require_edited(self, outputs):
        """All outputs are there, with the handle at its target."""
        middle = 2 + make_family.SIDE ** 2 // 2
        for output in outputs:
            before = output.with_name(output.name.replace("edited", "mesh")).read_text().splitlines()
            after = output.read_text().splitlines()
            self.assertEqual(len(after), len(before))
            self.assertAlmostEqual(float(after[middle].split()[2]), float(before[middle].split()[2]) + 0.2, delta=0.005)

    @unittest.skipUnless(shutil.which("parallel"), "needs GNU parallel (Debian: parallel)")
    def test_parallel_is_killed_and_started_again(self):
        outputs = self.family(200)
        (self.folder / "family/mesh-0002.off").rename(self.folder / "away.off")
        with self.start(PARALLEL) as process:
            while len(self.joblog()) < 40:
                self.assertIsNone(process.poll(), "ended too early")
                time.sleep(0.002)
            os.killpg(process.pid, signal.SIGKILL)
        self.assertLess(len(self.joblog()), 200)
        self.assertIn("mesh-0002.off", self.finish(PARALLEL, code=1))
        (self.folder / "away.off").rename(self.folder / "family/mesh-0002.off")
        self.finish(PARALLEL)
        self.assertEqual({int(line.split("\t")[0]) for line in self.joblog()}, set(range(1, 201)))
        self.require_edited(outputs)

    def test_make_edits_what_has_changed(self):
        outputs = self.family(12)
        (self.folder / "Makefile").write_text(MAKEFILE)
        self.finish(MAKE)
        self.require_edited(outputs)
        os.utime(self.folder / "family/mesh-0003.off")
        self.assertEqual(re.findall(r"\S*edited\S*", self.finish(MAKE)), ["family/edited-0003.off"])

    def test_tasks_of_a_slurm_array(self):
        outputs = self.family(20)
        for task in range(3):
            array = {"SLURM_ARRAY_TASK_COUNT": "3", "SLURM_ARRAY_TASK_ID": str(task)}
            self.finish(f"{SLURM} family/jobs.tsv", **array)
            self.assertEqual(sum(output.exists() for output in outputs), (6, 13, 20)[task])
        self.require_edited(outputs)
        times = [output.stat().st_mtime_ns for output in outputs]
        outputs[4].unlink()
        self.finish(f"{SLURM} family/jobs.tsv", **array)
        self.assertEqual([k for k, output in enumerate(outputs) if output.stat().st_mtime_ns != times[k]], [4])
        self.assertIn("sbatch --array", self.finish(f"{SLURM} family/jobs.tsv", code=1))


if __name__ == "__main__":
    unittest.main()
