# SPDX-License-Identifier: GPL-3.0-or-later
"""Random events: MeshLab still runs, no number is broken, undoing all gives the original bits, and what was recorded
replays to the bit. leaving_test.py has what MeshLab and other filters do meanwhile."""
import os
import random
import unittest

from tool import TOOL, ToolTest, part

EVENTS = int(os.environ.get("LAPEDIT_RANDOM_EVENTS", "20000"))  # of mouse, wheel, keys, panel and view
SEED = int(os.environ.get("LAPEDIT_RANDOM_SEED", "20241121"))
BATCH = 30  # gestures that are sent together
CHECKED = 6  # batches after which all is undone and compared
KEYS = [*"XYZNTRSGCWPBV0123456789.-[]?", "Return", "Backspace", "Esc"]
SETTINGS = {"radius": lambda r: r.choice([0, 0.05, 0.1, 0.3]), "padding": lambda r: r.choice([0, 10, 50, 100]),
            "handle_fraction": lambda r: r.choice([0, 20, 50]), "falloff": lambda r: r.randrange(4),
            "connect_gap": lambda r: r.choice([0, 0.05]), "contact": lambda r: r.random() < 0.3,
            "method": lambda r: r.randrange(3), "detail": lambda r: r.choice([0, 50, 100, 200]),
            "membrane": lambda r: r.choice([0, 1200]), "last_fraction": lambda r: r.randrange(101),
            "last_value": lambda r: r.choice(["-0.1, 0, 0.2", "25", "1.5", "0.8", "x"]), "timeline": lambda r: r.randrange(20)}
LEFT_ALONE = {"save", "load", "group_basic"}  # dialogs wait for an answer, and the check needs what is in this group


class Events:
    """One kind of event per method; the name of each is its weight's key."""

    WEIGHTS = {"press": 10, "move": 24, "hover": 10, "release": 12, "click": 8, "drag": 8, "fresh_drag": 12,
               "gizmo_drag": 8, "brush": 4, "wheel": 6, "key": 14, "undo": 4, "redo": 3, "setting": 4, "choice": 2,
               "button": 4, "drop": 3, "navigate": 3, "suspend": 1, "visible": 1, "touch": 5, "list": 3, "cross": 3, "tabs": 1}

    def __init__(self, test, window):
        self.test, self.w, self.random = test, window, random.Random(SEED)
        self.replayed = 0
        self.requests = []
        self.sent = 0
        panel = window.ask("widgets", inside=part("panel"))["widgets"]
        names = {w["name"].removeprefix(part("")): w for w in panel if w["name"].startswith(part(""))}
        self.choices = {name: w for name, w in names.items() if "currentIndex" in w and name not in SETTINGS}
        self.buttons = sorted({name for name, w in names.items() if "checked" in w} - LEFT_ALONE)
        self.touched = sorted(names.keys() - LEFT_ALONE)
        self.tab = window.widget("layerDialog")["windowTitle"]
        window.layer(selected_faces=self.random.sample(range(len(test.faces)), 40))
        self.original = window.dump()

    def ask(self, command, **arguments):
        self.requests.append({"command": command, **arguments})

    def flush(self):
        requests, self.requests = self.requests, []
        self.sent += sum(request["command"] not in ("idle", "step") for request in requests)
        for _, error in self.w.batch(requests):
            # What is disabled cannot be used by hand either; a wide window has no tabs.
            self.test.assertRegex(error, "is disabled|no such tab")

    def check(self):
        """Undoes all, and compares."""
        self.flush()
        w = self.w
        w.idle()
        if w.tool() == (TOOL, True):  # after an Esc that suspended it
            w.trigger("Not editing")
        self.test.assertEqual(w.tool(), (TOOL, False))
        w.key("Backspace")
        w.mouse("release", 3, 3)
        w.ask("touch", name=part("radius"))
        w.mouse("move", 3, 3)
        self.test.assertTrue(w.ask("tool")["focus"], "the picture has no keys")
        w.key("Backspace")
        self.test.assert_finite(w.dump())
        if w.widget(part("reset"))["enabled"]:
            if self.random.random() < 0.3:
                self.test.assert_replay_is_the_same(w, self.test.mesh)
                self.replayed += 1
            w.set(part("reset"), True)
        w.set(part("mirror"), 0)  # a plane that suits no handle would refuse all that follows
        self.test.assert_same(self.original, w.dump())

    def run(self):
        kinds, weights = zip(*self.WEIGHTS.items())
        batches = 0
        while self.sent < EVENTS:
            try:
                for kind in self.random.choices(kinds, weights, k=BATCH):
                    getattr(self, kind)()
                    self.wait()
                self.flush()
                batches += 1
                if batches % CHECKED == 0:
                    self.check()
            except AssertionError as error:
                raise AssertionError(f"seed {SEED}, at event {self.sent}, {kind}: {error}") from error

    def wait(self):
        """Mostly not at all. A drag that waits for all goes on only after a second."""
        kind = self.random.random()
        if kind < 0.02:
            self.ask("idle")
        elif kind < 0.2:
            self.ask("idle", frame=True)
        elif kind < 0.4:
            self.ask("step")

    def position(self):
        """Arguments of a mouse command."""
        if self.random.random() < 0.1:
            return {"x": self.random.uniform(0, 800), "y": self.random.uniform(0, 750)}
        return {"vertex": self.random.randrange(len(self.test.points)), "x": self.random.uniform(-3, 3),
                "y": self.random.uniform(-3, 3)}

    def modifiers(self):
        return self.random.choice([[]] * 8 + [["ctrl"], ["shift"], ["alt"], ["ctrl", "shift"]])

    def button_name(self):
        return self.random.choice(["left"] * 8 + ["middle", "right"])

    def mouse(self, kind, position, button="left", modifiers=()):
        self.ask("mouse", type=kind, button=button, modifiers=list(modifiers), **position)

    def way(self, position, modifiers=(), moves=4, button="left"):
        """A drag, from press to release."""
        step = self.random.uniform(-9, 9), self.random.uniform(-9, 9)
        self.mouse("press", position, button, modifiers)
        if self.random.random() < 0.5:
            self.ask("idle", frame=True)  # the region is there
        for _ in range(moves):
            position = dict(position, x=position["x"] + step[0], y=position["y"] + step[1])
            self.mouse("move", position, modifiers=modifiers)
        self.mouse("release", position, button, modifiers)

    def press(self):
        self.mouse("press", self.position(), self.button_name(), self.modifiers())

    def move(self):
        self.mouse("move", self.position(), modifiers=self.modifiers())

    def hover(self):
        """No button held, in small steps, and the pictures of it."""
        self.mouse("release", self.position())
        position = self.position()
        for _ in range(4):
            position = dict(position, x=position["x"] + self.random.uniform(-9, 9), y=position["y"] + self.random.uniform(-9, 9))
            self.mouse("move", position)
            self.ask("step")

    def release(self):
        self.mouse("release", self.position(), self.button_name(), self.modifiers())

    def click(self):
        position, modifiers = self.position(), self.modifiers()
        self.mouse("press", position, modifiers=modifiers)
        self.mouse("release", position, modifiers=modifiers)
        if self.random.random() < 0.1:
            self.mouse("double", position, modifiers=modifiers)

    def drag(self):
        self.way(self.position(), self.modifiers())

    def fresh_drag(self):
        """From whatever state to a step."""
        self.mouse("release", {"x": 3, "y": 3})
        self.ask("key", key="Backspace", modifiers=[])
        self.ask("set", name=part("brush_target"), value=0)
        self.ask("set", name=part("clear"), value=True)  # also where it is folded away
        for choice in ("mode", "mirror", "pivot"):  # a plane may suit no handle, a pivot take the click
            self.ask("set", name=part(choice), value=0)
        self.ask("set", name=part("radius"), value=self.random.uniform(0.1, 0.4))
        self.drag()

    def gizmo_drag(self):
        """A handle, then drags that begin around it, where arrows, rings and the scale handle are."""
        self.ask("set", name=part("brush_target"), value=0)
        self.ask("set", name=part("mode"), value=0)
        vertex = self.random.randrange(len(self.test.points))
        at = {"vertex": vertex, "x": 0, "y": 0}
        self.mouse("press", at)
        self.mouse("release", at)
        self.ask("step")
        for _ in range(3):
            position = dict(at, x=self.random.uniform(-90, 90), y=self.random.uniform(-90, 90))
            self.mouse("move", position)
            self.way(position, self.random.choice([[], [], ["ctrl"], ["shift"]]))

    def brush(self):
        self.way(self.position(), self.random.choice([["ctrl"], ["shift"], ["ctrl", "alt"], ["shift", "alt"]]), moves=8)

    def wheel(self):
        position = self.position() if self.random.random() < 0.7 else {"x": 300, "y": 300}
        self.ask("wheel", delta=self.random.choice([-240, -120, 120, 240]), modifiers=self.modifiers(), **position)

    def key(self):
        self.ask("key", key=self.random.choice(KEYS), modifiers=[])

    def undo(self):
        self.ask("key", key="Z", modifiers=["ctrl"])

    def redo(self):
        self.ask("key", key="Z", modifiers=["ctrl", "shift"])

    def setting(self):
        name = self.random.choice([*SETTINGS])
        self.ask("set", name=part(name), value=SETTINGS[name](self.random))

    def choice(self):
        """Mode, brush, gizmo, pivot, symmetry: whatever lists the panel has."""
        name = self.random.choice(list(self.choices))
        self.ask("set", name=part(name), value=self.random.randrange(self.choices[name]["count"]))

    def button(self):
        """One pressed, or a box ticked or not; also what is folded away."""
        self.ask("set", name=part(self.random.choice(self.buttons)), value=self.random.random() < 0.7)

    def touch(self):
        """A click on whatever the panel has, typing there, and back into the picture."""
        self.ask("touch", name=part(self.random.choice(self.touched)))
        for _ in range(self.random.randrange(4)):
            self.ask("key_anywhere", key=self.random.choice([*"0123456789.-TCV", "Up", "Down", "Return"]), modifiers=[])
        self.close_list()
        if self.random.random() < 0.7:
            self.mouse("move", self.position())

    def list(self):
        """A list is opened; the mouse or keys go elsewhere, or a row is chosen."""
        self.ask("touch", name=part(self.random.choice([*self.choices])))
        self.ask("step")
        how = self.random.randrange(4)
        if how == 0:
            self.ask("key_anywhere", key=self.random.choice(KEYS[:20]), modifiers=[])
        elif how == 1:
            self.mouse("move", self.position())
        elif how == 2:
            self.ask("key_anywhere", key="Down", modifiers=[])
            self.ask("key_anywhere", key="Return", modifiers=[])
        self.close_list()

    def close_list(self):
        self.ask("key_anywhere", key="Esc", modifiers=[], list=True)

    def cross(self):
        """The mouse leaves the picture, perhaps with a button held, and comes back."""
        if self.random.random() < 0.3:
            self.mouse("press", self.position())
        for enters in (False, True):
            self.ask("cross", enters=enters, **self.position())
            if self.random.random() < 0.3:
                self.ask("key_anywhere", key=self.random.choice(KEYS), modifiers=[])

    def tabs(self):
        """The layer list comes to the front, and the panel again."""
        self.ask("tab", text=self.tab, choose=True)
        self.drag()
        self.ask("tab", text=TOOL, choose=True)

    def drop(self):
        """A motion is dropped by the right button, Esc or undo."""
        position = self.position()
        self.mouse("press", position)
        for k in range(1, 4):
            self.mouse("move", dict(position, x=position["x"] + 7 * k))
        how = self.random.randrange(3)
        if how == 0:
            self.mouse("press", position, "right")
            self.mouse("release", position, "right")
        elif how == 1:
            self.ask("key", key="Esc", modifiers=[])
            self.ask("step")
            self.ask("key", key="Esc", modifiers=[])
        else:
            self.undo()
        self.mouse("release", position)

    def navigate(self):
        x, y = self.random.uniform(100, 600), self.random.uniform(100, 600)
        self.mouse("press", {"x": x, "y": y}, "middle")
        self.mouse("move", {"x": x + self.random.uniform(-20, 20), "y": y + self.random.uniform(-20, 20)})
        self.mouse("release", {"x": x, "y": y}, "middle")
        if self.random.random() < 0.5:
            self.ask("trigger", text="Front")

    def suspend(self):
        self.ask("trigger", text="Not editing")
        for _ in range(3):
            self.drag()
        self.ask("trigger", text="Not editing")

    def visible(self):
        self.ask("layer", visible=False)
        self.drag()
        self.ask("layer", visible=True)


class Random(ToolTest):
    def test_random_events(self):
        with self.start(self.mesh) as w:
            w.x_focus()
            events = Events(self, w)
            events.run()
            events.check()
            if EVENTS >= 20000:
                self.assertGreater(events.replayed, 0)
            self.assertGreater(len(self.steps_in_log(w)), EVENTS // 200)


if __name__ == "__main__":
    unittest.main()
