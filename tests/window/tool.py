# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the tool Laplacian Drag share."""
import contextlib
import json
import math
import re

from gui import GuiTest
from host import replay
from ply import Ply, write_ply
from shapes import dome

TOOL = "Laplacian Drag"
PANEL = "laplacian_drag_panel"


def part(name):
    """objectName of a widget of the panel."""
    return "laplacian_drag_" + name


def numbers_of(text):
    """The vertices of a list such as 3-5,8, as the JSON has it."""
    ranges = [[int(end) for end in one.split("-")] for one in text.split(",") if one]
    return [number for ends in ranges for number in range(ends[0], ends[-1] + 1)]


class ToolTest(GuiTest):
    """Opens meshes with the tool active. The common mesh is a sheet of 41 x 41 vertices seen from above."""
    ROWS = 41
    CENTRE = 20 * ROWS + 20

    # Of Qt's cursors.
    ARROW, CROSS, SIZE_ALL, POINTING_HAND, BUSY, OPEN_HAND, CLOSED_HAND = 0, 2, 9, 13, 16, 17, 18

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points, cls.faces = dome(cls.ROWS, cls.ROWS)
        cls.mesh = write_ply(cls.folder / "sheet.ply", cls.points, cls.faces)

    @contextlib.contextmanager
    def start(self, *files, view="Front", disc=0, gizmo=False):
        """A window with the tool active, large, looking at the first mesh.
        @param disc  handle size in percent of the radius; 0: a press takes the vertex under the cursor alone
        @param gizmo  whether there is one, where presses may land"""
        with self.open(*files) as window:
            window.resize(1280, 900)
            window.trigger(view)
            self.shade_smoothly(window)
            window.trigger(TOOL)
            self.assertEqual(window.tool(), (TOOL, False))
            window.set(part("handle_fraction"), disc)
            window.set(part("gizmo"), int(gizmo))
            yield window

    def shade_smoothly(self, window):
        """Each time that MeshLab uploads a mesh for flat shading, it normalises the normals in the mesh itself, and
        their last bits change to and fro. Smooth shading leaves them alone: then all bits can be compared."""
        for layer in window.layers():
            window.layer(layer["id"], smooth=True)

    def pull(self, window, vertex, by, **options):
        """Drags a vertex. @return the pixel where it should be"""
        x, y = window.pixel(vertex)
        window.drag((x, y), (x + by[0], y + by[1]), **options)
        return x + by[0], y + by[1]

    def on_screen(self, window, vertex):
        """Its pixel on the screen, as xdotool takes it."""
        (left, top), (x, y) = window.view_corner(), window.pixel(vertex)
        return round(left + x), round(top + y)

    def hover(self, window, vertex=None):
        """Puts the mouse on a vertex, the one in the middle if none is given."""
        window.x("mousemove", *self.on_screen(window, self.CENTRE if vertex is None else vertex))
        self.settle(window)

    def x_click(self, window, vertex):
        """After a pause in which what is under the mouse is found."""
        window.x("mousemove", *self.on_screen(window, vertex), "sleep", 0.3, "click", 1)
        self.settle(window)

    def click_widget(self, window, name, right=40, repeat=1):
        """In its middle, but at most so many pixels from its left side."""
        x, y, width, height = window.widget(name)["rectangle"]
        window.x("mousemove", round(x + min(width // 2, right)), round(y + height // 2), "sleep", 0.05,
                 "click", "--repeat", repeat, "--delay", 60, 1)
        self.settle(window)

    def wait_closed(self, window):
        window.wait(lambda: not window.dialog().get("title"), "the dialog stays open", 20)

    def settle(self, window):
        """Until the window has what xdotool sent: X events come by another way than the driver's questions. The X server
        handles another program's request once it has handled those; idle() takes the events that it then has sent."""
        window.x("getmouselocation")
        window.idle()

    def x_key(self, window, *keys):
        for key in keys:
            window.x("key", key)
        self.settle(window)

    def enabled(self, window, name):
        return window.widget(part(name))["enabled"]

    def undo(self, window):
        window.x_focus()
        self.x_key(window, "ctrl+z")

    def log_of_tool(self, window):
        return [line.removeprefix(TOOL + ": ") for line in window.log() if line.startswith(TOOL + ": ")]

    def steps_in_log(self, window):
        """One match per applied step: handle size and region size."""
        lines = [re.match(r"step (\d+): .*handle of (\d+) vert.*, region of (\d+) vertices(?:; .*)?$", line)
                 for line in self.log_of_tool(window)]
        return [{"step": int(m[1]), "handle": int(m[2]), "region": int(m[3])} for m in lines if m]

    def saved_edit(self, window, name="edit.json"):
        """Presses the panel's button. @return path of the file"""
        path = self.folder / name
        path.unlink(missing_ok=True)
        window.press_button(part("save"), wait=False)
        window.answer(path=path)
        self.assertTrue(path.exists(), window.text())
        return path

    def steps_of(self, window):
        """The steps applied so far, as the saved JSON has them."""
        return json.loads(self.saved_edit(window).read_text())["steps"]

    def assert_gives(self, edit, mesh, expected):
        """A filter on the mesh as it was, run without the window, gives the coordinates of a dump."""
        path, _ = self.edited([edit], mesh)
        self.assertEqual(Ply(path).point_bits(), expected.point_bits())

    def assert_replay_is_the_same(self, window, mesh):
        """The saved edit gives the coordinates of the window."""
        self.assert_gives(replay(str(self.saved_edit(window))), mesh, window.dump())

    def assert_at(self, window, vertex, pixel, within=1.0):
        self.assertLess(math.dist(window.pixel(vertex), pixel), within)

    def assert_other_picture(self, before, after, pixels=100):
        """More than some pixels differ."""
        self.assertGreater(sum(a != b for a, b in zip(before, after)), pixels)

    def assert_same(self, before, after):
        """All of a layer, to the bit."""
        self.assertEqual(before.differences(after), [])

    def assert_finite(self, dump):
        for name in ("positions", "normals", "face_normals"):
            self.assertTrue(all(math.isfinite(c) for p in dump.triples(name) for c in p), name)

    def picture(self, window, x, y, half=80):
        """Colours on the screen around a pixel of the view, row by row."""
        left, top = (round(corner + c) - half for corner, c in zip(window.view_corner(), (x, y)))
        _, size, _, colours = window.grab(self.folder / "screen.ppm").read_bytes().split(b"\n", 3)
        width = int(size.split()[0])
        return [colours[at:at + 3] for row in range(top, top + 2 * half)
                for at in range(3 * (row * width + left), 3 * (row * width + left + 2 * half), 3)]

    def message(self, window):
        """The one sentence over the picture, which is broken into lines where the view is narrow."""
        texts = window.on_screen()
        self.assertEqual(len(texts), 1, texts)
        return texts[0].replace("<br>", " ")
