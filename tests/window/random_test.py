# SPDX-License-Identifier: GPL-3.0-or-later
"""Random events: MeshLab still runs, no number is broken, undoing all gives the original bits, and what was recorded
replays to the bit."""
import math
import os
import random
import unittest

from tool import TOOL, ToolTest, part
from ply import write_ply
from shapes import moved

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
               "button": 4, "drop": 3, "navigate": 3, "suspend": 1, "select": 1, "visible": 1, "touch": 5, "list": 3,
               "cross": 3, "tabs": 1}
    SIMPLE = {
        "press": lambda e: e.mouse("press", e.position(), e.button_name(), e.modifiers()),
        "move": lambda e: e.mouse("move", e.position(), modifiers=e.modifiers()),
        "release": lambda e: e.mouse("release", e.position(), e.button_name(), e.modifiers()),
        "drag": lambda e: e.way(e.position(), e.modifiers()),
        "brush": lambda e: e.way(e.position(), e.random.choice([["ctrl"], ["shift"], ["ctrl", "alt"], ["shift", "alt"]]), moves=8),
        "key": lambda e: e.ask("key", key=e.random.choice(KEYS), modifiers=[]),
        "undo": lambda e: e.ask("key", key="Z", modifiers=["ctrl"]),
        "redo": lambda e: e.ask("key", key="Z", modifiers=["ctrl", "shift"]),
        # One pressed, or a box ticked or not; also what is folded away.
        "button": lambda e: e.ask("set", name=part(e.random.choice(e.buttons)), value=e.random.random() < 0.7)}
    # After a batch, since they take long; in turn, so that none is missing.
    RARE = ["layer", "filter", "restart", "imported", "reloaded", "project", "dialog"]

    def __init__(self, test, window):
        self.test, self.w, self.random = test, window, random.Random(SEED)
        self.originals = {}
        self.resumed = set()  # layers whose steps were kept when the tool was left: others may have changed normals and flags
        self.counts = dict.fromkeys([*self.WEIGHTS, *self.RARE], 0)
        self.replayed = 0
        self.requests = []
        self.sent = 0
        names = {name.removeprefix(part("")): w for name, w in window.widgets(inside=part("panel")).items() if name.startswith(part(""))}
        self.choices = {name: w for name, w in names.items() if "currentIndex" in w and name not in SETTINGS}
        self.buttons = sorted({name for name, w in names.items() if "checked" in w} - LEFT_ALONE)
        self.touched = sorted(names.keys() - LEFT_ALONE)
        self.tab = window.widget("layerDialog")["windowTitle"]
        self.remember()

    def ask(self, command, **arguments):
        self.requests.append({"command": command, **arguments})

    def flush(self):
        requests, self.requests = self.requests, []
        self.sent += sum(request["command"] not in ("idle", "step") for request in requests)
        for _, error in self.w.batch(requests):
            # What is disabled cannot be used by hand either; a wide window has no tabs.
            self.test.assertRegex(error, "is disabled|no such tab")

    def remember(self):
        """The tool starts with the current layer as it is now, or goes on with the steps it has of it."""
        self.w.idle()
        self.test.shade_smoothly(self.w)
        self.layer_id, self.chosen = self.current(), self.choices_of_layers()
        if not self.w.widget(part("reset"))["enabled"]:
            self.originals[self.layer_id] = self.w.dump()
            self.resumed.discard(self.layer_id)
        else:
            self.resumed.add(self.layer_id)

    def current(self):
        return next(layer["id"] for layer in self.w.layers() if layer["current"])

    def opened(self):
        """How often a mesh has been read; from 2022.02 on MeshLab words the second time otherwise."""
        return sum(line.startswith(("Opened mesh", "File reloaded")) for line in self.w.log())

    def choices_of_layers(self):
        """How often a layer has become the current one, as far as MeshLab logs it."""
        self.w.log()
        return sum("Selected new Mesh" in line for line in self.w.output)

    def check(self):
        """Undoes all, and compares."""
        self.flush()
        w = self.w
        w.idle()
        self.resume()
        w.key("Backspace")
        w.mouse("release", 3, 3)
        w.ask("touch", name=part("radius"))
        w.mouse("move", 3, 3)
        self.test.assertTrue(w.ask("tool")["focus"], "the picture has no keys")
        w.key("Backspace")
        for layer in w.layers():
            self.test.assert_finite(w.dump(layer["id"]))
        if (self.current(), self.choices_of_layers()) != (self.layer_id, self.chosen):
            # By a click on the line over the picture; undo may be gone, as after the event "layer".
            if w.widget(part("reset"))["enabled"]:
                w.set(part("reset"), True)
            w.set(part("mirror"), 0)
            self.remember()
            self.originals[self.layer_id] = w.dump()
            self.resumed.discard(self.layer_id)
            return
        if w.widget(part("reset"))["enabled"]:
            if self.random.random() < 0.3:
                self.replay()
            w.set(part("reset"), True)
        w.set(part("mirror"), 0)  # a plane that suits no handle would refuse all that follows
        before, now = self.originals[self.layer_id], w.dump()
        differences = [d for d in before.differences(now) if self.layer_id not in self.resumed or "normals" not in d and "flags" not in d]
        # Flat shading, which a reload or a new view brings back for a moment, changes last bits: see shade_smoothly().
        self.test.assertEqual([d for d in differences if not (
            d in ("normals", "face_normals") and max(map(math.dist, before.triples(d), now.triples(d))) < 1e-6)], [])

    def resume(self):
        """After an Esc that suspended the tool."""
        if self.w.tool() == (TOOL, True):
            self.w.trigger("Not editing")
        self.test.assertEqual(self.w.tool(), (TOOL, False))

    def replay(self):
        """What the window has, from the recorded edit and the coordinates at the beginning."""
        original = self.originals[self.layer_id]
        mesh = write_ply(self.test.folder / "original.ply", original.triples(), original.faces())
        self.test.assert_replay_is_the_same(self.w, mesh)
        self.replayed += 1

    def run(self):
        kinds, weights = zip(*self.WEIGHTS.items())
        batches = 0
        while self.sent < EVENTS:
            try:
                for kind in self.random.choices(kinds, weights, k=BATCH):
                    self.happen(kind)
                    self.wait()
                self.flush()
                if self.random.random() < 0.1:
                    kind = min(self.RARE, key=lambda kind: (self.counts[kind], self.random.random()))
                    self.happen(kind)
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

    def happen(self, kind):
        self.counts[kind] += 1
        self.simply(kind) if kind in self.SIMPLE else getattr(self, kind)()

    def simply(self, *kinds):
        """As a part of another event."""
        for kind in kinds:
            self.SIMPLE[kind](self)

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

    def hover(self):
        """No button held, in small steps, and the pictures of it."""
        self.mouse("release", self.position())
        position = self.position()
        for _ in range(4):
            position = dict(position, x=position["x"] + self.random.uniform(-9, 9), y=position["y"] + self.random.uniform(-9, 9))
            self.mouse("move", position)
            self.ask("step")

    def click(self):
        position, modifiers = self.position(), self.modifiers()
        self.mouse("press", position, modifiers=modifiers)
        self.mouse("release", position, modifiers=modifiers)
        if self.random.random() < 0.1:
            self.mouse("double", position, modifiers=modifiers)

    def fresh_drag(self):
        """From whatever state to a step."""
        self.mouse("release", {"x": 3, "y": 3})
        self.ask("key", key="Backspace", modifiers=[])
        self.ask("set", name=part("brush_target"), value=0)
        self.ask("set", name=part("clear"), value=True)  # also where it is folded away
        for choice in ("mode", "mirror", "pivot"):  # a plane may suit no handle, a pivot take the click
            self.ask("set", name=part(choice), value=0)
        self.ask("set", name=part("radius"), value=self.random.uniform(0.1, 0.4))
        self.simply("drag")

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

    def wheel(self):
        position = self.position() if self.random.random() < 0.7 else {"x": 300, "y": 300}
        self.ask("wheel", delta=self.random.choice([-240, -120, 120, 240]), modifiers=self.modifiers(), **position)

    def setting(self):
        name = self.random.choice([*SETTINGS])
        self.ask("set", name=part(name), value=SETTINGS[name](self.random))

    def choice(self):
        """Mode, brush, gizmo, pivot, symmetry: whatever lists the panel has."""
        name = self.random.choice(list(self.choices))
        self.ask("set", name=part(name), value=self.random.randrange(self.choices[name]["count"]))

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
        self.ask("tab", text=self.tab)
        self.simply("drag")
        self.ask("tab", text=TOOL)

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
            self.simply("undo")
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
            self.simply("drag")
        self.ask("trigger", text="Not editing")

    def select(self):
        self.ask("layer", selected_faces=self.random.sample(range(len(self.test.faces)), 40))
        self.flush()
        # The selection is not the tool's: what it is now is to stay.
        if self.current() == self.layer_id:
            self.originals[self.layer_id].arrays["face_flags"] = self.w.dump()["face_flags"]

    def visible(self):
        self.ask("layer", visible=False)
        self.simply("drag")
        self.ask("layer", visible=True)

    def layer(self):
        self.check()
        self.simply("drag", "press")
        self.flush()
        self.w.ask("layer", layer=1 - self.layer_id, current=True)
        self.remember()

    def filter(self):
        self.simply("press", "move")
        self.flush()
        self.w.run_filter(self.random.choice(["Laplacian Smooth", "Invert Selection", "Re-Compute Vertex Normals"]))
        self.test.assertEqual(self.w.tool()[0], "")
        self.w.trigger(TOOL)
        self.remember()

    def restart(self):
        self.simply("drag", "press")
        self.flush()
        self.resume()
        self.w.trigger(TOOL)
        self.test.assertEqual(self.w.tool()[0], "")
        self.w.trigger(TOOL)
        self.remember()

    def busy(self):
        """In the middle of something."""
        self.check()
        self.simply("drag", "press", "move")
        self.flush()
        self.resume()

    def imported(self):
        self.busy()
        self.w.trigger("Import Mesh...", wait=False)
        self.w.answer(path=self.test.folder / "second.ply")
        self.w.wait(lambda: len(self.w.layers()) == 3, "no mesh was imported", 20)
        self.remember()
        self.fresh_drag()
        self.flush()
        self.w.ask("layer", layer=0, current=True)
        self.w.ask("layer", layer=max(layer["id"] for layer in self.w.layers()), remove=True)
        self.remember()

    def reloaded(self):
        self.busy()
        self.w.idle()  # a drag that is still being solved would be a step of the mesh read again, which is the same
        opened = self.opened()
        self.w.trigger("Reload", wait=False)
        self.w.wait(lambda: self.opened() > opened, "the mesh was not read again", 20)
        self.w.wait(lambda: not self.w.widget(part("reset"))["enabled"], "the old steps can still be undone", 20)
        self.w.ask("mouse", type="release", button="left", modifiers=[], x=3, y=3)
        self.remember()

    def dialog(self):
        """An edit is saved or loaded; the mouse and keys go on while the dialog is open."""
        saved, kept = (self.test.folder / name for name in ("saved.json", "kept.json"))
        for name in ("save", "load"):
            self.resume()
            if saved.exists():
                saved.replace(kept)  # another file of its name would open a further dialog
            path = saved if name == "save" else kept
            if self.w.widget(part(name))["enabled"] and (name == "save" or path.exists()):
                self.w.ask("set", name=part(name), value=True)
                self.w.wait_dialog()
                for kind in self.random.choices(["drag", "brush", "key", "undo", "wheel", "setting"], k=4):
                    self.happen(kind)
                self.flush()
                self.w.answer(**self.random.choice([{"path": path}, {"path": path}, {"button": "Cancel"}]))
        self.fresh_drag()

    def project(self):
        self.busy()
        self.w.trigger("New Empty Project...")
        self.test.assertFalse([p for p in self.w.widgets(part("panel")).values() if p["visible"]])
        self.w.view(project=0)
        self.resume()
        self.w.ask("mouse", type="release", button="left", modifiers=[], x=3, y=3)  # the drag is still in progress
        self.remember()


class Random(ToolTest):
    def test_random_events(self):
        second = write_ply(self.folder / "second.ply", *moved((self.points, self.faces), offset=(0.3, 0.2, 0.1)))
        with self.start(self.mesh, second) as w:
            w.x_focus()
            events = Events(self, w)
            events.run()
            events.check()
            if EVENTS >= 20000:
                self.assertGreater(min(events.counts.values()), 0, events.counts)
                self.assertGreater(events.replayed, 0)
            self.assertGreater(len(self.steps_in_log(w)), EVENTS // 200)


if __name__ == "__main__":
    unittest.main()
