#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tool shows while it is used, a picture per thing: called by window_lines.sh.

What a version of the tool does not have is left out of its pictures.
"""
import argparse
import contextlib
import math
import pathlib
import sys
import time

from pictures import TOOL, Pictures, convert, cut, nearest, part, sheet, turned, with_caption

from ply import write_ply
from shapes import moved, together

NOSE, EAR = (0, -0.13, 1.21), (1.0, 0.33, -0.1)
CHEEK = (0.32, -0.3, 0.85)
TIPS = [(-0.5, 1.2, 0.1), (-0.17, 1.44, 0.1), (0.15, 1.5, 0.1), (0.46, 1.33, 0.1)]
PALM = (0, 0, 0.22)
COLOURS = {"light": None, "dark": lambda p: (18, 20, 26), "green": lambda p: (50, 150, 60),
           "coloured": lambda p: tuple(round(127 + 120 * math.sin(5 * c + k)) for k, c in enumerate(p))}


def read_ply(path):
    """Points and faces of a text PLY as make_mesh writes it."""
    header, rows = path.read_text(encoding="ascii").split("end_header\n")
    count = next(int(line.split()[2]) for line in header.splitlines() if line.startswith("element vertex"))
    rows = rows.splitlines()
    return ([tuple(map(float, row.split())) for row in rows[:count]],
            [tuple(map(int, row.split()[1:])) for row in rows[count:]])


class Lines:
    """One method per picture: it makes <its name>.png."""

    def __init__(self, pictures, generated, output):
        self.pictures, self.generated, self.output = pictures, generated, output
        self.shots = []

    def __call__(self, name):
        self.shots = []
        getattr(self, name)()
        if self.shots:
            sheet(self.shots, min(2, len(self.shots)), self.output / f"{name}.png")
        for shot in self.shots:
            shot.unlink()

    @contextlib.contextmanager
    def tool(self, mesh, matrix=None, size=(1280, 800), **settings):
        path = mesh if isinstance(mesh, pathlib.Path) else self.generated / f"{mesh}.ply"
        with self.pictures.open(path.resolve()) as window:
            window.resize(*size)
            window.size = size
            if matrix:
                window.layer(matrix=matrix)
            window.trigger("Front")
            window.trigger(TOOL)
            for name, value in settings.items():
                self.set(window, name, value)
            window.points = window.dump().triples()
            window.at = lambda place: window.pixel(nearest(window.points, place))
            yield window

    def shoot(self, window, caption, centre=None, side=380):
        """The view; the window if centre is False; else a part of the view around it."""
        path = self.output / f"shot{len(self.shots)}.png"
        window.grab(path)
        if centre:
            cut(window, path, centre, side, side)
        elif centre is None:
            view = window.ask("project")
            cut(window, path, (0, 0), view["width"], view["height"])
        else:
            convert(path, "-crop", "{}x{}+0+0".format(*window.size), "+repage", path)
        with_caption([path], caption, path)
        self.shots.append(path)

    def has(self, window, name):
        return part(name) in window.widgets(part(name))

    def set(self, window, name, value):
        if self.has(window, name):
            percent = window.widget(part(name)).get("maximum", 0) > 1 and name == "handle_share"
            window.set(part(name), round(100 * value) if percent else value)

    def coloured(self, name, colour):
        if colour is None:
            return self.generated / f"{name}.ply"
        points, faces = read_ply(self.generated / f"{name}.ply")
        rows = [" ".join(map(str, (*colour(p), 255))) for p in points]
        return write_ply(self.pictures.folder / "coloured.ply", points, faces,
                         "".join(f"property uchar {c}\n" for c in ("red", "green", "blue", "alpha")), rows)

    # What there is to see ---------------------------------------------------------------------------------------------

    def large_handle(self):
        """A group of some 2,000 vertices while it is dragged."""
        for name, colour in COLOURS.items():
            mesh = self.coloured("head", colour)
            with self.tool(mesh, turned(0, 35), radius=1.1, handle_radius=0.48, handle_share=0.44) as w:
                x, y = w.at(NOSE)
                w.drag((x, y), (x + 60, y - 20), steps=8, release=False)
                self.shoot(w, f"{name}: dragged", (x + 20, y - 20))

    def groups(self):
        for name in ("light", "green"):
            mesh = self.coloured("hand", COLOURS[name])
            with self.tool(mesh, radius=1.2, handle_radius=0.16, handle_share=0.14) as w:
                w.click(*w.at(TIPS[0]))
                for tip in TIPS[1:]:
                    w.key("G")
                    w.click(*w.at(tip))
                x, y = w.at(TIPS[3])
                self.shoot(w, f"{name}: four groups", (x - 60, y + 60))
                w.drag((x, y), (x + 40, y - 30), steps=8, release=False)
                self.shoot(w, f"{name}: the last one is dragged, the others hold", (x - 60, y + 60))

    def region(self):
        with self.tool("head", turned(0, 35), radius=0.9) as w:
            x, y = w.at(NOSE)
            w.click(x, y)
            w.move(3, 300)
            self.shoot(w, "clicked: region, handle and anchors", (x, y))

    def preparing(self):
        with self.tool("million", turned(-50), radius=2.7) as w:
            x, y = w.pixel(nearest(w.points, (2, 1, 0.12)))
            w.mouse("press", x, y)
            for wait in (0.6, 2.0):
                time.sleep(wait)
                self.shoot(w, f"a region of a million vertices, {wait} s later")
            w.mouse("release", x, y)
            w.key("Backspace")

    def hover(self):
        with self.tool("head", turned(0, 35)) as w:
            for place, what in ((NOSE, "nose"), (CHEEK, "cheek")):
                x, y = w.at(place)
                w.move(x, y)
                self.shoot(w, f"over the {what}, nothing pressed", (x, y))
            w.wheel(x, y, 4)
            w.move(x + 1, y)
            self.shoot(w, "4 notches of the wheel later")
            w.wheel(x, y, 3, modifiers=["ctrl"])
            w.move(x, y)
            self.shoot(w, "3 notches with Ctrl")

    def wheel_without_region(self):
        with self.tool("head") as w:
            w.wheel(5, 300, 3)
            self.shoot(w, "3 notches beside the mesh, no region")

    def dropped(self):
        with self.tool("head", turned(0, 60)) as w:
            x, y = w.at(NOSE)
            for name, drop in (("right button", lambda: w.mouse("press", x + 60, y - 20, "right")),
                               ("Esc", lambda: w.key("Esc")),
                               ("Ctrl+Z", lambda: w.key("Z", modifiers=["ctrl"]))):
                w.drag((x, y), (x + 60, y - 20), steps=5, release=False)
                drop()
                w.idle()
                self.shoot(w, f"dragged, then {name}", (x + 40, y))
                if name == "right button":
                    w.mouse("release", x + 60, y - 20, "right")
                if w.tool() == (TOOL, True):
                    w.trigger("Not editing")
                w.mouse("release", x + 60, y - 20)
                w.key("Backspace")
                if w.widget(part("reset"))["enabled"]:
                    w.press_button(part("reset"))
                w.trigger("Front")

    def typed_without_motion(self):
        with self.tool("creature", turned(5, -15)) as w:
            w.click(*w.at((0.8, -1.29, 0.41)))
            w.key("X", "6", "0")
            self.shoot(w, "clicked, then X 6 0 without a motion")
            w.key("Return")
            self.shoot(w, "and Return")

    def brushed_apart(self):
        with self.tool("hand") as w:
            w.click(*w.at(TIPS[0]))
            start, end = w.at((-0.1, -0.3, 0.22)), w.at((0.2, -0.1, 0.22))
            w.drag(start, end, modifiers=["ctrl"], steps=8, release=False)
            self.shoot(w, "Ctrl+drag on the palm, held")
            w.mouse("release", *end, modifiers=["ctrl"])
            w.idle()
            self.shoot(w, "released")

    def nothing_holds(self):
        points, faces = read_ply(self.generated / "creature.ply")
        eye = moved(read_ply(self.generated / "head.ply"), 0.06, (1.63, 1.1, 0.2))
        mesh = write_ply(self.pictures.folder / "parts.ply", *together((points, faces), eye))
        with self.tool(mesh, turned(5, -15)) as w:
            x, y = w.pixel(len(points) + nearest(eye[0], (1.63, 1.1, 0.3)))
            w.click(x, y)
            self.shoot(w, "clicked on a small piece of a mesh of two parts")
            w.drag((x, y), (x + 40, y - 60), steps=5, release=False)
            self.shoot(w, "dragged", (x, y))
            w.mouse("release", x + 40, y - 60)
            w.idle()
        with self.tool("hand") as w:
            x, y = w.at(TIPS[1])
            w.click(x, y)
            w.set(part("component"), True)
            self.shoot(w, "Component")
            w.drag((x, y), (x - 60, y - 30), steps=5, release=False)
            self.shoot(w, "dragged")

    def gizmo(self):
        with self.tool("creature", turned(5, -15), radius=1.2, handle_radius=0.25, handle_share=0.2) as w:
            if not self.has(w, "gizmo"):
                return
            x, y = w.at((0.8, -1.29, 0.41))
            w.click(x, y)
            self.set(w, "gizmo", True)
            for k in range(w.widget(part("gizmo_axes"))["count"]):
                self.set(w, "gizmo_axes", k)
                w.move(3, 300)
                self.shoot(w, "gizmo: " + w.widget(part("gizmo_axes"))["currentText"], (x, y))
            for k in range(w.widget(part("pivot"))["count"] - 1):
                self.set(w, "pivot", k)
                w.move(3, 300)
                self.shoot(w, "pivot: " + w.widget(part("pivot"))["currentText"], (x, y))

    def symmetry(self):
        with self.tool("head", turned(0, 20)) as w:
            if not self.has(w, "mirror"):
                return
            self.set(w, "mirror", 1)
            x, y = w.at(EAR)
            w.move(x, y)
            self.shoot(w, "over an ear, mirrored across x")
            w.drag((x, y), (x + 60, y - 50), steps=8, release=False)
            self.shoot(w, "dragged")
            w.mouse("release", x + 60, y - 50)
            w.idle()
            self.shoot(w, "released")

    def heat(self):
        with self.tool("head", turned(0, 60)) as w:
            if not self.has(w, "heat"):
                return
            self.set(w, "heat", True)
            x, y = w.at(NOSE)
            w.drag((x, y), (x + 60, y - 20), steps=8, release=False)
            self.shoot(w, "stretch while dragging", (x, y))

    def documents(self):
        """The pictures in edit_laplacian_drag/in-the-window.md."""
        def keep(window, name, centre, width=460, height=330):
            path = self.output / "documents" / f"{name}.png"
            path.parent.mkdir(exist_ok=True)
            cut(window, window.grab(path), centre, width, height)
            convert(path, "+dither", "-colors", 200, f"PNG8:{path}")

        with self.tool("head", turned(0, 40)) as w:
            x, y = w.at(NOSE)
            w.move(x - 8, y)
            keep(w, "hover", (x - 60, y))
        with self.tool("creature", turned(5, -15), radius=1.0, handle_share=0.25) as w:
            x, y = w.at((0.8, -1.29, 0.41))
            w.click(x, y)
            self.set(w, "gizmo", True)
            w.move(3, 300)
            keep(w, "gizmo", (x - 20, y - 70))
        with self.tool("hand", radius=1.2, handle_share=0.14) as w:
            self.set(w, "gizmo", False)
            w.click(*w.at(TIPS[0]))
            for tip in TIPS[1:]:
                w.key("G")
                w.click(*w.at(tip))
            x, y = w.at(TIPS[3])
            w.drag((x, y), (x + 40, y - 30), steps=8, release=False)
            keep(w, "groups", (x - 60, y + 75), 460, 330)
            w.mouse("release", x + 40, y - 30)

    # Panel ------------------------------------------------------------------------------------------------------------

    def panel(self):
        for size in ((1280, 720), (1280, 620), (1600, 900)):
            with self.tool("head", turned(0, 35), size=size) as w:
                w.click(*w.at(NOSE))
                view = w.ask("project")
                self.shoot(w, f"{size[0]} x {size[1]}: the picture has {view['width']} x {view['height']}", False)

    def panel_unfolded(self):
        with self.tool("head", turned(0, 35), size=(1280, 1000)) as w:
            headers = w.widgets(part("group_"))
            w.click(*w.at(NOSE))
            for name, header in headers.items():
                if not header.get("checked"):
                    w.press_button(name)
            if headers:
                self.shoot(w, "all unfolded", False)

    def two_views(self):
        with self.tool("head", turned(0, 35), size=(1600, 900)) as w:
            x, y = w.at(NOSE)
            w.drag((x, y), (x + 40, y))
            w.trigger("Horizontally")
            w.resize(1601, 900)
            self.shoot(w, "a second view of the layer", False)
            w.trigger(TOOL)
            self.shoot(w, "and the tool in it", False)

    def file_dialog(self):
        with self.tool("head", turned(0, 35)) as w:
            x, y = w.at(NOSE)
            w.drag((x, y), (x + 40, y))
            w.press_button(part("save"), wait=False)
            w.wait_dialog()
            time.sleep(0.5)
            self.shoot(w, "Save edit...", False)
            w.answer(path=self.pictures.folder / "edit.json")


NAMES = [name for name in vars(Lines)
         if not name.startswith("_") and name not in ("tool", "shoot", "has", "set", "coloured")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--generated", type=pathlib.Path, required=True, help="folder of the generated meshes")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("names", nargs="*", help=f"of {' '.join(NAMES)}; all by default")
    given = parser.parse_args()
    given.output.mkdir(parents=True, exist_ok=True)

    def make(pictures):
        lines = Lines(pictures, given.generated.resolve(), given.output.resolve())
        for name in given.names or NAMES:
            try:
                lines(name)
            except AssertionError as error:  # the others are wanted all the same
                print(f"{name}: {error}", file=sys.stderr)

    Pictures.screen = "1600x1000"
    Pictures.made_by(make)


if __name__ == "__main__":
    main()
