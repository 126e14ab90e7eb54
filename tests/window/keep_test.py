# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept of an edit: JSON and filter script; the filters in the window."""
import json
import os
import re
import subprocess
import unittest

from gui import LINES_OF_REFUSAL
from tool import ToolTest, numbers_of, part
from host import replay
from ply import Ply, bits_of, write_ply
from shapes import dome, moved


class Keep(ToolTest):
    def two_steps(self, w):
        self.pull(w, self.CENTRE, (40, -30))
        self.pull(w, self.CENTRE + 3, (-10, -20))

    def load(self, w, path):
        w.press_button(part("load"), wait=False)
        w.answer(path=path)

    def test_saved_fit_gives_the_same_bits_as_the_program(self):
        points, faces = dome(2 * self.ROWS - 1, 2 * self.ROWS - 1)
        write_ply(self.folder / "scan.ply", [(x, y, 1.2 * z) for x, y, z in points], faces)
        landmarks = [{"vertices": str(v), "targets": [[x, y, 1.2 * z]]} for v in (0, self.CENTRE) for x, y, z in [self.points[v]]]
        edit, bare, fitted = (self.folder / name for name in ("fit.json", "bare.json", "fitted.ply"))
        step = {"region": {"component": True}, "fit": {"to": "scan.ply", "align": "none"}}
        bare.write_text(json.dumps({"laplacian_edit": 1, "steps": [step]}))
        edit.write_text(json.dumps({"laplacian_edit": 1, "steps": [{**step, "handles": landmarks}]}))
        with self.start(self.mesh, self.folder / "scan.ply") as w:
            w.layer(0, current=True)
            w.layer(1, visible=False)
            self.load(w, bare)
            w.move(*w.pixel(self.CENTRE))
            subprocess.run([os.environ["LAPEDIT_COMMAND"], "-q", self.mesh, fitted, bare], check=True)
            self.assertEqual(Ply(fitted).point_bits(), w.dump(0).point_bits())
            w.press_button(part("reset"))
            self.load(w, edit)
            subprocess.run([os.environ["LAPEDIT_COMMAND"], "-q", self.mesh, fitted, edit], check=True)
            self.assertEqual(Ply(fitted).point_bits(), w.dump(0).point_bits())
            self.pull(w, self.CENTRE, (40, -30))  # the tool corrects a fit
            corrected, path = w.dump(0), self.saved_edit(w)
            self.assertEqual(json.loads(path.read_text())["steps"][0]["fit"]["to"], "scan.ply")
            w.press_button(part("reset"))
            self.load(w, path)
            self.assert_same(corrected, w.dump(0))
            subprocess.run([os.environ["LAPEDIT_COMMAND"], "-q", self.mesh, fitted, path], check=True)
            self.assertEqual(Ply(fitted).point_bits(), corrected.point_bits())

    def test_file_and_script_give_the_same_bits(self):
        with self.start(self.mesh) as w:
            self.two_steps(w)
            edit = json.loads(self.saved_edit(w).read_text())
            self.assertEqual((edit["mesh"]["vertices"], len(edit["steps"])), (len(self.points), 2))
            positions = edit["mesh"]["positions"]
            numbers = numbers_of(positions["vertices"])
            self.assertEqual([[*map(bits_of, point)] for point in positions["points"]],
                             [[*map(bits_of, self.points[number])] for number in numbers])
            for step in edit["steps"]:
                for named in (*step["handles"], step["region"]):
                    self.assertLessEqual(set(numbers_of(named.get("vertices", ""))), set(numbers))
            text = self.saved_edit(w, "edit.mlx").read_text()
            script = re.search(r"<!DOCTYPE FilterScript>.*<FilterScript>(.*)</FilterScript>", text, re.DOTALL)[1]
            self.assertIn('"Laplacian Edit Replay"', script)
            for kept in (script, replay(json.dumps({**edit, "mesh": {"positions": positions}})),
                         replay(json.dumps({**edit, "mesh": {}}))):
                self.assert_gives(kept, self.mesh, w.dump())

    def test_what_cannot_be_loaded_is_reported_in_a_line(self):
        broken = self.folder / "broken.json"
        broken.write_text('{"laplacian_edit": 1, "steps": 3}')
        other = self.folder / "other.json"
        other.write_text(json.dumps({"laplacian_edit": 1, "mesh": {"vertices": 5, "faces": 6}, "steps": [
            {"region": {"radius": 1}, "handles": [{"vertices": "0", "translation": [1, 0, 0]}]}]}))
        with self.start(self.mesh) as w:
            before = w.dump()
            for path in (broken, other):
                self.load(w, path)
                self.assertEqual(w.dialog(), {})
                self.assertRegex(self.message(w), "steps" if path == broken else "vertices")
            self.assert_same(before, w.dump())


class FilterInTheWindow(ToolTest):
    def test_scan_is_chosen_among_the_other_layers(self):
        """The history, and so scripts, have its name."""
        points, faces = dome(self.ROWS, self.ROWS)
        for k, name in enumerate(("low", "high"), 1):
            write_ply(self.folder / f"{name}.ply", [(x, y, (1 + k / 2) * z) for x, y, z in points], faces)
        with self.open(self.mesh, self.folder / "low.ply", self.folder / "high.ply") as w:
            w.layer(0, current=True)
            w.trigger("Laplacian Fit")
            scans, = [v for v in w.ask("widgets", prefix="")["widgets"] if v.get("currentText") == "low.ply"]
            self.assertEqual(scans["count"], 2)
            x, y, width, height = scans["rectangle"]
            w.x_focus()
            w.x("mousemove", x + width // 2, y + height // 2, "click", 1)
            self.settle(w)
            self.x_key(w, "Down", "Return")
            w.wait(lambda: any(v.get("currentText") == "high.ply" for v in w.ask("widgets", prefix="")["widgets"]), "no layer was chosen")
            w.press_button(text="Apply")
            w.wait_output("Laplacian Fit in ")  # so many milliseconds
            w.press_button(text="Close")
            fitted = w.dump(0)
            self.assertGreater(max(z for _, _, z in fitted.triples()), 1.8 * max(z for _, _, z in points))  # low has 1.5
            entry = w.history()[-1]
            self.assertEqual((entry["name"], entry["texts"]), ("Laplacian Fit", {"scan": "high.ply"}))

    def test_refusal_is_in_a_box_and_in_the_log(self):
        # The default handle is at the origin.
        away = write_ply(self.folder / "away.ply", *moved((self.points, self.faces), offset=(30, 0, 0)))
        with self.open(away) as w:
            self.shade_smoothly(w)
            before = w.dump()
            w.trigger("Laplacian Edit")
            w.press_button(text="Apply", wait=False)
            box = w.answer()
            self.assertEqual((box["class"], box["title"]), ("QMessageBox", "Filter Failure"))
            sentence = r"The handle point \(0, 0, 0\) is 30 away from the nearest vertex, .*: give a point on the surface\."
            self.assertRegex(box["text"], "Laplacian Edit.*" + sentence)
            lines = [line for line in w.log() if re.search(sentence, line)]
            self.assertEqual(len(lines), LINES_OF_REFUSAL, w.log())
            self.assert_same(before, w.dump())
            self.assertEqual(w.dialog(), {})


if __name__ == "__main__":
    unittest.main()
