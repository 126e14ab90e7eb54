# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys go where the mouse is, and the line over the picture: by X events, without a click on the picture first."""
import re
import unittest

from tool import PANEL, TOOL, ToolTest, part
from ply import write_ply
from shapes import moved

F1 = 67  # the keycode: newer keymaps have F1 at a level with Alt as well, which xdotool may take


class Keyboard(ToolTest):
    def wait_mode(self, w, index):
        w.wait(lambda: w.widget(part("mode"))["currentIndex"] == index, "the key was not for the picture", 20)

    def test_keys_work_from_the_start_and_after_coming_back(self):
        with self.open(self.mesh) as w:
            w.resize(1280, 900)
            w.trigger("Front")
            self.shade_smoothly(w)
            w.x_focus()
            self.hover(w)
            w.x("key", "ctrl+alt+l")
            w.wait_output("Started Mode " + TOOL)
            self.hover(w, self.CENTRE + 1)
            self.x_key(w, "c")
            self.wait_mode(w, 1)
            self.x_key(w, "c")
            self.wait_mode(w, 0)
            before = w.dump()
            w.set(part("handle_fraction"), 0)
            self.pull(w, self.CENTRE, (30, 20))
            self.assertNotEqual(w.dump().moved(before), set())
            for _ in range(2):
                w.x("key", "ctrl+alt+l")
                self.settle(w)
            self.assertEqual(w.tool(), (TOOL, False))
            self.hover(w)
            self.x_key(w, "ctrl+z")
            w.wait(lambda: not w.dump().moved(before), "undo did not reach the tool", 20)

    # Every key of the tool but Esc, which the next test has, and what is seen after it: the line over the picture, how
    # many steps there are more, values of the panel, or that something has changed.
    TYPED = [
        (["t", "x", "period", "1", "2", "3"], r"^Moving by 0\.123 along X"), (["BackSpace"], r"^Drag the handle"),
        (["t", "y", "minus", "4", "5", "6"], r"^Moving by -456 along Y"),
        (["BackSpace", "t", "z", "7", "8", "9", "0"], r"^Moving by 7890 along Z"),
        (["BackSpace", "r", "n", "9"], r"^Turning by -?9 degrees about the normal"),
        (["s", "2", "Return"], 1), (["ctrl+z"], 0), (["ctrl+shift+z"], 1),
        (["g"], r"^Click on the surface to add a handle; the other handles hold\.(\n|$)"),
        (["w"], r"^Click on the surface for a new region"), (["bracketright"], "region"), (["bracketleft"], "region")]
    # Those that have an effect whatever a button has done.
    TYPED_ALWAYS = [
        (["v", "b", "c", "p", "h"], {"gizmo": 1, "brush_target": 1, "mode": 1, "pivot": 2, "colours": 2}),
        (["v", "b", "b", "b", "c", "p", "p", "h"], {"gizmo": 0, "brush_target": 0, "mode": 0, "pivot": 0, "colours": 0}),
        (["question"], r"^keys$")]

    def steps(self, w):
        return int(re.search(r"steps: (\d+)", w.widget(part("region"))["text"])[1])

    def type_all(self, w, typed):
        steps = self.steps(w)
        for keys, expected in typed:
            before = None
            if expected == "region":
                w.idle()
                before = w.widget(part(expected))["text"]
            w.x("key", "--delay", 8, *keys)

            def seen():
                if isinstance(expected, int):
                    return self.steps(w) == steps + expected
                if isinstance(expected, dict):
                    widgets = {name: w.widget(part(name)) for name in expected}
                    return {n: v.get("currentIndex") for n, v in widgets.items()} == expected
                if before is not None:
                    return w.widget(part(expected))["text"] != before
                return re.search(expected, w.on_screen()[0])
            w.wait(seen, f"{keys} had no effect", 20)

    def give_focus(self, w, name, kind):
        """As a user would: by a click, in a list or a dialog as well."""
        for _ in range(2 if kind == "QToolButton" else 1):
            self.click_widget(w, name)
        if kind == "QComboBox":
            w.x("key", "Escape")  # closes the list
        elif name in map(part, ("save", "load")):
            w.answer(button="Cancel")
            w.x_focus()

    def test_every_key_works_after_a_widget_of_each_kind(self):
        """One function makes all widgets of a kind; save opens a dialog, and help shows the keys."""
        fields = {"QDoubleSpinBox", "QLineEdit"}
        with self.start(self.mesh, disc=20) as w:
            w.x_focus()
            widgets = {name: v for name, v in w.widgets(inside=PANEL).items() if name.startswith(part(""))}
            for name, widget in widgets.items():
                self.assertEqual(widget["takes_keys"], widget["class"] in fields, name)
            for name in map(part, ("radius", "mode", "detail", "group_region", "undo", "save", "help", "last_value")):
                w.set(part("group_last_step"), name == part("last_value"))
                with self.subTest(name):
                    self.from_widget(w, name, widgets[name]["class"])

    def from_widget(self, w, name, kind):
        """Presses the keys after the widget had the focus."""
        for each in ("reset", "clear"):
            w.set(part("brush_target"), 0)
            if w.widget(part(each))["enabled"]:
                w.set(part(each), True)
        w.click(*w.pixel(self.CENTRE))
        if name.startswith(part("last_")) or not w.widget(name)["enabled"]:
            self.pull(w, self.CENTRE, (20, 10))
        if not w.widget(name)["enabled"]:
            w.key("T")
        self.assertTrue(w.widget(name)["enabled"])
        mode = w.widget(part("mode"))["currentIndex"]
        at = self.on_screen(w, self.CENTRE + 2)
        self.give_focus(w, name, kind)
        w.x("mousemove", *at, "key", "c")
        self.wait_mode(w, 1 - mode)
        w.x("key", "c")
        self.wait_mode(w, mode)
        self.assertEqual(w.tool(), (TOOL, False))
        self.type_all(w, self.TYPED_ALWAYS[:-1])
        if kind != "QPushButton":
            self.type_all(w, self.TYPED)
        if name != part("help"):  # it has shown the keys already, and one more press hides them
            self.type_all(w, self.TYPED_ALWAYS[-1:])

    def test_digits_do_not_go_into_a_field_that_the_mouse_has_left(self):
        with self.start(self.mesh) as w:
            w.x_focus()
            w.click(*w.pixel(self.CENTRE))
            radius = w.widget(part("radius"))["value"]
            self.click_widget(w, part("radius"))
            self.hover(w)
            self.x_key(w, "t", "x", "period", "2", "Return")
            self.assertEqual(self.steps_of(w)[0]["handles"][0]["translation"], [0.2, 0, 0])
            self.assertEqual(w.widget(part("radius"))["value"], radius)
            w.x_focus()
            self.click_widget(w, part("radius"))
            self.x_key(w, "ctrl+a", "3", "Escape")  # typed, and given up
            self.assertEqual(w.tool(), (TOOL, False))
            self.assertEqual(w.widget(part("radius"))["value"], radius)

    def test_keys_are_shown_by_their_key_and_button(self):
        with self.start(self.mesh) as w:
            w.x_focus()
            self.hover(w)
            for how in ("question", F1):
                self.x_key(w, how)
                w.wait(lambda: self.message(w) == "keys", "the keys are not shown", 20)
                self.x_key(w, "Escape")
                w.wait(lambda: self.message(w) != "keys", "the keys stay", 20)
                self.assertEqual(w.tool(), (TOOL, False))
            w.press_button(part("help"))
            self.assertEqual(self.message(w), "keys")
            self.hover(w)
            w.x("click", 1)
            self.settle(w)
            self.assertNotEqual(self.message(w), "keys")

    def test_vertex_under_the_cursor_is_named(self):
        with self.start(self.mesh) as w:
            w.x_focus()
            self.hover(w)
            w.wait_message(rf"Vertex {self.CENTRE} at ")
            position = re.search(r"Vertex \d+ at (.*)", "\n".join(w.on_screen()))[1]
            for a, b in zip(map(float, position.split(",")), self.points[self.CENTRE]):
                self.assertAlmostEqual(a, b, places=5)

    def test_history_goes_back_and_forward_by_clicks(self):
        with self.start(self.mesh) as w:
            w.x_focus()
            states = [w.dump()]
            w.click(*w.pixel(self.CENTRE))
            self.pull(w, self.CENTRE, (30, 20))
            states.append(w.dump())
            w.drag(w.pixel(self.CENTRE + 6), w.pixel(self.CENTRE + 12), modifiers=["ctrl"])
            states.append(w.dump())
            self.pull(w, self.CENTRE, (10, 20))
            states.append(w.dump())
            w.press_button(part("group_last_step"))
            rows = w.widget(part("timeline"))["rows"]
            self.assertEqual([row.split()[0] for row in rows], ["Start", "Moving", "Paint:", "Moving"])
            for row in (1, 3, 0, 2):
                x, y, width, height = w.widget(part("timeline"))["row_rectangles"][row]
                w.x("mousemove", x + width // 2, y + height // 2, "sleep", 0.05, "click", 1)
                w.wait(lambda: not w.dump().moved(states[row]), "the click did not go there", 20)
                self.assertEqual(w.widget(part("timeline"))["currentRow"], row)
                self.assertEqual(w.widget(part("timeline"))["rows"], rows)
            self.hover(w)
            self.x_key(w, "ctrl+z")  # the keys are the picture's, and the stroke the last
            self.assertEqual(w.widget(part("timeline"))["currentRow"], 1)


class Line(ToolTest):
    def press_line(self, w):
        """The line is in the middle of the upper edge."""
        w.click(w.ask("project")["width"] / 2, 20)

    def test_bad_shape_is_warned_of_and_shown(self):
        with self.start(self.mesh, disc=20) as w:
            pixel = self.pull(w, self.CENTRE, (150, -250), release=False)
            w.wait_message("folded over|times as long")
            w.release(*pixel)
            self.assertRegex(self.message(w), "Click here to see where")
            before = w.dump()
            self.press_line(w)
            self.assertEqual(w.widget(part("colours"))["currentText"], "Region")
            w.idle()
            x, y = w.pixel(self.CENTRE)
            self.assertIn(b"\xff\x00\x00", self.picture(w, x, y, half=150), "no folded triangle is red")
            self.assert_same(before, w.dump())
            self.assertNotRegex(self.message(w), "Click here")
            self.assertEqual(len(self.steps_in_log(w)), 1)
            w.key("Z", modifiers=["ctrl"])
            self.assertNotRegex(self.message(w), "folded|times as long")
            self.assertNotIn(b"\xff\x00\x00", self.picture(w, *w.pixel(self.CENTRE), half=150))


class Layers(ToolTest):
    def test_covered_surface_is_not_edited(self):
        cover = write_ply(self.folder / "cover.ply", *moved((self.points, self.faces), offset=(0, 0, 0.6)))
        with self.start(self.mesh, cover) as w:
            w.layer(0, current=True)
            before = w.dump(0)
            x, y = w.pixel(self.CENTRE, layer=0)
            w.layer(1, visible=False)
            w.move(x, y)
            w.wait_message("Vertex [0-9]+ at")
            w.layer(1, visible=True)
            w.move(x + 1, y)
            self.assertNotRegex(self.message(w), "Vertex")  # which the other layer hides
            w.drag((x, y), (x + 30, y - 20))
            self.assert_same(before, w.dump(0))
            self.assertEqual(self.steps_in_log(w), [])
            w.trigger("Front")
            w.click(*w.pixel(self.CENTRE, layer=0))
            self.assertRegex(self.message(w), "Another layer covers the surface")
            w.layer(1, visible=False)
            self.pull(w, self.CENTRE, (20, -20))
            self.assertEqual(len(self.steps_in_log(w)), 1)


class Colours(ToolTest):
    def test_tint_is_hidden_by_a_key_and_with_no_colours(self):
        with self.start(self.mesh, disc=20) as w:
            x, y = w.pixel(self.CENTRE)
            w.click(x, y)
            w.move(3, 300)
            tinted = self.picture(w, x, y, half=20)
            w.key("H")
            plain = self.picture(w, x, y, half=20)
            self.assert_other_picture(tinted, plain, 400)
            w.key("H")
            self.assertEqual(self.picture(w, x, y, half=20), tinted)
            w.set(part("colours"), "None")
            self.assertEqual(self.picture(w, x, y, half=20), plain)


class Keys(ToolTest):
    def test_table_of_keys_is_above_meshlabs_lines(self):
        with self.open(self.mesh) as w:
            w.resize(1280, 800)
            w.trigger(TOOL)
            w.press_button(part("help"))
            _, size, _, colours = w.grab(self.folder / "screen.ppm").read_bytes().split(b"\n", 3)
            width = int(size.split()[0])
            left, top = w.view_corner()
            view = w.ask("project")
            rows = set()
            for y in range(view["height"]):
                begin = 3 * ((top + y) * width + left)
                row = colours[begin:begin + 3 * view["width"]]
                if any(r > 200 and g > 180 and b < 110 for r, g, b in zip(row[::3], row[1::3], row[2::3])):
                    rows.add(y)
            lines = [y for y in rows if y - 1 not in rows]
            self.assertGreater(len(lines), 25)
            self.assertLess(max(rows), view["height"] - 90)


class Snap(ToolTest):
    def test_handle_goes_to_the_surface_of_another_layer(self):
        points, faces = moved((self.points, self.faces), offset=(1.3, 0, 0.4))
        aside = write_ply(self.folder / "aside.ply", points, faces)
        with self.start(self.mesh, aside) as w:
            w.layer(0, current=True)
            w.set(part("snap"), 1)
            to = w.pixel(self.CENTRE - 3 * self.ROWS, layer=1)
            start = w.pixel(self.CENTRE, layer=0)
            w.layer(1, visible=False)
            w.drag(start, to, release=False)
            self.assertNotRegex(self.message(w), "snapped")
            w.key("Backspace")
            w.mouse("release", *to)
            w.layer(1, visible=True)
            w.drag(start, to, release=False)
            self.assertRegex(self.message(w), "snapped")
            w.release(*to)
            for there, wanted in zip(w.dump(0).triples()[self.CENTRE], points[self.CENTRE - 3 * self.ROWS]):
                self.assertAlmostEqual(there, wanted, delta=0.01)
            self.assert_replay_is_the_same(w, self.mesh)


if __name__ == "__main__":
    unittest.main()
