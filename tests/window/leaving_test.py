# SPDX-License-Identifier: GPL-3.0-or-later
"""Navigating, layers, all ways to leave the tool, and meshes with nothing to edit."""
import contextlib
import json
import unittest

from tool import PANEL, TOOL, ToolTest, part
from ply import write_ply
from shapes import dome, moved


class LeavingTest(ToolTest):
    def assert_nothing_can_be_chosen(self, w):
        for name in ("load", "brush_target", "mode"):
            widget = w.widget(part(name))
            self.assertFalse(widget["visible"] and widget["enabled"], name)

    def poke(self, w):
        """All kinds of events."""
        w.click(300, 300)
        w.drag((200, 300), (350, 320))
        w.wheel(300, 300, 1)
        w.key("R", "X", "Return", "Backspace", "G", "C", "W")
        w.key("Z", modifiers=["ctrl"])
        self.assertEqual(w.dialog(), {})


class Navigate(ToolTest):
    def test_camera_moves_and_the_mesh_does_not(self):
        with self.start(self.mesh) as w:
            self.pull(w, self.CENTRE, (20, -20))
            before = w.dump()
            for start, button, modifiers in (((300, 300), "middle", []), ((300, 300), "right", []), ((300, 300), "left", ["alt"]),
                                             ((3, 300), "left", [])):  # off the mesh
                camera = w.camera()
                w.drag(start, (start[0] + 80, start[1] + 40), button=button, modifiers=modifiers)
                self.assertNotEqual(w.camera(), camera, button)
                self.assertEqual(w.tool(), (TOOL, False))
                self.assert_same(before, w.dump())
            self.assert_at(w, self.CENTRE, self.pull(w, self.CENTRE, (15, -25)))
            self.assertEqual(len(self.steps_in_log(w)), 2)
            self.assert_replay_is_the_same(w, self.mesh)

    def test_suspended_tool_leaves_the_mouse_to_the_camera(self):
        with self.start(self.mesh) as w:
            before, camera = w.dump(), w.camera()
            w.trigger("Not editing")
            self.assertEqual(w.tool(), (TOOL, True))
            self.pull(w, self.CENTRE, (30, 30))
            self.assertNotEqual(w.camera(), camera)
            self.assert_same(before, w.dump())
            w.trigger("Not editing")
            self.pull(w, self.CENTRE, (30, 30))
            self.assertEqual(len(self.steps_in_log(w)), 1)

    def test_layer_hidden_during_a_drag(self):
        with self.start(self.mesh) as w:
            before = w.dump()
            x, y = self.pull(w, self.CENTRE, (30, 30), release=False)
            w.layer(visible=False)
            w.release(x, y)
            w.layer(visible=True)
            w.move(x - 40, y)
            self.assert_same(before, w.dump())
            self.assertEqual(self.steps_in_log(w), [])


class Layers(ToolTest):
    ROTATED = [0, -2, 0, 5, 2, 0, 0, -3, 0, 0, 2, 7, 0, 0, 0, 1]

    def test_layer_with_a_transform(self):
        with self.start(self.mesh) as w:
            w.layer(matrix=self.ROTATED)
            w.trigger("Reset Trackball")
            self.assert_at(w, self.CENTRE, self.pull(w, self.CENTRE, (45, -35)))
            self.assertEqual(w.layers()[0]["matrix"], self.ROTATED)
            self.assertEqual(self.steps_of(w)[0]["handles"][0]["vertices"], str(self.CENTRE))
            w.key("T", "X", *"0.25", "Return")
            self.assertEqual(self.steps_of(w)[1]["handles"][0]["translation"], [0.25, 0, 0])
            self.assert_replay_is_the_same(w, self.mesh)

    def test_only_the_current_layer_is_picked_and_each_keeps_its_steps(self):
        behind = write_ply(self.folder / "behind.ply", *moved((self.points, self.faces), offset=(0, 0, -0.3)))
        with self.start(self.mesh, behind) as w:
            results = {layer: w.dump(layer) for layer in (0, 1)}
            for layer in (1, 0, 1):
                w.layer(layer, current=True)
                w.layer(0, visible=layer == 0)  # it covers the other one
                self.assertEqual(w.tool(), (TOOL, False))
                self.assertNotRegex(self.message(w), "another tool")
                x, y = w.pixel(self.CENTRE, layer=layer)
                w.drag((x, y), (x + 30, y - 20))
                self.assertIn(self.CENTRE, results[layer].moved(w.dump(layer)))
                for other, dump in results.items():
                    if other != layer:
                        self.assert_same(dump, w.dump(other))
                results[layer] = w.dump(layer)
                if layer == 0:
                    self.assert_replay_is_the_same(w, self.mesh)
            self.assertEqual(len(self.steps_in_log(w)), 3)


class Leave(LeavingTest):
    """What was applied stays, a drag in progress is dropped."""

    def check(self, leave, tool_then=""):
        with self.start(self.mesh) as w:
            self.pull(w, self.CENTRE, (20, -20))
            applied = w.dump()
            self.pull(w, self.CENTRE + 3, (30, 30), release=False)
            self.assertNotEqual(applied.moved(w.dump()), set())
            leave(w)
            self.assertEqual(w.tool()[0], tool_then)
            self.assert_same(applied, w.dump())
            # The mouse button is still down.
            w.mouse("move", 300, 310)
            w.release(300, 320)
            self.assert_same(applied, w.dump())

    def test_by_closing_the_panel(self):
        self.check(lambda w: w.close_widget(PANEL))

    def test_by_menu_and_back_at_once(self):
        def leave(w):
            w.trigger(TOOL)
            self.assertEqual(w.tool()[0], "")
            w.trigger(TOOL)
        self.check(leave, TOOL)

    ROWS_OF_LARGE = 181  # takes part of a second to prepare, longer than a batch and than the tool waits

    @contextlib.contextmanager
    def released(self, *then):
        """A window where a drag on a large mesh is released and the tool left at once, without a pause before `then`."""
        rows = self.ROWS_OF_LARGE
        mesh = write_ply(self.folder / "large.ply", *dome(rows, rows))
        with self.start(mesh) as w:
            w.set(part("radius"), 1.3)
            before = w.dump()
            x, y = w.pixel(rows * rows // 2)
            mouse = [{"command": "mouse", "button": "left", "modifiers": [], "type": kind, "x": x + right, "y": y + down}
                     for kind, right, down in (("press", 0, 0), ("move", 20, 0), ("move", 40, -30), ("release", 40, -30))]
            w.batch([*mouse, {"command": "trigger", "text": TOOL}, {"command": "print", "text": "left"}, *then])
            yield w, before, mesh

    def wait_for_step(self, w):
        w.wait(lambda: self.steps_in_log(w), "the released drag is not applied", 60)
        self.assertEqual(len(self.steps_in_log(w)), 1)
        step = next(k for k, line in enumerate(w.output) if "step 1" in line)
        self.assertLess(w.output.index("left"), step, "leaving has waited")

    def test_released_drag_is_applied_after_the_tool_was_left(self):
        with self.released() as (w, before, _):
            self.wait_for_step(w)
            self.assertEqual(w.tool()[0], "")
            self.assertIn(self.ROWS_OF_LARGE**2 // 2, before.moved(w.dump()))

    def test_released_drag_is_applied_after_the_tool_was_left_and_started_again(self):
        with self.released({"command": "trigger", "text": TOOL}) as (w, before, mesh):
            self.wait_for_step(w)
            w.idle()
            self.assertEqual(w.tool(), (TOOL, False))
            self.assert_replay_is_the_same(w, mesh)
            w.press_button(part("undo"))
            self.assert_same(before, w.dump())

    def test_layer_is_deleted_or_meshlab_quits_before_a_released_drag_is_solved(self):
        with self.released() as (w, _, _):
            w.layer(remove=True)
            self.assertEqual(w.layers(), [])
        with self.released() as (w, _, _):
            w.quit()

    def test_layer_without_a_step_keeps_no_thread(self):
        def left(w, layer):
            w.layer(layer, current=True)
            w.trigger(TOOL)
            w.click(*w.pixel(self.CENTRE))
            w.trigger(TOOL)
            return w.threads()

        with self.open(*[self.mesh] * 3) as w:
            w.trigger("Front")
            first = left(w, 0)  # other threads of the process may have begun with the tool
            for layer in (1, 2):
                left(w, layer)
                w.wait(lambda: w.threads() <= first, f"layer {layer} keeps threads", 20)

    def test_dialog_outlives_the_layer(self):
        with self.start(self.mesh, self.mesh) as w:
            w.layer(0, current=True)
            self.pull(w, self.CENTRE, (20, -20))
            edit = self.saved_edit(w)
            for name in ("save", "load"):
                w.press_button(part(name), wait=False)
                w.wait_dialog()
                w.layer(remove=True)
                w.answer(path=self.folder / "outlived.json" if name == "save" else edit)
            self.assertEqual((self.folder / "outlived.json").read_text(), edit.read_text())

    def test_by_a_filter_that_changes_positions(self):
        with self.start(self.mesh) as w:
            self.pull(w, self.CENTRE, (20, -20))
            applied = w.dump().point_bits()
            self.pull(w, self.CENTRE + 3, (30, 30), release=False)
            w.run_filter("Laplacian Smooth")
            self.assertEqual(w.tool()[0], "")
            filtered = w.dump()
            self.assertNotEqual(applied, filtered.point_bits())
            w.trigger(TOOL)
            self.assertFalse(self.enabled(w, "undo"))
            self.pull(w, self.CENTRE, (20, -20))
            w.press_button(part("undo"))
            self.assert_same(filtered, w.dump())

    def test_by_what_keeps_positions_and_faces(self):
        """Steps can still be undone."""
        with self.open(self.mesh) as w:  # with flat shading, for which MeshLab normalises normals
            w.resize(1280, 900)
            w.trigger("Front")
            w.trigger(TOOL)
            w.set(part("gizmo"), 0)
            states = [w.dump().point_bits()]
            names = [name for name in ("Compute Geometric Measures", "Duplicate Current layer", "Select Faces by view angle",
                                       "Invert Selection", "Per Vertex Color Function", "Discrete Curvatures", "Rename Current Mesh",
                                       "Change Visibility of layer(s)") if w.action(name)]  # other versions have other names
            self.assertIn("Invert Selection", names)
            for name in names:
                self.pull(w, self.CENTRE, (12, -8))
                states.append(w.dump(0).point_bits())
                w.run_filter(name)
                self.assertEqual(w.tool()[0], "")
                w.layer(0, current=True, visible=True)
                for layer in w.layers()[1:]:
                    w.layer(layer["id"], remove=True)
                w.trigger(TOOL)
                self.assertEqual(w.tool(), (TOOL, False))
                self.assertTrue(self.enabled(w, "undo"), name)
            w.layer(0, smooth=True, matrix=Layers.ROTATED)
            for before in reversed(states[:-1]):
                w.key("Z", modifiers=["ctrl"])
                self.assertEqual(w.dump(0).point_bits(), before)
            w.key("Z", modifiers=["ctrl", "shift"])
            self.assert_replay_is_the_same(w, self.mesh)

    def test_by_a_filter_that_changes_normals(self):
        """A step before it is undone, and so has no part in what later steps restore."""
        with self.start(self.mesh) as w:
            before = w.dump()
            self.pull(w, self.CENTRE, (20, -20))
            w.press_button(part("undo"))
            self.assert_same(before, w.dump())
            w.run_filter("Re-Compute Vertex Normals")
            filtered = w.dump()
            self.assertIn("normals", before.differences(filtered))
            w.trigger(TOOL)
            self.assertTrue(self.enabled(w, "redo"))
            self.pull(w, self.CENTRE, (12, -8))
            w.press_button(part("undo"))
            self.assert_same(filtered, w.dump())

    def test_steps_before_a_filter_are_saved_and_fixed_vertices_stay(self):
        with self.start(self.mesh) as w:
            w.set(part("brush_target"), "Fixed")
            x, y = w.pixel(self.CENTRE + 4)
            w.click(x, y)
            w.set(part("brush_target"), 0)
            for by in ((20, -20), (-10, 25)):
                self.pull(w, self.CENTRE, by)
            saved = self.saved_edit(w).read_text()
            held = json.loads(saved)["steps"][1]["region"]["held"]
            w.run_filter("Laplacian Smooth")
            w.trigger(TOOL)
            self.assertRegex(self.message(w), "2 steps cannot be undone")
            self.assertEqual(self.saved_edit(w, "later.json").read_text(), saved)
            smoothed = write_ply(self.folder / "smoothed.ply", w.dump().triples(), self.faces)
            self.pull(w, self.CENTRE, (20, -20))
            (step,) = self.steps_of(w)
            self.assertEqual(step["region"]["held"], held)
            self.assert_replay_is_the_same(w, smoothed)

    def test_by_changing_the_layer(self):
        with self.start(self.mesh, self.mesh) as w:
            w.layer(0, current=True)
            before = w.dump(0), w.dump(1)
            pixel = self.pull(w, self.CENTRE, (30, 30), release=False)
            w.layer(1, current=True)
            w.release(*pixel)
            self.assert_same(before[0], w.dump(0))
            self.assert_same(before[1], w.dump(1))

    def test_by_deleting_the_layer_under_the_tool(self):
        for files in ((self.mesh, self.mesh), (self.mesh,)):
            with self.start(*files) as w:
                self.pull(w, self.CENTRE, (30, 30), release=False)
                w.layer(remove=True)
                self.assertEqual(len(w.layers()), len(files) - 1)
                if len(files) == 1:
                    self.assert_nothing_can_be_chosen(w)
                w.move(310, 310)
                w.mouse("release", 310, 310)
                self.poke(w)

    def test_by_closing_the_project(self):
        with self.start(self.mesh) as w:
            self.pull(w, self.CENTRE, (30, 30), release=False)
            w.trigger("Close Project", wait=False)
            w.answer(button="Yes")
            w.trigger("New Empty Project...")
            self.assertEqual(w.tool()[0], "")

    def test_by_quitting(self):
        with self.start(self.mesh) as w:
            self.pull(w, self.CENTRE, (30, 30), release=False)
            w.quit()
        with self.start(self.mesh) as w:
            # While a region is being prepared.
            w.mouse("press", *w.pixel(self.CENTRE))
            w.quit()

    def test_mesh_imported_under_the_tool(self):
        other = write_ply(self.folder / "other.ply", *moved((self.points, self.faces), offset=(0.3, 0.2, 0.1)))
        with self.start(self.mesh) as w:
            before = w.dump(0)
            self.pull(w, self.CENTRE, (30, 30), release=False)
            w.trigger("Import Mesh...", wait=False)
            w.answer(path=other)
            w.wait(lambda: self.enabled(w, "content"), "the panel stays grey", 20)
            w.release(320, 300)
            self.assertEqual(w.tool(), (TOOL, False))
            self.assert_same(before, w.dump(0))
            self.assertNotRegex(self.message(w), "no vertices|reading")
            self.pull(w, self.CENTRE, (20, -20))
            self.assertEqual(len(self.steps_in_log(w)), 1)
            self.assert_replay_is_the_same(w, other)

    def test_mesh_reloaded_between_drags(self):
        with self.start(self.mesh) as w:
            before = w.dump()
            self.pull(w, self.CENTRE, (30, 30))
            w.trigger("Reload", wait=False)
            w.wait(lambda: not self.enabled(w, "undo"), "the old step can still be undone", 20)
            w.idle()
            self.assertEqual(before.point_bits(), w.dump().point_bits())
            self.assertFalse(self.enabled(w, "grow"))  # no region of the old mesh is left
            self.assertRegex(self.message(w), "changed by another")
            self.pull(w, self.CENTRE, (20, -20))
            self.assert_replay_is_the_same(w, self.mesh)

    def test_mesh_reloaded_with_a_step_undone(self):
        """The file differs from the session's mesh elsewhere only, where a step is that cannot be undone any more."""
        far = 6 * self.ROWS + 6
        with self.start(self.mesh) as w:
            before = w.dump()
            block = {row * self.ROWS + column for row in range(17, 24) for column in range(17, 24)}
            w.layer(selected_faces=[f for f, corners in enumerate(self.faces) if block.issuperset(corners)])
            w.run_filter("Laplacian Smooth")
            self.assertIn(len(before.moved(w.dump())), range(1, 100))
            w.trigger(TOOL)
            self.pull(w, far, (10, -10))
            self.assertEqual(len(self.steps_in_log(w)), 1)
            w.set(part("undo"), True)
            w.trigger("Reload", wait=False)
            w.batch([{"command": "set", "name": part("redo"), "value": True}])  # disabled, if a picture came first
            w.idle()
            self.assertEqual(before.point_bits(), w.dump().point_bits())
            self.assertFalse(self.enabled(w, "redo"))

    def test_mesh_reloaded_under_the_tool(self):
        with self.start(self.mesh) as w:
            before = w.dump()
            self.pull(w, self.CENTRE, (30, 30), release=False)
            w.trigger("Reload", wait=False)
            w.idle()
            w.move(320, 300)
            w.release(320, 300)
            self.assertEqual(before.point_bits(), w.dump().point_bits())
            self.assert_finite(w.dump())


class Views(ToolTest):
    """Panel and sessions are the window's, whichever view is used."""

    @contextlib.contextmanager
    def split(self, *files):
        """A window with two views, the tool on in the first, and the first one current."""
        with self.start(*files) as w:
            w.trigger("Vertically")
            w.view(index=1)
            self.shade_smoothly(w)  # each view shades in its own way
            self.assertEqual(w.view(index=0), (2, 0))
            self.assertEqual(w.tool(), (TOOL, False))
            yield w

    def assert_same_but_normals(self, before, after):
        """Another view, when it is opened, has the host normalise normals that the session has seen before."""
        self.assertLessEqual(set(before.differences(after)), {"normals", "face_normals"})

    def panels(self, w):
        return [p for p in w.widgets(PANEL).values() if p["visible"]]

    def test_second_view_takes_the_session_over(self):
        with self.split(self.mesh) as w:
            states = [w.dump()]
            for by in ((40, -30), (-10, 25)):
                self.pull(w, self.CENTRE, by)
                states.append(w.dump())
            w.click(*w.pixel(self.CENTRE))
            self.pull(w, self.CENTRE, (30, 30), release=False)
            w.view(index=1)
            self.assertEqual(w.tool()[0], "")
            w.trigger(TOOL)
            self.assertEqual(w.tool(), (TOOL, False))
            self.assert_same(states[2], w.dump())
            self.assertEqual(len(self.panels(w)), 1)
            w.view(index=0)
            self.assertEqual(w.tool()[0], "")
            w.view(index=1)
            w.press_button(part("undo"))
            self.assert_same(states[1], w.dump())
            self.assert_at(w, self.CENTRE, self.pull(w, self.CENTRE, (-20, -10)))
            w.key("Z", "Z", modifiers=["ctrl"])
            self.assert_same_but_normals(states[0], w.dump())
            w.key("Z", "Z", modifiers=["ctrl", "shift"])
            self.assert_replay_is_the_same(w, self.mesh)
            w.trigger(TOOL)
            self.assertEqual(self.panels(w), [])

    def test_view_is_closed_under_the_tool(self):
        with self.split(self.mesh) as w:
            self.pull(w, self.CENTRE, (40, -30))
            applied = w.dump()
            self.pull(w, self.CENTRE, (30, 30), release=False)
            w.trigger("Close current view")
            self.assertEqual(w.view(), (1, 0))
            self.assert_same(applied, w.dump())
            self.assertEqual(self.panels(w), [])
            w.mouse("release", 300, 300)
            w.trigger(TOOL)
            w.press_button(part("undo"))
            self.assertEqual(len(self.steps_in_log(w)), 1)
            self.assert_at(w, self.CENTRE, self.pull(w, self.CENTRE, (20, 20)))

    def test_panel_is_hidden_while_another_project_is_in_front(self):
        with self.start(self.mesh) as w:
            before = w.dump()
            self.pull(w, self.CENTRE, (40, -30))
            w.trigger("New Empty Project...")
            self.assertEqual(self.panels(w), [])
            w.view(project=0)
            self.assertEqual(len(self.panels(w)), 1)
            self.assertEqual(w.tool(), (TOOL, False))
            w.press_button(part("undo"))
            self.assert_same(before, w.dump())

    def test_two_projects_with_the_same_layer_number(self):
        with self.start(self.mesh) as w:
            before = w.dump()
            self.pull(w, self.CENTRE, (40, -30))
            first = w.dump()
            w.trigger("New Empty Project...")
            w.trigger("Import Mesh...", wait=False)
            w.answer(path=self.mesh)
            w.trigger("Front")
            self.shade_smoothly(w)
            w.trigger(TOOL)
            self.assertEqual(len(self.panels(w)), 1)
            self.assertFalse(self.enabled(w, "undo"))
            self.pull(w, self.CENTRE, (-20, 10))
            second = w.dump()
            w.view(project=0)
            self.assertEqual(w.tool()[0], "")
            self.assert_same(first, w.dump())
            w.trigger(TOOL)
            w.press_button(part("undo"))
            self.assert_same(before, w.dump())
            w.view(project=1)
            self.assert_same(second, w.dump())
            w.trigger("Close Project", wait=False)
            w.answer(button="Yes")
            w.view(project=0)
            if w.tool()[0] == "":
                w.trigger(TOOL)
            w.press_button(part("redo"))
            self.assert_same(first, w.dump())


class NothingToEdit(LeavingTest):
    """One clear line, and nothing else."""

    def log_of(self, w):
        """What the tool logs when it is started and poked."""
        lines = len(self.log_of_tool(w))
        w.trigger(TOOL)
        self.poke(w)
        return self.log_of_tool(w)[lines:]

    def test_point_cloud(self):
        cloud = write_ply(self.folder / "cloud.ply", self.points, [])
        with self.open(cloud) as w:
            before = w.dump()
            (line,) = self.log_of(w)
            self.assertRegex(line, "faces")
            self.assertRegex(self.message(w), "faces")
            self.assertEqual(w.tool(), (TOOL, False))
            self.assert_nothing_can_be_chosen(w)
            self.assert_same(before, w.dump())

    def test_empty_layer(self):
        with self.open(self.mesh) as w:
            w.run_filter("Select All")
            w.run_filter("Delete Selected Vertices")
            self.assertEqual(w.layers()[0]["vertices"], 0)
            self.assertEqual(len(self.log_of(w)), 1)

    def test_no_mesh(self):
        with self.open() as w:
            if not w.action(TOOL)["enabled"]:
                return  # as newer versions of MeshLab have it
            w.trigger(TOOL)
            tips = [t["text"] for t in w.ask("widgets", prefix="qtooltip_label")["widgets"] if t["visible"]]
            self.assertEqual(tips, ["There is no mesh: open one first."])
            self.assertLessEqual(len(self.log_of(w)), 1)

    def test_hidden_layer(self):
        with self.open(self.mesh) as w:
            w.layer(visible=False)
            before = w.dump()
            self.log_of(w)
            self.assertRegex(self.message(w), "hidden|not visible|invisible")
            self.assert_same(before, w.dump())
            w.layer(visible=True)
            self.assert_at(w, self.CENTRE, self.pull(w, self.CENTRE, (30, 30)))


if __name__ == "__main__":
    unittest.main()
