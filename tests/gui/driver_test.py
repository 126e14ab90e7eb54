# SPDX-License-Identifier: GPL-3.0-or-later
"""The test driver itself, on what MeshLab can do without our tool: what the other tests rest on."""
import struct
import unittest

from gui import GuiTest
from ply import Ply, bits_of, write_ply
from shapes import dome

SELECTED = 0x20  # vcglib's flag


class Driver(GuiTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points, cls.faces = dome()
        cls.mesh = write_ply(cls.folder / "dome.ply", cls.points, cls.faces)

    def selected(self, window, what="vertex_flags"):
        flags = struct.iter_unpack("<i", window.dump()[what])
        return [v for v, (flag,) in enumerate(flags) if flag & SELECTED]

    def test_dump_has_all_bits(self):
        with self.open(self.mesh) as w:
            dump = w.dump()
            self.assertEqual(dump.point_bits(), [tuple(map(bits_of, p)) for p in self.points])
            self.assertEqual(dump.faces(), self.faces)
            self.assertEqual(dump.differences(w.dump()), [])
            w.layer(selected_faces=[7])
            self.assertEqual(self.selected(w, "face_flags"), [7])
            self.assertEqual(dump.differences(w.dump()), ["face_flags"])

    def test_pixels_are_where_meshlab_draws(self):
        turned = [0, -2, 0, 5, 2, 0, 0, -3, 0, 0, 2, 7, 0, 0, 0, 1]
        with self.open(self.mesh) as w:
            w.resize(1100, 800)
            for prepare in ("Front", "Toggle Orthographic Camera", "Horizontal +", "Axial +",
                            "Toggle Orthographic Camera"):
                w.trigger(prepare)
                if prepare == "Axial +":
                    w.layer(matrix=turned)
                    w.trigger("Reset Trackball")
                with self.subTest(prepare):
                    # The host's own tool selects what is drawn in a rectangle.
                    w.trigger("Select Vertices")
                    for vertex in (220, 45, 391):
                        x, y = w.pixel(vertex)
                        w.drag((x - 3, y - 3), (x + 3, y + 3), steps=2)
                        self.assertEqual(self.selected(w), [vertex])
                    w.trigger("Select Vertices")

    def test_mouse_of_both_kinds_turns_the_trackball(self):
        with self.open(self.mesh) as w:
            w.resize(1100, 800)
            camera = w.camera()
            w.drag((200, 200), (260, 250))
            turned = w.camera()
            self.assertNotEqual(turned, camera)
            left, top = w.view_corner()
            w.x_focus()
            w.x_drag((left + 200, top + 200), (left + 150, top + 260))
            w.idle()
            self.assertNotEqual(w.camera(), turned)
            w.wheel(200, 200, 2)
            self.assertEqual(w.tool(), ("", False))

    def test_filter_with_a_dialog_and_export(self):
        with self.open(self.mesh) as w:
            before = w.dump()
            w.run_filter("Laplacian Smooth")
            self.assertEqual([h["name"] for h in w.history()], ["Laplacian Smooth"])
            self.assertIn("Smoothed 441 vertices", w.log())
            self.assertGreater(len(before.moved(w.dump())), 400)
            out = self.folder / "out.ply"
            w.trigger("Export Mesh As...", wait=False)
            w.answer(path=out)
            w.answer()
            w.wait_output("Saved Mesh")
            self.assertEqual(Ply(out).point_bits(), w.dump().point_bits())

    def test_picture_shows_view_and_panels(self):
        with self.open(self.mesh) as w:
            picture = w.grab(self.folder / "window.ppm").read_bytes()
            header, size, _, pixels = picture.split(b"\n", 3)
            width, _ = map(int, size.split())
            self.assertEqual(header, b"P6")
            left, top = w.view_corner()

            def color(x, y):
                at = 3 * (width * round(top + y) + round(left + x))
                return tuple(pixels[at:at + 3])
            grey, background = color(*w.pixel(130)), color(5, 100)
            self.assertLess(max(grey) - min(grey), 8)
            self.assertGreater(background[2], background[0])
            self.assertGreater(min(color(w.ask("project")["width"] + 40, 300)), 200)

    def test_a_crash_is_noticed(self):
        with self.assertRaisesRegex(AssertionError, "ended with -11"):
            with self.open(self.mesh) as w:
                w.process.send_signal(11)
                w.process.wait()
                w.layers()

    def test_what_cannot_be_done_is_told(self):
        with self.assertRaisesRegex(AssertionError, "no such action"):
            with self.open(self.mesh) as w:
                w.trigger("Make Coffee")

    def test_closing_with_changes_is_answered(self):
        with self.open(self.mesh) as w:
            w.run_filter("Laplacian Smooth")
            w.quit()
            self.assertEqual(w.process.returncode, 0)


if __name__ == "__main__":
    unittest.main()
