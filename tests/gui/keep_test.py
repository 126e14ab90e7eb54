# SPDX-License-Identifier: GPL-3.0-or-later
"""Undo, settings, and what is kept of an edit: JSON, filter script, filter history."""
import json
import re
import unittest

from gui import LINES_OF_REFUSAL
from tool import ToolTest, numbers_of, part
from host import replay
from ply import Ply, bits_of, write_ply
from shapes import moved


class Regret(ToolTest):
    def test_undo_and_redo_are_exact_to_the_bit(self):
        with self.start(self.mesh) as w:
            states = [w.dump()]
            for vertex, by in ((self.CENTRE, (40, -30)), (self.CENTRE + 2, (-10, 25)), (self.CENTRE - 82, (0, -20))):
                self.pull(w, vertex, by)
                states.append(w.dump())
            for earlier in reversed(states[:-1]):
                w.key("Z", modifiers=["ctrl"])
                self.assert_same(earlier, w.dump())
            for later in states[1:]:
                w.key("Z", modifiers=["ctrl", "shift"])
                self.assert_same(later, w.dump())
            w.press_button(part("undo"))
            self.assert_same(states[2], w.dump())
            w.press_button(part("redo"))
            self.assert_same(states[3], w.dump())
            self.assert_replay_is_the_same(w, self.mesh)
            w.press_button(part("reset"))
            self.assert_same(states[0], w.dump())

    def test_buttons_are_enabled_when_they_can_do_something(self):
        with self.start(self.mesh) as w:
            def enabled():
                return [w.widget(part(n))["enabled"] for n in ("undo", "redo", "reset")]
            self.assertEqual(enabled(), [False, False, False])
            self.pull(w, self.CENTRE, (10, 10))
            self.assertEqual(enabled(), [True, False, True])
            w.press_button(part("undo"))
            self.assertEqual(enabled(), [False, True, False])


class Settings(ToolTest):
    CHANGES = [("iterations", 2, "iterations", 2), ("method", 1, "method", "paper"),
               ("laplacian", 1, "laplacian", "cotangent"), ("order", 2, "order", 2),
               ("normal_radius", 0.1, "normal_radius", 0.1), ("handle_weight", 1, "handle_weight", 1),
               ("anchor_weight", 0.5, "anchor_weight", 0.5), ("rough", 1, "rough", "falloff"),
               ("membrane", 20, "membrane", 20), ("method", 2, "method", "linear")]

    def test_each_setting_solves_the_last_step_again(self):
        with self.start(self.mesh) as w:
            self.pull(w, self.CENTRE, (40, -60))
            seen = [w.dump()]
            for widget, value, key, expected in self.CHANGES:
                with self.subTest(widget):
                    w.set(part(widget), value)
                    self.assertNotEqual(w.dump().point_bits(), seen[-1].point_bits())
                    seen.append(w.dump())
                    steps = self.steps_of(w)
                    self.assertEqual(len(steps), 1)
                    self.assertEqual(steps[0][key], expected)
                    self.assert_replay_is_the_same(w, self.mesh)
            names = ("order", "iterations", "normal_radius", "rough")
            w.set(part("group_advanced"), True)
            for method, shown in enumerate((["iterations"], ["order", "normal_radius", "rough"], ["order"])):
                w.set(part("method"), method)
                self.assertEqual([n for n in names if w.widget(part(n))["visible"]], shown)
            w.set(part("padding"), 40)
            self.assertEqual(self.steps_of(w)[0]["region"]["padding"], 0.4)
            self.assert_replay_is_the_same(w, self.mesh)


class Keep(ToolTest):
    def two_steps(self, w):
        self.pull(w, self.CENTRE, (40, -30))
        self.pull(w, self.CENTRE + 3, (-10, -20))

    def test_saved_edit_applied_again_gives_the_same_bits(self):
        with self.start(self.mesh) as w:
            first = w.dump()
            self.two_steps(w)
            result, path = w.dump(), self.saved_edit(w)
            edit = json.loads(path.read_text())
            self.assertEqual(edit["mesh"]["vertices"], len(self.points))
            self.assertEqual(len(edit["steps"]), 2)
            w.press_button(part("reset"))
            w.press_button(part("load"), wait=False)
            w.answer(path=path)
            self.assert_same(result, w.dump())
            w.key("Z", "Z", modifiers=["ctrl"])
            self.assert_same(first, w.dump())
        with self.start(self.mesh) as w:
            w.press_button(part("load"), wait=False)
            w.answer(path=path)
            self.assert_same(result, w.dump())
            self.assert_replay_is_the_same(w, self.mesh)

    def test_saved_edit_has_positions_by_which_it_is_applied(self):
        with self.start(self.mesh) as w:
            self.two_steps(w)
            edit = json.loads(self.saved_edit(w).read_text())
            positions = edit["mesh"]["positions"]
            numbers = numbers_of(positions["vertices"])
            self.assertEqual([[*map(bits_of, point)] for point in positions["points"]],
                             [[*map(bits_of, self.points[number])] for number in numbers])
            for step in edit["steps"]:
                for named in (*step["handles"], step["region"]):
                    self.assertLessEqual(set(numbers_of(named.get("vertices", ""))), set(numbers))
            edit["mesh"] = {"positions": positions}
            path, _ = self.edited([replay(json.dumps(edit))], self.mesh)
            self.assertEqual(Ply(path).point_bits(), w.dump().point_bits())
            path, _ = self.edited([replay(json.dumps({**edit, "mesh": {}}))], self.mesh)
            self.assertEqual(Ply(path).point_bits(), w.dump().point_bits())

    def test_what_cannot_be_loaded_is_reported_in_a_line(self):
        broken = self.folder / "broken.json"
        broken.write_text('{"laplacian_edit": 1, "steps": 3}')
        other = self.folder / "other.json"
        other.write_text(json.dumps({"laplacian_edit": 1, "mesh": {"vertices": 5, "faces": 6}, "steps": [
            {"region": {"radius": 1}, "handles": [{"vertices": "0", "translation": [1, 0, 0]}]}]}))
        with self.start(self.mesh) as w:
            before = w.dump()
            for path in (broken, other):
                w.press_button(part("load"), wait=False)
                w.answer(path=path)
                self.assertEqual(w.dialog(), {})
                self.assertRegex(self.message(w), "steps" if path == broken else "vertices")
            self.assert_same(before, w.dump())

    def test_copied_script_runs_in_meshlabserver(self):
        with self.start(self.mesh) as w:
            self.two_steps(w)
            w.press_button(part("copy"))
            script = w.clipboard()
            self.assertIn("<!DOCTYPE FilterScript>", script)
            self.assertIn('"Laplacian Edit Replay"', script)
            filters = re.search(r"<FilterScript>(.*)</FilterScript>", script, re.DOTALL).group(1)
            path, _ = self.edited([filters], self.mesh)
            self.assertEqual(Ply(path).point_bits(), w.dump().point_bits())

    def test_filter_history_replays(self):
        with self.start(self.mesh) as w:
            self.two_steps(w)
            w.trigger("Laplacian Drag")
            history = w.history()
            self.assertEqual([h["name"] for h in history], ["Laplacian Edit Replay"])
            edit = json.loads(history[0]["texts"]["edit"])
            self.assertEqual(len(edit["steps"]), 2)
            path, _ = self.edited([replay(history[0]["texts"]["edit"])], self.mesh)
            self.assertEqual(Ply(path).point_bits(), w.dump().point_bits())


class FilterInTheWindow(ToolTest):
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
