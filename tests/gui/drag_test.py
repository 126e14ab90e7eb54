# SPDX-License-Identifier: GPL-3.0-or-later
"""From opening to quitting with a real mouse and keyboard: X events by xdotool. The driver only tells pixels, turns the
view, and answers the file dialog of the saved edit."""
import json
import math
import os
import pathlib
import unittest

from gui import GuiTest
from host import replay
from ply import Ply
from shapes import neighbours, within
from tool import TOOL, part

MESHES = pathlib.Path(os.environ["LAPEDIT_MESHES"])
NOSE = 8624  # tip


def numbers_of(text):
    """The vertices of a list such as 3-5,8."""
    ends = [[int(number) for number in part.split("-")] for part in text.split(",")]
    return {v for end in ends for v in range(end[0], end[-1] + 1)}


class Drag(GuiTest):
    def test_open_click_the_nose_drag_save_quit(self):
        # A PLY keeps all digits.
        original, _ = self.edited([], MESHES / "mannequin.off")
        mesh = self.folder / "mannequin.ply"
        mesh.write_bytes(original.read_bytes())
        edit = self.folder / "edit.json"
        with self.open(mesh) as w:
            w.resize(1280, 900)
            w.trigger("Front (Z is up)")
            w.x_focus()
            w.x("key", "ctrl+alt+l")
            w.wait_output("Started Mode " + TOOL)
            w.idle()
            left, top = w.view_corner()
            x, y = w.pixel(NOSE)
            press = round(x + left), round(y + top)
            release = press[0] + 35, press[1] + 60
            w.x_drag(press, release)
            w.wait_output("Laplacian Drag: step 1: ")
            w.idle()
            nose = w.pixel(NOSE)
            self.assertLess(math.dist((nose[0] + left, nose[1] + top), release), 1.5)
            self.assertLess(math.dist(nose, (x + 35, y + 60)), 1)
            shown = w.dump().point_bits()

            w.press_button(part("save"), wait=False)
            w.answer(path=edit)
            w.x_focus()
            w.x("key", "ctrl+e")
            w.wait_dialog()
            w.x("sleep", 0.3, "key", "Return")
            w.wait_output("Saved Mesh")
            w.x_focus()
            w.x("key", "ctrl+q")
            w.wait_end()

        before, saved = Ply(original), Ply(mesh)
        self.assertEqual(saved.point_bits(), shown)
        self.assertEqual(saved.faces(), before.faces())
        points = before.points()
        moved = {v for v, (a, b) in enumerate(zip(before.point_bits(), saved.point_bits())) if a != b}
        self.assertIn(NOSE, moved)
        step = self.only_step(edit)
        # A disc of a fifth of the radius, from whose centre the region counts.
        edges = neighbours(len(points), before.faces())
        radius = 0.15 * math.dist([min(p[k] for p in points) for k in range(3)],
                                  [max(p[k] for p in points) for k in range(3)])
        disc = numbers_of(step["handles"][0]["vertices"])
        self.assertEqual(disc, within(points, edges, NOSE, 0.2 * radius))
        self.assertGreaterEqual(step["region"]["radius"], 0.8 * radius)
        region = within(points, edges, NOSE, radius)
        self.assertLessEqual(moved, region)
        self.assertGreater(len(moved), 0.8 * len(region))

        replayed, _ = self.edited([replay(str(edit))], original)
        self.assertEqual(Ply(replayed).point_bits(), saved.point_bits())

    def only_step(self, path):
        steps = json.loads(path.read_text())["steps"]
        self.assertEqual(len(steps), 1)
        return steps[0]


if __name__ == "__main__":
    unittest.main()
