# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel: what its widgets show and set, and the files that its dialogs suggest."""
import json
import unittest

from tool import TOOL, ToolTest, part
from ply import write_ply


class Values(ToolTest):
    def test_method_is_remembered_and_all_settings_can_be_reset(self):
        with self.start(self.mesh, disc=33) as w:
            w.set(part("method"), 2)
            w.set(part("padding"), 30)
        with self.open(self.mesh, keeps=True) as w:
            w.trigger(TOOL)
            for name, key, value in (("method", "currentIndex", 2), ("padding", "value", 10), ("handle_fraction", "value", 20)):
                self.assertEqual(w.widget(part(name))[key], value, name)
            w.set(part("padding"), 30)
            w.set(part("gizmo"), 1)
            w.press_button(part("defaults"))
            for name, key, value in (("method", "currentIndex", 0), ("padding", "value", 10), ("gizmo", "currentIndex", 0)):
                self.assertEqual(w.widget(part(name))[key], value, name)

    def test_what_belongs_to_the_session_is_kept_by_it(self):
        with self.start(self.mesh) as w:
            self.assertEqual(w.widget(part("mirror"))["count"], 8)  # off, six planes, one found
            choices = {"mode": 1, "brush_target": 2, "gizmo": 2, "pivot": 1, "mirror": 4}
            for name, index in choices.items():
                self.assertEqual(w.widget(part(name))["currentIndex"], 0, name)
                w.set(part(name), index)
            w.trigger(TOOL)
            w.trigger(TOOL)
            for name, index in choices.items():
                self.assertEqual(w.widget(part(name))["currentIndex"], index, name)


class Statistics(ToolTest):
    def test_stretch_is_shown_where_it_is(self):
        with self.start(self.mesh, disc=20) as w:
            x, y = self.pull(w, self.CENTRE, (40, -30), release=False)
            plain = self.picture(w, x, y)
            w.set(part("colours"), "Stretch")
            hot = self.picture(w, x, y)
            self.assert_other_picture(plain, hot, 1000)
            w.set(part("colours"), "Region")
            self.assertLess(sum(a != b for a, b in zip(plain, self.picture(w, x, y))), 20)


class Files(ToolTest):
    def test_dialogs_suggest_a_file_beside_the_mesh(self):
        folder = self.folder / "somewhere else"
        folder.mkdir()
        mesh = write_ply(folder / "nose.v2.ply", self.points, self.faces)
        suggested = folder / "nose.v2.laplacian.json"
        with self.start(mesh) as w:
            self.pull(w, self.CENTRE, (20, -20))
            result = w.dump()
            w.press_button(part("load"), wait=False)
            self.assertNotIn(str(suggested), w.wait_dialog()["files"])  # it is not there yet
            w.answer(button="Cancel")
            w.press_button(part("save"), wait=False)
            self.assertEqual(w.wait_dialog()["files"], [str(suggested)])
            w.answer()
            self.assertEqual(len(json.loads(suggested.read_text())["steps"]), 1)
            w.press_button(part("reset"))
            w.press_button(part("load"), wait=False)
            self.assertEqual(w.wait_dialog()["files"], [str(suggested)])
            w.answer()
            self.assert_same(result, w.dump())


if __name__ == "__main__":
    unittest.main()
