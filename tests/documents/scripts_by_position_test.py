# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command of the page on scripts by position does what the page says, on the demonstration's head.

Environment as for documents.py, and LAPEDIT_MAKE_MESH, the program that generates the head.
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from documents import commands

PROGRAM = pathlib.Path(os.environ["LAPEDIT_COMMAND"])
PAGE = pathlib.Path("common/docs/scripts-by-position.md")


class ScriptsByPosition(unittest.TestCase):
    def test_every_command(self):
        with tempfile.TemporaryDirectory(prefix="lapedit-") as name:
            folder = pathlib.Path(name)
            subprocess.run([os.environ["LAPEDIT_MAKE_MESH"], "head", folder / "head.ply"], check=True, capture_output=True)
            environment = os.environ | {"PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
            results, said = [], ""
            for line, text in commands(PAGE):
                if text.startswith("build/"):
                    continue  # done above
                with self.subTest(line=line, command=text):
                    done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment,
                                          capture_output=True, timeout=120, encoding="utf-8", errors="replace", check=False)
                    self.assertEqual(done.returncode, 0, f"{text}\n{done.stderr}")
                    said += done.stdout
                    for out in sorted(folder.glob("out*.ply")):
                        results.append((text, out.read_bytes()))
                        out.unlink()
            self.assertIn("vertices: 25414", said)
            self.assertIn("vertex: 13452, position: ", said)
            # The nose by target and through two pipes.
            nose = [mesh for text, mesh in results if text.endswith(("nose.json", "out.ply -", "> out.ply"))]
            self.assertEqual(len(nose), 7)
            self.assertEqual(nose[0], nose[1])
            self.assertEqual(nose[0], nose[2])
            self.assertEqual(nose[0], nose[6], "the last of four poses")
            self.assertEqual(len(results), 12)
            self.assertEqual(len({mesh for _text, mesh in results}), 9, "each edit makes another mesh")
            report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
            landmarks = report["outputs"][0]["steps"][0]["landmarks"]
            self.assertEqual([one["name"] for one in landmarks if one["name"] == "left ear"], ["left ear"])
            self.assertEqual(len(landmarks), 5)
            self.assertLess(max(one["residual"] for one in landmarks), 1e-3)


if __name__ == "__main__":
    unittest.main()
