# SPDX-License-Identifier: GPL-3.0-or-later
"""Every gesture with a real mouse and keyboard: X events by xdotool. The driver only tells pixels and looks."""
import contextlib
import math
import pathlib
import shutil
import unittest

from tool import ToolTest, part
from ply import Ply

WHEEL_UP, WHEEL_DOWN = 4, 5


class Gestures(ToolTest):
    @contextlib.contextmanager
    def window(self, disc=20, mesh=None):
        with self.start(mesh or self.mesh, disc=disc) as w:
            w.x_focus()
            yield w

    def at(self, row, column):
        return row * self.ROWS + column

    def x_pull(self, w, start, way):
        steps = len(self.steps_in_log(w))
        w.x_drag(start, (start[0] + way[0], start[1] + way[1]))
        w.wait(lambda: len(self.steps_in_log(w)) > steps, "no step was applied")
        w.idle()

    def is_modified(self, w):
        return w.layers()[0]["modified"]

    def x_save(self, w):
        saved = w.text().count("Saved Mesh")
        w.x_focus()
        w.x("key", "ctrl+e")
        w.wait_dialog(has_keys=True)
        w.x("key", "Return")
        w.wait(lambda: w.text().count("Saved Mesh") > saved, "the mesh is not saved")
        w.x_focus()

    def last_step(self, w):
        return self.steps_of(w)[-1]

    def test_hover_wheel_press_drag_release_undo_save_and_quit(self):
        mesh = pathlib.Path(shutil.copy(self.mesh, self.folder / "copy.ply"))
        with self.window(mesh=mesh) as w:
            before = w.dump()
            self.hover(w)
            radius = w.widget(part("radius"))["value"]
            w.x("click", WHEEL_UP)
            self.settle(w)
            self.assertGreater(w.widget(part("radius"))["value"], radius)
            w.x("click", WHEEL_DOWN)
            start = self.on_screen(w, self.CENTRE)
            self.x_pull(w, start, (40, -55))
            self.assertLess(math.dist(self.on_screen(w, self.CENTRE), (start[0] + 40, start[1] - 55)), 2.5)
            self.assertGreater(self.steps_in_log(w)[0]["handle"], 5)
            self.assertLessEqual(set(before.differences(w.dump())), {"positions", "normals", "face_normals", "box"})
            self.assert_replay_is_the_same(w, self.mesh)
            self.undo(w)
            self.assert_same(before, w.dump())
            self.x_key(w, "ctrl+shift+z")
            self.x_save(w)
            shown = w.dump()
            self.assertNotEqual(shown.moved(before), set())
            self.assertEqual((Ply(mesh).point_bits(), Ply(mesh).faces()), (shown.point_bits(), shown.faces()))
            modified = self.is_modified(w)  # after Export, which MeshLab 2020.09 alone takes for saving
            x, y = self.pull(w, self.CENTRE, (20, 10), release=False)
            self.assertEqual(self.is_modified(w), modified, "a passing pose")
            w.mouse("release", x, y)
            w.wait(lambda: self.is_modified(w), "an applied step is to be saved")
            self.x_save(w)
            w.x("key", "ctrl+q")
            w.wait_end()

    def test_other_side_is_shown_and_moved(self):
        with self.window() as w:
            near, far = self.at(20, 30), self.at(20, 10)
            off = [a - b for a, b in zip(self.points[near], self.points[self.CENTRE])]
            axis = 0 if abs(off[0]) > abs(off[1]) else 1

            w.set(part("mirror"), 4 + axis)  # through the box's centre
            w.x("mousemove", 5, 5)
            self.settle(w)
            plain = self.picture(w, *w.pixel(far))
            w.x("mousemove", *self.on_screen(w, near))
            w.wait(lambda: sum(a != b for a, b in zip(self.picture(w, *w.pixel(far)), plain)) > 100,
                   "the other side is not shown", 20)
            before = w.dump()
            self.x_pull(w, self.on_screen(w, near), (10, 30))
            self.assertIn("mirror", self.last_step(w))
            self.assertLessEqual({near, far}, w.dump().moved(before))
            self.assert_replay_is_the_same(w, self.mesh)

    def test_last_step_takes_numbers_and_a_fraction(self):
        with self.window() as w:
            w.set(part("group_last_step"), True)
            self.assertFalse(self.enabled(w, "last_fraction"))
            self.x_pull(w, self.on_screen(w, self.CENTRE), (0, -40))
            whole = self.last_step(w)["handles"][0]["translation"]
            full = w.dump().triples()[self.CENTRE]
            # The slider's knob, pulled from the right end to the left with the mouse: shown on the way, then applied.
            left, top, width, height = w.widget(part("last_fraction"))["rectangle"]
            w.x("mousemove", left + width - 6, top + height // 2, "mousedown", 1)
            for fraction in (0.9, 0.7, 0.5):
                w.x("mousemove", round(left + width * fraction), top + height // 2, "sleep", 0.1)
            w.wait(lambda: math.dist(w.dump().triples()[self.CENTRE], full) > 0.01, "nothing is shown", 20)
            w.x("key", "ctrl+e")  # opens a dialog, which takes the release
            w.wait_dialog(has_keys=True)
            w.x("mouseup", 1, "key", "Escape")
            self.wait_closed(w)
            w.wait(lambda: self.last_step(w)["handles"][0]["translation"] != whole, "nothing was applied", 20)
            percent = w.widget(part("last_fraction"))["value"]
            self.assertTrue(30 < percent < 70, percent)
            for a, b in zip(self.last_step(w)["handles"][0]["translation"], whole):
                self.assertAlmostEqual(a, b * percent / 100, places=9)
            w.set(part("last_value"), "{}, 0.1, {}".format(*self.last_step(w)["handles"][0]["translation"][::2]))
            self.assertAlmostEqual(self.last_step(w)["handles"][0]["translation"][1], 0.1 * percent / 100, places=6)


if __name__ == "__main__":
    unittest.main()
