# SPDX-License-Identifier: GPL-3.0-or-later
"""Every gesture with a real mouse and keyboard: X events by xdotool. The driver only tells pixels and looks."""
import contextlib
import math
import pathlib
import shutil
import unittest

from tool import ToolTest, numbers_of, part
from ply import Ply, write_ply

WHEEL_UP, WHEEL_DOWN = 4, 5


class Gestures(ToolTest):
    @contextlib.contextmanager
    def window(self, disc=20, mesh=None):
        with self.start(mesh or self.mesh, disc=disc) as w:
            w.x_focus()
            yield w

    def at(self, row, column):
        return row * self.ROWS + column

    def x_click(self, w, vertex, *modifiers):
        held = [("keydown", m) for m in modifiers], [("keyup", m) for m in modifiers]
        w.x("mousemove", *self.on_screen(w, vertex), *sum(held[0], ()), "sleep", 0.05, "click", 1, "sleep", 0.05,
            *sum(held[1], ()))
        self.settle(w)

    def x_stroke(self, w, vertices, modifier):
        w.x("mousemove", *self.on_screen(w, vertices[0]), "keydown", modifier, "sleep", 0.05, "mousedown", 1)
        for vertex in vertices:
            w.x("mousemove", *self.on_screen(w, vertex), "sleep", 0.03)
        w.x("mouseup", 1, "sleep", 0.05, "keyup", modifier)
        self.settle(w)

    def x_pull(self, w, start, way):
        steps = len(self.steps_in_log(w))
        w.x_drag(start, (start[0] + way[0], start[1] + way[1]))
        w.wait(lambda: len(self.steps_in_log(w)) > steps, "no step was applied")
        w.idle()

    def counts(self, w):
        """Of the region, from the panel: handle, free, anchors, fixed."""
        return [int(word.strip(",;")) for word in w.widget(part("region"))["text"].split() if word.strip(",;").isdigit()]

    def last_step(self, w):
        return self.steps_of(w)[-1]

    def test_hover_wheel_press_drag_release_undo_save_and_quit(self):
        mesh = pathlib.Path(shutil.copy(self.mesh, self.folder / "copy.ply"))
        with self.window(mesh=mesh) as w:
            before = w.dump()
            w.x("mousemove", *self.on_screen(w, self.CENTRE))
            self.settle(w)
            radius = w.widget(part("radius"))["value"]
            w.x("click", WHEEL_UP)
            self.settle(w)
            self.assertGreater(w.widget(part("radius"))["value"], radius)
            w.x("click", WHEEL_DOWN)
            start = self.on_screen(w, self.CENTRE)
            self.x_pull(w, start, (40, -55))
            self.assertLess(math.dist(self.on_screen(w, self.CENTRE), (start[0] + 40, start[1] - 55)), 2.5)
            self.assertGreater(self.steps_in_log(w)[0]["handle"], 5)
            self.assert_replay_is_the_same(w, self.mesh)
            self.undo(w)
            self.assert_same(before, w.dump())
            self.x_key(w, "ctrl+shift+z")
            w.x("key", "ctrl+e")
            w.wait_dialog()
            w.x("sleep", 0.3, "key", "Return")
            w.wait_output("Saved Mesh")
            shown = w.dump()
            self.assertNotEqual(shown.moved(before), set())
            self.assertEqual((Ply(mesh).point_bits(), Ply(mesh).faces()), (shown.point_bits(), shown.faces()))
            w.x_focus()
            w.x("key", "ctrl+q")
            w.wait_end()

    def test_arrow_ring_and_knob(self):
        with self.window() as w:
            self.x_click(w, self.CENTRE)
            self.x_key(w, "v")
            self.assertEqual(w.widget(part("gizmo"))["currentText"], "Axes of the layer")
            middle = self.on_screen(w, self.CENTRE)
            # Seen from above: an arrow to the right along X and one up along Y, a ring about Z of 0.8 of their length
            # of 90 pixels, and the scale handle on the diagonal, as far.
            self.x_pull(w, (middle[0] + 60, middle[1]), (45, 30))
            way = self.last_step(w)["handles"][0]["translation"]
            self.assertGreater(way[0], 0)
            self.assertEqual(way[1:], [0, 0])
            self.undo(w)
            angle = math.radians(20)
            on_ring = [(round(middle[0] + 72 * math.cos(a)), round(middle[1] - 72 * math.sin(a)))
                       for a in (angle, angle + math.radians(50))]
            self.x_pull(w, on_ring[0], (on_ring[1][0] - on_ring[0][0], on_ring[1][1] - on_ring[0][1]))
            rotation = self.last_step(w)["handles"][0]["rotation"]
            self.assertEqual(rotation["axis"], [0, 0, 1])
            self.assertAlmostEqual(rotation["degrees"], 50, delta=3)
            self.undo(w)
            # With Ctrl from when the ring is held on, in steps of 15 degrees.
            w.x("mousemove", *on_ring[0], "mousedown", 1, "sleep", 0.05, "keydown", "ctrl", "mousemove",
                on_ring[0][0] - 9, on_ring[0][1] - 20, "sleep", 0.1, "mousemove", *on_ring[1], "sleep", 0.1, "mouseup", 1,
                "keyup", "ctrl")
            self.settle(w)
            self.assertEqual(self.last_step(w)["handles"][0]["rotation"]["degrees"] % 15, 0)
            self.undo(w)
            away = round(90 / math.sqrt(2))
            self.x_pull(w, (middle[0] + away, middle[1] - away), (50, -50))
            self.assertGreater(self.last_step(w)["handles"][0]["scale"], 1.2)
            self.assert_replay_is_the_same(w, self.mesh)

    def test_painting_of_region_handle_and_anchors_with_undo(self):
        with self.window(disc=0) as w:
            self.x_click(w, self.CENTRE)
            first = self.counts(w)
            outward = [self.at(20, c) for c in range(22, 34, 2)]
            self.x_stroke(w, outward, "ctrl")
            larger = self.counts(w)
            self.assertGreater(sum(larger[:3]), sum(first[:3]))
            self.x_key(w, "b")  # the region, no key held
            self.x_key(w, "b")  # the handle
            self.x_stroke(w, [self.at(20, 21), self.at(20, 23)], "ctrl")
            self.assertGreater(self.counts(w)[0], 1)
            self.x_key(w, "b")  # the anchors
            anchors = self.counts(w)[2]
            self.x_stroke(w, [self.at(17, 18), self.at(17, 22)], "ctrl")
            self.assertGreater(self.counts(w)[2], anchors)
            self.x_stroke(w, [self.at(17, 18), self.at(17, 22)], "shift")
            for expected in (None, None, larger, first):
                self.x_key(w, "ctrl+z")
                if expected:
                    self.assertEqual(self.counts(w), expected)
            self.x_key(w, "ctrl+shift+z")
            self.assertEqual(self.counts(w), larger)
            self.x_key(w, "b")  # nothing is painted any more
            self.x_pull(w, self.on_screen(w, self.CENTRE), (15, 20))
            self.assert_replay_is_the_same(w, self.mesh)

    def test_fast_stroke_leaves_no_gap(self):
        with self.window() as w:
            w.set(part("group_paint"), True)
            w.set(part("brush"), 8)
            w.set(part("brush_target"), "Fixed")
            w.x("mousemove", *self.on_screen(w, self.at(30, 8)), "mousedown", 1)
            for vertex in (self.at(30, 32), self.at(14, 32)):
                w.x("mousemove", *self.on_screen(w, vertex))
            w.x("mouseup", 1)
            self.settle(w)
            self.x_key(w, "Escape")
            self.x_pull(w, self.on_screen(w, self.CENTRE), (15, 20))
            held = set(numbers_of(self.last_step(w)["region"]["held"]))
            self.assertLessEqual({self.at(30, c) for c in range(8, 33)} | {self.at(r, 32) for r in range(14, 31)}, held)
            self.assertFalse({self.at(20, c) for c in range(8, 25)} & held)
            self.assert_replay_is_the_same(w, self.mesh)

    def test_chosen_groups_move_together(self):
        with self.window(disc=0) as w:
            groups = [self.at(20, 14), self.at(20, 18), self.at(23, 16)]
            self.x_click(w, groups[0])
            for vertex in groups[1:]:
                w.x("key", "g")
                self.x_click(w, vertex)
            self.x_click(w, groups[0], "shift")
            self.assertRegex(self.message(w), "2 of 3 move together")
            before = w.dump().triples()
            self.x_pull(w, self.on_screen(w, groups[2]), (15, 25))
            handles = self.last_step(w)["handles"]
            self.assertEqual(handles[0]["translation"], handles[2]["translation"])
            self.assertEqual(handles[1]["translation"], [0, 0, 0])
            after = w.dump().triples()
            ways = [math.dist(before[v], after[v]) for v in groups]
            self.assertGreater(ways[0], 0.01)
            self.assertLess(ways[1], 0.02 * ways[0])
            self.assert_replay_is_the_same(w, self.mesh)

    def test_curve_bends_by_its_points_and_shows_the_next_piece(self):
        with self.window(disc=0) as w:
            left, middle, right = (self.at(20, c) for c in (14, 20, 26))
            w.set(part("radius"), 2 * w.widget(part("radius"))["value"])
            w.x_focus()
            w.x("key", "c")
            self.x_click(w, left)
            between = w.pixel(self.at(20, 18))
            w.x("mousemove", 5, 5)
            self.settle(w)
            plain = self.picture(w, *between, half=6)
            w.x("mousemove", *self.on_screen(w, self.at(20, 22)))
            w.wait(lambda: self.picture(w, *between, half=6) != plain, "the next piece is not shown", 20)
            self.x_click(w, middle)
            self.x_click(w, right)
            before = w.dump().triples()
            for point in (left, right):  # a smile
                self.x_pull(w, self.on_screen(w, point), (0, -25))
                self.assertIn("targets", self.last_step(w)["handles"][0])
            after = w.dump().triples()
            self.assertGreater(min(math.dist(before[v], after[v]) for v in (left, right)), 0.01)
            self.assertLess(math.dist(before[middle], after[middle]), 0.02 * math.dist(before[left], after[left]))
            self.assert_replay_is_the_same(w, self.mesh)

    def test_other_side_is_shown_and_moved(self):
        with self.window() as w:
            near, far = self.at(20, 30), self.at(20, 10)
            off = [a - b for a, b in zip(self.points[near], self.points[self.CENTRE])]
            axis = 0 if abs(off[0]) > abs(off[1]) else 1

            def pictures():
                w.x("mousemove", 5, 5)
                self.settle(w)
                return self.picture(w, *w.pixel(self.CENTRE), half=20), self.picture(w, *w.pixel(far))

            without_plane, _ = pictures()
            w.set(part("mirror"), 4 + axis)  # through the box's centre
            with_plane, plain = pictures()
            self.assertNotEqual(with_plane, without_plane, "the plane is not drawn")
            w.x("mousemove", *self.on_screen(w, near))
            w.wait(lambda: sum(a != b for a, b in zip(self.picture(w, *w.pixel(far)), plain)) > 100,
                   "the other side is not shown", 20)
            before = w.dump()
            self.x_pull(w, self.on_screen(w, near), (10, 30))
            self.assertIn("mirror", self.last_step(w))
            self.assertLessEqual({near, far}, w.dump().moved(before))
            self.assert_replay_is_the_same(w, self.mesh)

    def test_drag_turns_about_the_pivot_and_shift_moves(self):
        with self.window() as w:
            w.set(part("handle_fraction"), 20)
            self.x_click(w, self.CENTRE)
            w.set(part("pivot"), "Point (next click)")
            self.x_click(w, self.CENTRE + 4)
            x, y = self.on_screen(w, self.CENTRE)
            self.x_pull(w, (x, y), (10, -40))
            rotation = self.last_step(w)["handles"][0]["rotation"]
            self.assertGreater(abs(rotation["degrees"]), 15)
            way = [a - b for a, b in zip(rotation["center"], self.points[self.CENTRE + 4])]
            self.assertLess(math.hypot(*way), 1e-3)
            self.undo(w)
            w.x("keydown", "Shift_L")
            self.x_pull(w, (x, y), (10, -40))
            w.x("keyup", "Shift_L")
            self.settle(w)
            self.assertGreater(math.hypot(*self.last_step(w)["handles"][0]["translation"]), 0.01)

    def test_scale_along_an_axis_by_a_percentage(self):
        with self.window() as w:
            before = w.dump().triples()
            self.x_click(w, self.CENTRE)
            self.x_key(w, "s", "y", "1", "0", "5", "percent")
            self.assertRegex(self.message(w), "Scaling by 1.05 along Y")
            self.x_key(w, "Return")
            matrix = self.last_step(w)["handles"][0]["matrix"]
            self.assertEqual([matrix[i] for i in (0, 1, 2, 4, 5, 6, 8, 9, 10)], [1, 0, 0, 0, 1.05, 0, 0, 0, 1])
            beside, other = self.at(20, 21), self.at(21, 20)
            after = w.dump().triples()
            for vertex in (beside, other):
                way = [a - b for a, b in zip(before[vertex], before[self.CENTRE])]
                now = [a - b for a, b in zip(after[vertex], after[self.CENTRE])]
                for axis in range(3):
                    self.assertAlmostEqual(now[axis], (1, 1.05, 1)[axis] * way[axis], delta=2e-4)
            self.assert_replay_is_the_same(w, self.mesh)

    def test_pipe_bends_in_four_actions(self):
        around, rings = 24, 60
        points = [(3 * i / (rings - 1) - 1.5, 0.12 * math.cos(2 * math.pi * j / around),
                   0.12 * math.sin(2 * math.pi * j / around)) for i in range(rings) for j in range(around)]
        faces = [face for i in range(rings - 1) for j in range(around)
                 for a, b in [(i * around + j, i * around + (j + 1) % around)]
                 for face in [(a, b, a + around), (b, b + around, a + around)]]
        mesh = write_ply(self.folder / "pipe.ply", points, faces)
        with self.window(mesh=mesh) as w:
            before = w.dump()
            end = (rings - 3) * around + around // 4
            self.x_click(w, end)
            w.x("click", "--repeat", 12, "--delay", 20, WHEEL_UP)
            self.settle(w)
            self.x_key(w, "p", "p")
            self.x_key(w, "r", "z", "3", "0", "Return")
            after = w.dump()
            moved = before.moved(after)
            self.assertGreater(min(v // around for v in moved), rings // 4)
            boundary = [after.triples()[v] for v in range((rings - 1) * around, rings * around)]
            along = [a - b for a, b in zip(boundary[0], boundary[around // 2])]  # was along Y
            self.assertAlmostEqual(abs(math.degrees(math.atan2(along[0], along[1]))), 30, delta=3)
            self.assert_replay_is_the_same(w, mesh)

    def test_last_step_takes_numbers_and_a_fraction(self):
        with self.window() as w:
            w.set(part("group_last_step"), True)
            self.assertFalse(w.widget(part("last_fraction"))["enabled"])
            before = w.dump().triples()
            self.x_pull(w, self.on_screen(w, self.CENTRE), (0, -40))
            whole = self.last_step(w)["handles"][0]["translation"]
            full = w.dump().triples()[self.CENTRE]
            # The slider's knob, pulled from the right end to the left with the mouse: shown on the way, then applied.
            left, top, width, height = w.widget(part("last_fraction"))["rectangle"]
            w.x("mousemove", left + width - 6, top + height // 2, "mousedown", 1)
            for fraction in (0.9, 0.7, 0.5):
                w.x("mousemove", round(left + width * fraction), top + height // 2, "sleep", 0.1)
            w.wait(lambda: math.dist(w.dump().triples()[self.CENTRE], full) > 0.01, "nothing is shown", 20)
            w.x("mouseup", 1)
            w.wait(lambda: self.last_step(w)["handles"][0]["translation"] != whole, "nothing was applied", 20)
            percent = w.widget(part("last_fraction"))["value"]
            self.assertTrue(30 < percent < 70, percent)
            for a, b in zip(self.last_step(w)["handles"][0]["translation"], whole):
                self.assertAlmostEqual(a, b * percent / 100, places=9)
            w.set(part("last_value"), "{}, 0.1, {}".format(*self.last_step(w)["handles"][0]["translation"][::2]))
            w.set(part("last_fraction"), 100)
            self.assertEqual(len(self.steps_of(w)), 1)
            self.assertAlmostEqual(self.last_step(w)["handles"][0]["translation"][1], 0.1, places=6)
            self.assert_replay_is_the_same(w, self.mesh)
            # Each change is undone on its own, then the step.
            for _ in range(4):
                if w.widget(part("undo"))["enabled"]:
                    self.undo(w)
            self.assertEqual(w.dump().triples(), before)


if __name__ == "__main__":
    unittest.main()
