# SPDX-License-Identifier: GPL-3.0-or-later
"""Random events: MeshLab still runs, no number is broken, and undoing all gives the original bits."""
import os
import random
import unittest

from tool import TOOL, ToolTest, part
from ply import write_ply
from shapes import moved

EVENTS = int(os.environ.get("LAPEDIT_RANDOM_EVENTS", "2000"))
SEED = 20241121
KEYS = [*"XYZNTRSGCW0123456789.-", "Return", "Backspace", "Esc"]
SETTINGS = {"radius": lambda r: r.choice([0, 0.05, 0.1, 0.3]), "padding": lambda r: r.choice([0, 0.1, 0.5, 1]),
            "handle_radius": lambda r: r.choice([0, 0, 0.05]), "laplacian": lambda r: r.randrange(3),
            "order": lambda r: r.randrange(1, 4), "detail_rotation": lambda r: r.randrange(4),
            "iterations": lambda r: r.randrange(1, 3), "normal_radius": lambda r: r.choice([0, 0.05]),
            "handle_weight": lambda r: r.choice([1, 10]), "anchor_weight": lambda r: r.choice([0.5, 10]),
            "turning": lambda r: r.randrange(2), "rough": lambda r: r.randrange(2),
            "membrane": lambda r: r.choice([0, 1200])}
BUTTONS = ["undo", "redo", "reset", "grow", "shrink", "component", "from_selection", "copy", "cancel"]


class Events:
    """One kind of event per method; the name of each is its weight's key."""

    WEIGHTS = {"press": 10, "move": 30, "release": 12, "click": 8, "drag": 8, "wheel": 4, "key": 14, "undo": 4,
               "redo": 3, "setting": 4, "button": 5, "navigate": 3, "suspend": 1, "layer": 1, "filter": 1, "restart": 1,
               "select": 1, "visible": 1}

    def __init__(self, test, window):
        self.test, self.w, self.random = test, window, random.Random(SEED)
        self.originals = {}
        self.counts = dict.fromkeys(self.WEIGHTS, 0)
        self.remember()

    def remember(self):
        """The tool starts with the current layer as it is now, or goes on with the steps it has of it."""
        self.w.idle()
        self.layer_id = next(layer["id"] for layer in self.w.layers() if layer["current"])
        if not self.w.widget(part("reset"))["enabled"]:
            self.originals[self.layer_id] = self.w.dump()

    def check(self):
        """Undoes all, and compares."""
        w = self.w
        w.idle()
        if w.tool() == (TOOL, True):
            w.trigger("Not editing")
        self.test.assertEqual(w.tool(), (TOOL, False))
        w.key("Backspace")
        w.mouse("release", *self.place())
        w.key("Backspace")
        for layer in w.layers():
            self.test.assert_finite(w.dump(layer["id"]))
        if w.widget(part("reset"))["enabled"]:
            w.press_button(part("reset"))
        self.test.assert_same(self.originals[self.layer_id], w.dump())

    def run(self):
        kinds, weights = zip(*self.WEIGHTS.items())
        for number in range(EVENTS):
            kind = self.random.choices(kinds, weights)[0]
            self.counts[kind] += 1
            try:
                getattr(self, kind)()
                if self.random.random() < 0.3:
                    self.w.idle()
                if number % 100 == 99:
                    self.check()
            except AssertionError as error:
                raise AssertionError(f"at event {number}, {kind}: {error}") from error

    def place(self):
        if self.random.random() < 0.1:
            return self.random.uniform(0, 800), self.random.uniform(0, 750)
        x, y = self.w.pixel(self.random.randrange(len(self.test.points)))
        return x + self.random.uniform(-3, 3), y + self.random.uniform(-3, 3)

    def modifiers(self):
        return self.random.choice([[]] * 8 + [["ctrl"], ["shift"], ["alt"], ["ctrl", "shift"]])

    def press(self):
        self.w.mouse("press", *self.place(), self.random.choice(["left"] * 8 + ["middle", "right"]), self.modifiers())

    def move(self):
        self.w.mouse("move", *self.place(), modifiers=self.modifiers())

    def release(self):
        self.w.mouse("release", *self.place(), self.random.choice(["left"] * 8 + ["middle", "right"]), self.modifiers())

    def click(self):
        place, modifiers = self.place(), self.modifiers()
        self.w.mouse("press", *place, modifiers=modifiers)
        self.w.mouse("release", *place, modifiers=modifiers)
        if self.random.random() < 0.1:
            self.w.mouse("double", *place, modifiers=modifiers)

    def drag(self):
        x, y = self.place()
        modifiers = self.modifiers()
        self.w.mouse("press", x, y, modifiers=modifiers)
        for i in range(1, 5):
            self.w.mouse("move", x + 7 * i, y - 5 * i, modifiers=modifiers)
        self.w.mouse("release", x + 28, y - 20, modifiers=modifiers)

    def wheel(self):
        self.w.ask("wheel", x=300, y=300, delta=self.random.choice([-240, -120, 120, 240]), modifiers=self.modifiers())

    def key(self):
        key = self.random.choice(KEYS)
        self.w.ask("key", key=key, modifiers=[])

    def undo(self):
        self.w.ask("key", key="Z", modifiers=["ctrl"])

    def redo(self):
        self.w.ask("key", key="Z", modifiers=["ctrl", "shift"])

    def setting(self):
        name = self.random.choice(list(SETTINGS))
        self.w.ask("set", name=part(name), value=SETTINGS[name](self.random))

    def button(self):
        name = part(self.random.choice(BUTTONS))
        if self.w.widgets(name).get(name, {}).get("enabled"):
            self.w.ask("click", name=name)

    def navigate(self):
        x, y = self.random.uniform(100, 600), self.random.uniform(100, 600)
        self.w.mouse("press", x, y, "middle")
        self.w.mouse("move", x + self.random.uniform(-20, 20), y + self.random.uniform(-20, 20))
        self.w.mouse("release", x, y, "middle")
        if self.random.random() < 0.5:
            self.w.ask("trigger", text="Front")

    def suspend(self):
        self.w.ask("trigger", text="Not editing")
        for _ in range(3):
            self.drag()
        self.w.ask("trigger", text="Not editing")

    def layer(self):
        self.check()
        self.drag()
        self.press()
        self.w.ask("layer", layer=1 - self.layer_id, current=True)
        self.remember()

    def filter(self):
        self.press()
        self.move()
        self.w.run_filter(self.random.choice(["Laplacian Smooth", "Invert Selection", "Re-Compute Vertex Normals"]))
        self.test.assertEqual(self.w.tool()[0], "")
        self.test.shade_smoothly(self.w)
        self.w.trigger(TOOL)
        self.remember()

    def restart(self):
        self.drag()
        self.press()
        self.w.trigger(TOOL)
        self.test.assertEqual(self.w.tool()[0], "")
        self.w.trigger(TOOL)
        self.remember()

    def select(self):
        self.w.ask("layer", selected_faces=self.random.sample(range(len(self.test.faces)), 40))
        self.remember_flags()

    def visible(self):
        self.w.ask("layer", visible=False)
        self.drag()
        self.w.ask("layer", visible=True)

    def remember_flags(self):
        """The selection is not the tool's: what it is now is to stay."""
        self.originals[self.layer_id].arrays["face_flags"] = self.w.dump()["face_flags"]


class Random(ToolTest):
    def test_random_events(self):
        second = write_ply(self.folder / "second.ply", *moved((self.points, self.faces), offset=(0.3, 0.2, 0.1)))
        with self.start(self.mesh, second) as w:
            events = Events(self, w)
            events.run()
            events.check()
            self.assertGreaterEqual(min(events.counts.values()), EVENTS // 333, events.counts)
            self.assertGreater(len(self.steps_in_log(w)), EVENTS // 40)


if __name__ == "__main__":
    unittest.main()
