# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person does with the tool to regions and handles, in the real window on a generated mesh."""
import math
import re
import time
import unittest

from tool import PANEL, TOOL, ToolTest, part


class Start(ToolTest):
    def test_menu_entry_icon_and_shortcut(self):
        with self.open(self.mesh) as w:
            self.assertEqual(w.action(TOOL), {"count": 1, "icon": True, "shortcut": "Ctrl+Alt+L", "checked": False, "enabled": True})
            before = w.dump()
            w.trigger(TOOL)
            self.assertEqual(w.tool(), (TOOL, False))
            self.assertTrue(w.action(TOOL)["checked"])
            self.assertTrue(w.widget(PANEL)["visible"])
            self.assertRegex(self.message(w), "Press on the surface and drag")
            w.trigger(TOOL)
            self.assertEqual(w.tool()[0], "")
            self.assertFalse(w.widget(PANEL)["visible"])
            self.assert_same(before, w.dump())

    def test_panel_leaves_the_picture_its_width(self):
        groups = ["last_step", "paint", "region", "advanced", "statistics"]
        basic = ["radius", "handle_fraction", "detail", "automatic", "mode", "defaults", "pivot", "mirror", "gizmo", "move", "rotate", "scale",
                 "undo", "redo", "reset", "save", "load", "help"]
        with self.open(self.mesh) as w:
            w.close_widget("layerDialog")  # which is higher, and as wide, as it likes
            w.trigger(TOOL)
            w.resize(1280, 720)
            self.assertGreaterEqual(w.ask("project")["width"], 900)
            w.resize(1280, 620)
            left, top, width, height = w.widget(part("scroll"))["rectangle"]
            self.assertLessEqual(top + height, 620)
            for name in basic + ["group_" + g for g in groups]:
                widget = w.widget(part(name))
                x, y, wide, high = widget["rectangle"]
                self.assertTrue(widget["visible"], name)
                self.assertTrue(left <= x and x + wide <= left + width and top <= y and y + high <= top + height, name)
            for group in groups:
                w.set(part("group_" + group), True)
            hidden = {part(n) for n in ("pieces", "progress", "apply", "cancel")}  # nothing is prepared, nothing moves
            for name, widget in w.widgets(part("")).items():
                self.assertEqual(widget["visible"], name not in hidden, name)
            self.assertGreaterEqual(w.ask("project")["width"], 900)
            w.set(part("group_advanced"), False)
            self.assertFalse(w.widget(part("membrane"))["visible"])

    def test_few_inputs_are_shown(self):
        """At most 38, 18 of them in Basic, at rest and during a motion, when Apply and Cancel replace others."""
        kinds = ("QDoubleSpinBox", "QSpinBox", "QSlider", "QComboBox", "QCheckBox", "QPushButton", "QLineEdit", "QListWidget")

        def shown(w):
            return {name.removeprefix(part("")) for name, v in w.widgets(inside=PANEL).items()
                    if v["class"] in kinds and name.startswith(part("")) and v["visible"]}

        with self.start(self.mesh, disc=20) as w:
            groups = [name for name in w.widgets(part("group_")) if name != part("group_basic")]
            w.click(*w.pixel(self.CENTRE))
            for moves in (False, True):
                if moves:
                    w.key("T")
                for group in groups:
                    w.set(group, False)
                basic = shown(w)
                for group in groups:
                    w.set(group, True)
                everything = shown(w)
                self.assertLessEqual(len(basic), 18, basic)
                self.assertLessEqual(len(everything), 38, everything)
                for name in ("apply", "cancel", "move", "rotate", "scale"):
                    self.assertEqual(name in basic, moves == (name in ("apply", "cancel")), name)


class Sizes(ToolTest):
    def test_a_click_makes_the_sizes_automatic_again(self):
        with self.start(self.mesh, disc=20) as w:
            self.assertTrue(w.widget(part("automatic"))["checked"])
            w.set(part("padding"), 25)
            w.x("mousemove", *self.on_screen(w, self.CENTRE), "sleep", 0.2, "click", 5, "click", 5, "click", 5)
            self.settle(w)
            self.assertFalse(w.widget(part("automatic"))["checked"])
            self.click_widget(w, part("automatic"), right=8)
            self.assertTrue(w.widget(part("automatic"))["checked"])
            self.assertEqual(w.widget(part("padding"))["value"], 25)
            self.assertEqual(w.widget(part("handle_fraction"))["value"], 20)


class Gesture(ToolTest):
    def test_drag_right_after_a_click(self):
        """Qt makes a double click of the second press."""
        with self.start(self.mesh) as w:
            x, y = w.pixel(self.CENTRE)
            for kind in ("press", "release", "double"):
                w.mouse(kind, x, y)
            w.mouse("move", x + 30, y - 20)
            w.release(x + 30, y - 20)
            self.assert_at(w, self.CENTRE, (x + 30, y - 20))
            self.assertEqual(len(self.steps_in_log(w)), 1)


class Region(ToolTest):
    def region_of_next_step(self, w):
        """Pulls a little. @return the number of vertices in the region"""
        self.pull(w, self.CENTRE, (12, -9))
        return self.steps_in_log(w)[-1]["region"]

    def test_selected_faces_are_the_region(self):
        with self.start(self.mesh) as w:
            # Columns 10 to 30 of rows 10 to 30.
            chosen = [f for f, corners in enumerate(self.faces)
                      if all(10 <= v // self.ROWS <= 30 and 10 <= v % self.ROWS <= 30 for v in corners)]
            w.set(part("group_paint"), True)
            w.press_button(part("from_selection"))
            self.assertRegex(self.message(w), "select some vertices or faces")
            w.layer(selected_vertices=[v for f in chosen for v in self.faces[f]])
            w.press_button(part("from_selection"))
            self.assertEqual(self.region_of_next_step(w), 21 * 21)
            w.press_button(part("reset"))
            w.press_button(part("clear"))
            w.layer(selected_vertices=[], selected_faces=chosen)
            selected = w.dump()["face_flags"]
            w.press_button(part("from_selection"))
            before = w.dump()
            self.assertEqual(self.region_of_next_step(w), 21 * 21)
            inside = {v for f in chosen for v in self.faces[f]}
            self.assertLessEqual(before.moved(w.dump()), inside)
            self.assertEqual(w.dump()["face_flags"], selected)
            self.assert_replay_is_the_same(w, self.mesh)

    def test_motion_begins_before_a_selected_region_is_known(self):
        """Until then the region has no handle groups, and no pose shows where contact would stop the handle."""
        with self.start(self.mesh) as w:
            w.set(part("contact"), True)
            w.click(*w.pixel(self.CENTRE))
            w.layer(selected_vertices=[v for v in range(len(self.points)) if 10 <= v // self.ROWS <= 30 and 10 <= v % self.ROWS <= 30])
            self.assertEqual(w.batch([{"command": "set", "name": part("from_selection"), "value": True},
                                      {"command": "key", "key": "T", "modifiers": []}, {"command": "on_screen"}]), [])
            w.key(".", "1", "Return")
            self.assertEqual(self.steps_in_log(w)[-1]["region"], 21 * 21)


class Motion(ToolTest):
    def begin_to_turn(self, w):
        """By 37 degrees. Returns the pivot's pixel."""
        w.x_focus()
        x, y = w.pixel(self.CENTRE)
        w.click(x, y)
        w.move(x + 60, y)
        w.key("R")
        w.move(x + 60 * math.cos(math.radians(37)), y - 60 * math.sin(math.radians(37)))
        return x, y

    def test_ctrl_snaps_a_motion_from_when_it_is_pressed(self):
        with self.start(self.mesh, disc=40) as w:
            x, y = self.begin_to_turn(w)
            self.assertRegex(self.message(w), r"^Turning by 3[67](\.\d+)? degrees:")
            w.x("keydown", "Control_L")
            w.wait_message(r"^Turning by 30 degrees \(in steps of 15\):")
            w.x("keyup", "Control_L")
            w.wait_message(r"^Turning by 3[67](\.\d+)? degrees:")
            there = x + 60 * math.cos(math.radians(80)), y - 60 * math.sin(math.radians(80))
            w.move(*there, modifiers=["ctrl"])
            w.click(*there, modifiers=["ctrl"])
            self.assertEqual(abs(self.steps_of(w)[0]["handles"][0]["rotation"]["degrees"]), 75)

    def test_ctrl_of_a_shortcut_whose_dialog_takes_its_release_does_not_snap(self):
        with self.start(self.mesh, disc=40) as w:
            self.begin_to_turn(w)
            w.x("key", "ctrl+e")
            w.wait_dialog(has_keys=True)
            w.x("key", "Escape")
            self.wait_closed(w)
            w.key("Return")
            self.assertAlmostEqual(abs(self.steps_of(w)[0]["handles"][0]["rotation"]["degrees"]), 37, delta=1)

    def by_mouse(self, w):
        x, y = self.pull(w, self.CENTRE, (40, -40), release=False)
        self.assert_at(w, self.CENTRE, (x, y))
        return x, y

    def by_key(self, w):
        x, y = w.pixel(self.CENTRE)
        w.click(x, y)
        w.key("T")
        w.move(x + 30, y + 10)
        return x + 30, y + 10

    def cancel(self, begin, how):
        """A motion is begun and cancelled: not one bit of the mesh changes, then or later."""
        with self.start(self.mesh) as w:
            w.x_focus()
            before, camera = w.dump(), w.camera()
            x, y = begin(w)
            self.assertLessEqual({"positions", "normals", "face_normals"}, set(before.differences(w.dump())))
            how(w, x, y)
            w.idle()
            self.assert_same(before, w.dump())
            w.mouse("move", x + 30, y + 10)
            w.release(x + 30, y + 10)
            self.assert_same(before, w.dump())
            self.assertEqual(w.camera(), camera)
            self.assertEqual(self.steps_in_log(w), [])
            self.assert_at(w, self.CENTRE, self.pull(w, self.CENTRE, (20, 10)))

    def test_right_button_cancels_a_motion(self):
        def by_right_button(w, x, y):
            w.mouse("press", x, y, "right")
            self.assertEqual(w.tool(), (TOOL, False))
            w.mouse("move", x + 30, y + 10)
            w.mouse("release", x, y, "right")

        for begin in (self.by_mouse, self.by_key):
            with self.subTest(begin.__name__):
                self.cancel(begin, by_right_button)

    def test_suspending_cancels_a_motion(self):
        def by_suspending(w, x, y):
            w.trigger("Not editing")
            w.trigger("Not editing")

        def by_suspending_over_the_release(w, x, y):
            w.trigger("Not editing")
            w.mouse("release", x, y)
            w.trigger("Not editing")
            w.move(x - 20, y)

        for begin, how in ((self.by_mouse, by_suspending), (self.by_mouse, by_suspending_over_the_release),
                           (self.by_key, by_suspending)):
            with self.subTest(begin.__name__, how=how.__name__):
                self.cancel(begin, how)

    def test_escape_cancels_a_motion_and_only_then_suspends(self):
        def by_escape(w, x, y):
            w.x("key", "Escape")
            w.wait_cursor(self.ARROW)
            self.assertEqual(w.tool(), (TOOL, False))

        self.cancel(self.by_mouse, by_escape)
        with self.start(self.mesh) as w:
            w.x_focus()
            w.x("key", "Escape")
            w.wait_tool(TOOL, True)


class Hover(ToolTest):
    def test_cursor_says_what_a_press_would_do(self):
        with self.start(self.mesh, disc=30) as w:
            x, y = w.pixel(self.CENTRE)
            self.assertEqual(w.cursor(), self.ARROW)
            w.move(x, y)
            w.wait_cursor(self.POINTING_HAND)
            w.move(3, 300)
            self.assertEqual(w.cursor(), self.ARROW)
            w.click(x, y)
            w.move(x, y)
            self.assertEqual(w.cursor(), self.OPEN_HAND)
            w.move(x, y, modifiers=["ctrl"])
            self.assertEqual(w.cursor(), self.CROSS)
            w.move(*w.pixel(self.CENTRE + 10 * self.ROWS))
            self.assertEqual(w.cursor(), self.POINTING_HAND)
            self.pull(w, self.CENTRE, (20, 10), release=False)
            self.assertEqual(w.cursor(), self.CLOSED_HAND)
            w.release(x + 20, y + 10)
            w.trigger(TOOL)
            self.assertEqual(w.cursor(), self.ARROW)

    def test_what_a_press_would_take_is_drawn_and_follows_the_wheel(self):
        with self.start(self.mesh, disc=20) as w:
            x, y = w.pixel(self.CENTRE)
            w.move(3, 300)
            pictures = [self.picture(w, x, y)]
            w.move(x, y)
            w.wait_cursor(self.POINTING_HAND)
            pictures.append(self.picture(w, x, y))
            w.wheel(x, y, 2)
            pictures.append(self.picture(w, x, y))
            w.wheel(x, y, 2, modifiers=["shift"])
            pictures.append(self.picture(w, x, y))
            for before, after in zip(pictures, pictures[1:]):
                self.assert_other_picture(before, after)
            w.move(3, 300)
            self.assertEqual(self.picture(w, x, y), pictures[0])

    def test_wheel_says_what_it_does(self):
        with self.start(self.mesh, disc=20) as w:
            w.move(300, 300)
            w.wheel(300, 300, 1)
            radius = w.widget(part("radius"))["value"]
            found = re.match(r"Radius of the next region: ([\d.]+) \(Shift: handle size, Ctrl: zoom\)", self.message(w))
            self.assertAlmostEqual(float(found[1]), radius, delta=0.01 * radius)
            self.assertAlmostEqual(w.widget(part("handle_fraction"))["value"], 20 / 1.1, delta=0.1)  # of the radius shown
            w.wheel(300, 300, 1, modifiers=["shift"])
            self.assertRegex(self.message(w), "^Handle size: 22.7 %, ")
            w.wheel(300, 300, 1, modifiers=["ctrl", "shift"])
            self.assertRegex(self.message(w), "^Padding: 12 % of the radius")
            w.move(303, 300)
            self.assertRegex(self.message(w), "^Padding")
            w.move(330, 300)
            self.assertRegex(self.message(w), "^Press on the surface and drag")
            values = [w.widget(part(n))["value"] for n in ("radius", "handle_fraction", "padding")]
            camera = w.camera()
            w.wheel(3, 300, 2)  # off the mesh
            self.assertNotEqual(w.camera(), camera)
            for modifier in ("ctrl", "alt"):
                camera = w.camera()
                w.wheel(300, 300, 3, modifiers=[modifier])
                self.assertNotEqual(w.camera(), camera)
            self.assertEqual(values, [w.widget(part(n))["value"] for n in ("radius", "handle_fraction", "padding")])

    def test_wheel_that_began_beside_the_mesh_zooms_until_it_rests(self):
        with self.start(self.mesh) as w:
            radius = w.widget(part("radius"))["value"]
            turn = {"command": "wheel", "delta": 120, "modifiers": []}
            w.batch([{**turn, "x": 3, "y": 300}, {**turn, "x": 300, "y": 300}])
            w.idle()
            self.assertEqual(w.widget(part("radius"))["value"], radius)
            time.sleep(0.6)
            w.wheel(*w.pixel(self.CENTRE), 1)
            self.assertNotEqual(w.widget(part("radius"))["value"], radius)


if __name__ == "__main__":
    unittest.main()
