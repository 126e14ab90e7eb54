# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel: what its widgets show and set, files that its dialogs suggest, and other languages."""
import json
import pathlib
import re
import shutil
import subprocess
import unittest
import xml.etree.ElementTree as xml

from tool import PANEL, TOOL, ToolTest, part
from ply import write_ply

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Debian's /usr/bin/lupdate is there without them.
LUPDATE, LRELEASE = (shutil.which(name, path="/usr/lib/qt5/bin") for name in ("lupdate", "lrelease"))
UNKNOWN = "\u2013"


class Values(ToolTest):
    def test_sliders_and_numbers_are_the_same_value(self):
        with self.start(self.mesh, disc=20) as w:
            radius, slider = part("radius"), part("radius_slider")
            low = w.widget(radius)["value"]
            place = w.widget(slider)["value"]
            w.set(slider, place + 100)
            higher = w.widget(radius)["value"]
            self.assertGreater(higher, low)
            w.set(slider, place + 200)
            # The same way on the slider is the same factor.
            self.assertAlmostEqual(w.widget(radius)["value"] / higher, higher / low, delta=0.02)
            w.set(radius, low)
            self.assertEqual(w.widget(slider)["value"], place)
            w.set(part("handle_share_slider"), 500)
            self.assertEqual(w.widget(part("handle_share"))["value"], 45)
            w.set(part("handle_share"), 0)
            self.pull(w, self.CENTRE, (10, 10))
            self.assertAlmostEqual(self.steps_of(w)[0]["region"]["radius"], low, delta=1e-4 * low)

    def test_presets_set_values_and_values_tell_the_preset(self):
        with self.start(self.mesh, disc=20) as w:
            self.assertEqual(w.widget(part("preset"))["currentText"], "General")
            before = {n: w.widget(part(n)) for n in ("handle_share", "softness", "membrane", "detail_rotation")}
            w.set(part("preset"), "Terrain")
            self.assertEqual(w.widget(part("detail_rotation"))["currentText"], "None")
            self.assertEqual(w.widget(part("preset"))["currentText"], "Terrain")
            w.set(part("handle_weight"), 7)
            self.assertEqual(w.widget(part("preset"))["currentText"], "Custom")
            w.set(part("preset"), "Custom")
            self.assertEqual(w.widget(part("handle_weight"))["value"], 7)
            self.pull(w, self.CENTRE, (10, 10))
            step = self.steps_of(w)[0]
            self.assertEqual((step["detail_rotation"], step["handle_weight"]), ("none", 7))
            self.assertNotIn("Terrain", json.dumps(step))
            w.set(part("preset"), "General")
            self.assertEqual(before, {n: w.widget(part(n)) for n in before})

    def test_what_belongs_to_the_session_is_kept_by_it(self):
        with self.start(self.mesh) as w:
            choices = {"mode": 1, "brush_target": 2, "gizmo_axes": 1, "pivot": 1, "mirror": 4}
            for name, index in choices.items():
                self.assertEqual(w.widget(part(name))["currentIndex"], 0, name)
                w.set(part(name), index)
            w.set(part("gizmo"), True)
            w.trigger(TOOL)
            w.trigger(TOOL)
            for name, index in choices.items():
                self.assertEqual(w.widget(part(name))["currentIndex"], index, name)
            self.assertTrue(w.widget(part("gizmo"))["checked"])

    def test_keys_change_what_the_panel_shows(self):
        with self.start(self.mesh, gizmo=True) as w:
            w.click(*w.pixel(self.CENTRE))
            for key, name, index in (("C", "mode", 1), ("B", "brush_target", 1), ("P", "pivot", 2)):
                w.key(key)
                self.assertEqual(w.widget(part(name))["currentIndex"], index, key)
            w.key("V")
            self.assertFalse(w.widget(part("gizmo"))["checked"])

    def test_anchors_from_selection_hold(self):
        with self.start(self.mesh) as w:
            w.set(part("group_handle"), True)
            w.set(part("radius"), 0.4)
            self.assertFalse(w.widget(part("anchors_from_selection"))["enabled"])
            w.click(*w.pixel(self.CENTRE))
            # A square of three columns and rows, not far from the handle.
            held = [row * self.ROWS + column for row in (23, 24, 25) for column in (23, 24, 25)]
            w.layer(selected_faces=[f for f, corners in enumerate(self.faces) if set(corners) <= set(held)])
            w.press_button(part("anchors_from_selection"))
            before = w.dump().triples()
            self.pull(w, self.CENTRE, (30, -40))
            after = w.dump().triples()
            way = max(abs(a - b) for p, q in zip(before, after) for a, b in zip(p, q))
            for vertex in held:
                self.assertLess(max(abs(a - b) for a, b in zip(before[vertex], after[vertex])), 0.02 * way)


class Statistics(ToolTest):
    def test_what_is_not_known_is_not_told(self):
        with self.start(self.mesh) as w:
            def figures():
                return {n: w.widget(part(n))["text"] for n in ("region", "times", "frame", "quality")}
            for name, text in figures().items():
                self.assertIn(UNKNOWN, text, name)
                self.assertEqual(re.findall(r"\d", text), ["0"] if name == "region" else [], text)
            self.pull(w, self.CENTRE, (30, -30))
            for name, text in figures().items():
                self.assertNotIn(UNKNOWN, text, name)
                self.assertRegex(text, r"\d")
            self.assertIn("steps: 1", figures()["region"])
            w.key("W")
            w.click(*w.pixel(self.CENTRE + 8 * self.ROWS))
            # Of the region before.
            self.assertIn(UNKNOWN, figures()["quality"])
            self.assertRegex(figures()["times"], f"solved in {UNKNOWN} ms")


    def test_stretch_is_shown_where_it_is(self):
        with self.start(self.mesh, disc=20) as w:
            x, y = self.pull(w, self.CENTRE, (40, -30), release=False)
            plain = self.picture(w, x, y)
            w.set(part("heat"), True)
            hot = self.picture(w, x, y)
            self.assertGreater(sum(a != b for a, b in zip(plain, hot)), 1000)
            w.set(part("heat"), False)
            self.assertLess(sum(a != b for a, b in zip(plain, self.picture(w, x, y))), 20)


class Files(ToolTest):
    def test_dialogs_suggest_a_file_beside_the_mesh(self):
        folder = self.folder / "somewhere else"
        folder.mkdir()
        mesh = write_ply(folder / "nose.v2.ply", self.points, self.faces)
        suggested = folder / "nose.v2.laplacian.json"
        with self.start(mesh) as w:
            self.pull(w, self.CENTRE, (20, -20))
            result = w.dump()
            w.press_button(part("load"), wait=False)
            self.assertNotIn(str(suggested), w.wait_dialog()["files"])  # it is not there yet
            w.answer(button="Cancel")
            w.press_button(part("save"), wait=False)
            self.assertEqual(w.wait_dialog()["files"], [str(suggested)])
            w.answer()
            self.assertEqual(len(json.loads(suggested.read_text())["steps"]), 1)
            w.press_button(part("reset"))
            w.press_button(part("load"), wait=False)
            self.assertEqual(w.wait_dialog()["files"], [str(suggested)])
            w.answer()
            self.assert_same(result, w.dump())


@unittest.skipUnless(LUPDATE and LRELEASE, "needs Qt's lupdate and lrelease")
class Languages(ToolTest):
    """A language that is English in brackets."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sources = [str(ROOT / "common/lapedit"), str(ROOT / "edit_laplacian_drag")]
        cls.catalogue = cls.folder / "laplacian_edit_eo.ts"
        cls.tool(LUPDATE, "-silent", "-recursive", *cls.sources, "-tr-function-alias",
                 "QT_TRANSLATE_NOOP+=LAPEDIT_TEXT", "-no-obsolete", "-ts", cls.catalogue)

    @staticmethod
    def tool(*command):
        subprocess.run(list(map(str, command)), check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def sentences(self):
        """By context."""
        found = {}
        for context in xml.parse(self.catalogue).getroot().iter("context"):
            found[context.findtext("name")] = [m.findtext("source") for m in context.iter("message")]
        return found

    def translated_home(self):
        """Puts the language where the tool looks for it."""
        tree = xml.parse(self.catalogue)
        for message in tree.getroot().iter("message"):
            translation = message.find("translation")
            translation.attrib.pop("type", None)
            translation.text = "[" + message.findtext("source") + "]"
        translated = self.folder / "translated.ts"
        tree.write(translated, encoding="utf-8", xml_declaration=True)
        folder = self.folder / ".local/share/laplacian-edit/translations"  # of the test's own home
        folder.mkdir(parents=True, exist_ok=True)
        self.tool(LRELEASE, "-silent", translated, "-qm", folder / "laplacian_edit_eo.qm")

    def test_every_sentence_of_the_core_is_found(self):
        """What stands in the code and is not marked, or is marked and not found, would stay English."""
        folder = ROOT / "common/lapedit"
        texts = "".join(path.read_text() for suffix in ("*.h", "*.cpp") for path in sorted(folder.rglob(suffix)))
        literal = r'((?:"(?:[^"\\]|\\.)*"\s*)+)'
        marked = {"".join(re.findall(r'"((?:[^"\\]|\\.)*)"', group))
                  for group in re.findall(r'LAPEDIT_TEXT\(\s*"lapedit",\s*' + literal + r"\)", texts)}
        self.assertGreater(len(marked), 100)
        self.assertLessEqual(marked, set(self.sentences()["lapedit"]))
        messages = (folder / "session/messages.h").read_text()
        self.assertEqual(messages.count("constexpr const char* k"), messages.count("LAPEDIT_TEXT("))
        functions = (folder / "session/messages.cpp").read_text()
        self.assertEqual(re.findall(r'format_text\(\s*"', functions), [])

    def test_a_language_is_shown_everywhere(self):
        self.translated_home()
        environment = dict(self.environment, LANGUAGE="eo", LANG="eo", LC_ALL="eo_XX.UTF-8")
        type(self).environment, before = environment, self.environment
        try:
            with self.start(self.mesh, disc=20) as w:
                self.assertRegex(self.message(w), r"^\[Press on the surface")
                for widget in w.ask("widgets", inside=PANEL)["widgets"]:
                    if widget["name"].startswith("laplacian_drag_") and widget["tool_tip"]:
                        self.assertRegex(widget["tool_tip"], r"^(<qt>)?\[.*\](</qt>)?$", widget)
                    for text in (widget.get("text"), widget.get("currentText")):
                        if text and re.search("[A-Za-z]{2}", text) and widget["class"] not in ("QLineEdit",):
                            self.assertIn("[", text, widget)
                w.key("X")
                self.assertRegex(self.message(w), r"^\[Nothing is being moved")
                self.pull(w, self.CENTRE, (20, -20), release=False)
                self.assertRegex(self.message(w), r"^\[\[Moving by [\d.]+\]: release to apply")
        finally:
            type(self).environment = before


if __name__ == "__main__":
    unittest.main()
