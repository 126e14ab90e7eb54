# SPDX-License-Identifier: GPL-3.0-or-later
"""The test driver itself, on what MeshLab can do without our tool: what the other tests rest on."""
import struct
import unittest

from gui import GuiTest
from ply import bits_of, write_ply
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
        rotated = [0, -2, 0, 5, 2, 0, 0, -3, 0, 0, 2, 7, 0, 0, 0, 1]
        with self.open(self.mesh) as w:
            w.resize(1100, 800)
            for prepare in ("Front", "Toggle Orthographic Camera", "Horizontal +", "Axial +",
                            "Toggle Orthographic Camera"):
                w.trigger(prepare)
                if prepare == "Axial +":
                    w.layer(matrix=rotated)
                    w.trigger("Reset Trackball")
                with self.subTest(prepare):
                    # The host's own tool selects what is drawn in a rectangle.
                    w.trigger("Select Vertices")
                    for vertex in (220, 45, 391):
                        x, y = w.pixel(vertex)
                        w.drag((x - 3, y - 3), (x + 3, y + 3), steps=2)
                        self.assertEqual(self.selected(w), [vertex])
                    w.trigger("Select Vertices")

    def test_a_crash_is_noticed(self):
        with self.assertRaisesRegex(AssertionError, "ended with -11"):
            with self.open(self.mesh) as w:
                w.process.send_signal(11)
                w.process.wait()
                w.layers()

    def test_what_cannot_be_done_is_reported(self):
        with self.assertRaisesRegex(AssertionError, "no such action"):
            with self.open(self.mesh) as w:
                w.trigger("Make Coffee")


if __name__ == "__main__":
    unittest.main()
