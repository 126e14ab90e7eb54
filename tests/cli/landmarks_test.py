# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks in other coordinate systems, units and encodings than the mesh, regions that nothing holds, and how refusals name what
they are about. tests/unit/json/landmarks_test.cpp has the tables of each format."""
import json
import re
import unittest

from program import ADVISED, CENTRE, DOME, LIFT, REFUSED, UNREADABLE, ProgramTest, files
from shapes import moved, together

SHEET = moved(DOME, offset=(-0.5, -0.5, 0))  # each landmark with x and y negated is on the sheet, too
HEIGHT = max(p[2] for p in SHEET[0])
NAMED = {name: SHEET[0][vertex] for name, vertex in {"nose": CENTRE, "left ear": 70, "right ear": 388, "chin": 97, "nape": 45}.items()}
TARGETS = {name: (x, y, z + 0.1 * (name == "nose") + 0.05 * (name == "chin")) for name, (x, y, z) in NAMED.items()}


def turned(named):
    return {name: (-x, -y, z) for name, (x, y, z) in named.items()}


def scaled(named, factor):
    return {name: tuple(factor * c for c in point) for name, point in named.items()}


def table(named, header="name,x,y,z", separator=",", more=""):
    return "".join(separator.join(line.split(",")) + "\n" for line in [
        header, *(f"{name},{x!r},{y!r},{z!r}{more}" for name, (x, y, z) in named.items())])


def fiducials(named, system):
    return (f"# Markups fiducial file version = 4.11\n# CoordinateSystem = {system}\n"
            "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
            + "".join(f"1,{x!r},{y!r},{z!r},0,0,0,1,1,1,0,{name},,\n" for name, (x, y, z) in named.items()))


def markups(named, system):
    return json.dumps({"markups": [{"coordinateSystem": system, "controlPoints": [
        {"label": name, "position": list(point)} for name, point in named.items()]}]})


def slicer_table(named, system, separator=","):
    return table(named, "label," + ",".join(system.lower()) + ",defined,selected,visible,locked,description", separator, ",1,1,1,0,")


WRITERS = {"fcsv": fiducials, "mrk.json": markups, "csv": slicer_table,
           "tsv": lambda named, system: slicer_table(named, system, "\t")}


def named_meshes(space):
    """Names and bytes of the sheet in files whose header names a coordinate system."""
    comment = f"comment SPACE={space}\nobj_info"
    for form in files.FORMS:
        yield form + ".ply", files.ply_plain(SHEET, form=form).replace(b"obj_info", comment.encode(), 1)
    yield "small_letters.ply", files.ply_plain(SHEET).replace(b"obj_info", comment.lower().encode(), 1)
    yield "double.ply", files.ply_plain(SHEET, "double").replace(b"obj_info", comment.encode(), 1)
    yield "binary.stl", files.stl_binary(SHEET, f"Visualization Toolkit generated SLA File SPACE={space}".encode())
    yield "text.stl", files.stl_text(SHEET).replace(b"a name", f"head SPACE={space}".encode(), 1)
    yield "comment.obj", f"# made\n# SPACE={space}\n".encode() + files.obj(SHEET, more=False)
    yield "comment.off", files.off(SHEET).replace(b"OFF\n", f"OFF # SPACE={space}\n".encode(), 1)


class LandmarkTest(ProgramTest):
    def write(self, name, text):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def step(self, *arguments):
        self.output = self.done(*arguments, "--report", "report.json")
        return json.loads((self.work / "report.json").read_text())["outputs"][0]["steps"][-1]

    def result(self, mesh, start, end, **options):
        """@return the bytes of the output, and the report of its only step"""
        out = self.work / ("out" + mesh.suffix)
        step = self.step(mesh, out, "--landmarks", start, end)
        return out.read_bytes(), step


class CoordinateSystems(LandmarkTest):
    def setUp(self):
        super().setUp()
        self.plain = self.write("from.csv", table(NAMED)), self.write("to.csv", table(TARGETS))

    def test_landmarks_are_converted_to_the_space_of_the_mesh(self):
        for space, other in (("LPS", "RAS"), ("RAS", "LPS")):
            start, end = (self.write(f"{n}.fcsv", fiducials(turned(p), other)) for n, p in (("from", NAMED), ("to", TARGETS)))
            for name, content in named_meshes(space):
                with self.subTest(name, space=space):
                    mesh = self.write(name, content)
                    expected, step = self.result(mesh, *self.plain)
                    self.assertIsNone(step["landmark_conversion"])
                    self.assertNotIn("converted", self.output)
                    found, step = self.result(mesh, start, end)
                    self.assertEqual(found, expected)
                    self.assertEqual(step["landmark_conversion"], f"from {other} to {space}")
                    self.assertIn(f"Landmarks were converted to the coordinate system of the mesh: from {other} to {space}\n", self.output)
                    self.assertIn(f"coordinate system: {space}\n", self.done("--info", mesh))

    def test_all_formats_of_landmarks_say_their_system(self):
        mesh = self.write(*next(named_meshes("LPS")))
        expected = self.result(mesh, *self.plain)[0]
        for suffix, write in WRITERS.items():
            for system, points, targets, conversion in (("LPS", NAMED, TARGETS, None),
                                                        ("RAS", turned(NAMED), turned(TARGETS), "from RAS to LPS")):
                with self.subTest(suffix, system=system):
                    found, step = self.result(mesh, self.write("a." + suffix, write(points, system)),
                                              self.write("b." + suffix, write(targets, system)))
                    self.assertEqual(found, expected)
                    self.assertEqual(step["landmark_conversion"], conversion)

    def test_each_file_is_converted_on_its_own(self):
        lps, ras = (self.write(name, content) for space in ("LPS", "RAS") for name, content in [next(named_meshes(space))][:1]
                    for name in [space + name])
        start, end = self.write("a.fcsv", fiducials(NAMED, "LPS")), self.write("b.mrk.json", markups(turned(TARGETS), "RAS"))
        expected = self.result(lps, *self.plain)[0]
        found, step = self.result(lps, start, end)
        self.assertEqual((found, step["landmark_conversion"]), (expected, "targets from RAS to LPS"))
        self.assertEqual(self.result(lps, self.write("c.fcsv", fiducials(turned(NAMED), "RAS")), self.plain[1])[1]["landmark_conversion"],
                         "points from RAS to LPS")
        with self.subTest("the mesh has no system"):  # targets are in that of the points
            found, step = self.result(self.write("plain.ply", files.ply_plain(SHEET)), start, end)
            self.assertEqual(step["landmark_conversion"], "targets from RAS to LPS")
            self.assertLess(step["handle_displacement"], 0.11)
        with self.subTest("another system"):
            self.refused(REFUSED, r"Landmarks in LAS coordinates cannot be converted to RAS: ", ras, "out.ply", "--landmarks",
                         self.write("d.csv", slicer_table(NAMED, "LAS")), end)

    def test_landmarks_in_an_edit_are_converted_too(self):
        mesh = self.write(*next(named_meshes("LPS")))
        self.write("a.fcsv", fiducials(turned(NAMED), "RAS"))
        self.write("b.tsv", slicer_table(turned(TARGETS), "RAS", "\t"))
        steps = {}
        for name, files_of in (("plain", ("from.csv", "to.csv")), ("converted", ("a.fcsv", "b.tsv"))):
            edit = self.write_edit({"region": {"component": True}, "handles": [{"landmarks": dict(zip(("from", "to"), files_of))}]})
            steps[name] = self.step(mesh, self.work / f"{name}.ply", edit)
        self.assertEqual(*((self.work / f"{name}.ply").read_bytes() for name in steps))
        self.assertEqual(steps["converted"]["landmark_conversion"], "from RAS to LPS")

    def test_text_that_only_looks_like_a_space_is_none(self):
        start, end = self.write("a.fcsv", fiducials(NAMED, "RAS")), self.write("b.fcsv", fiducials(TARGETS, "RAS"))
        for comment in ("WORKSPACE=LPS", "SPACE=LPSX", "SPACE = LPS is missing", "SPACE=", "SPACE=XYZ"):
            with self.subTest(comment):
                mesh = self.write("a.ply", files.ply_plain(SHEET).replace(b"obj_info", f"comment {comment}\nobj_info".encode(), 1))
                self.assertIsNone(self.result(mesh, start, end)[1]["landmark_conversion"])
        mesh = self.write("late.obj", files.obj(SHEET, more=False) + b"# SPACE=LPS\n")
        self.assertIsNone(self.result(mesh, start, end)[1]["landmark_conversion"])

    def test_without_a_space_a_refusal_says_which_conversion_fits(self):
        mesh = self.mesh  # over [0, 1] x [0, 1]
        points = {name: (x + 0.5, y + 0.5, z) for name, (x, y, z) in NAMED.items()}
        for name, content, systems in (("a.fcsv", fiducials(turned(points), "RAS"), "from RAS to LPS"),
                                       ("a.mrk.json", markups(turned(points), "LPS"), "from LPS to RAS"),
                                       ("a.csv", table(turned(points)), "between RAS and LPS")):
            path = self.write(name, content)
            self.refused(REFUSED, r'Landmark "nose" .* away from .*: check the coordinate system, since with x and y negated, as '
                         + systems + r", all of them are near the surface\.", mesh, "out.ply", "--landmarks", path, path)
        far = self.write("far.fcsv", fiducials({"nose": (7, 5, -3)}, "RAS"))
        self.refused(REFUSED, r": give a point on the surface\.", mesh, "out.ply", "--landmarks", far, far)


class Units(LandmarkTest):
    def test_a_refusal_names_the_likely_unit(self):
        for factor, words in ((1000, "divided by 1000, as from millimetres to metres"), (100, "divided by 100, as from centimetres to metres"),
                              (0.001, "multiplied by 1000, as from metres to millimetres"), (10, "divided by 10, as from millimetres to "),
                              (25.4, r"divided by 25\.4, as from millimetres to inches"), (1e6, "divided by 1000000, as from micrometres"),
                              (1 / 25.4, r"multiplied by 25\.4, as from inches to millimetres")):
            size = 1000 if factor < 1 else 1e-3  # of the mesh
            mesh = self.write("sized.off", files.off(moved(SHEET, size, (3 * size, 0, 0))))
            path = self.write("from.csv", table(scaled({name: (x + 3, y, z) for name, (x, y, z) in NAMED.items()}, factor * size)))
            self.refused(REFUSED, rf'"nose" .* away from .*: check the unit, since {words}.*, all of them are near the surface\.',
                         mesh, "out.off", "--landmarks", path, path)
        one = self.write("one.csv", table(scaled({"nose": (0.5, 0.5, HEIGHT)}, 1000)))
        self.refused(REFUSED, r"millimetres to metres, it is near the surface\.", self.mesh, "out.ply", "--landmarks", one, one)

    def test_unit_and_coordinate_system_together(self):
        points = scaled(turned({name: (x + 0.5, y + 0.5, z) for name, (x, y, z) in NAMED.items()}), 1000)
        path = self.write("from.fcsv", fiducials(points, "RAS"))
        self.refused(REFUSED, r"check unit and coordinate system, since divided by 1000, .* metres and with x and y negated, as from RAS",
                     self.mesh, "out.ply", "--landmarks", path, path)

    def test_what_no_unit_explains_has_none(self):
        """The sheet goes through the origin, where all points are if divided by enough."""
        for points in ({"a": (300, -400, 20)}, {"a": (7, 5, -3), "b": (50, 60, 7)}):
            path = self.write("from.csv", table(points))
            self.refused(REFUSED, r": give a point on the surface\.", self.mesh, "out.ply", "--landmarks", path, path)

    def test_targets_in_another_unit_have_advice(self):
        mesh = self.write("sheet.ply", files.ply_plain(SHEET))
        start = self.write("from.csv", table(NAMED))
        for factor, words in ((1000, "divided by 1000, as from millimetres to metres"), (100, "divided by 100, ")):
            end = self.write("to.csv", table(scaled({n: (x, y, z + 0.3) for n, (x, y, z) in TARGETS.items()}, factor)))
            self.assertRegex(self.result(mesh, start, end)[1]["advice"], rf"times as long: for the targets check the unit, since {words}")
        end = self.write("to.csv", table({n: (x + 900, y, z) for n, (x, y, z) in NAMED.items()}))
        self.assertNotIn("unit", self.result(mesh, start, end)[1]["advice"])


class Regions(LandmarkTest):
    def advice(self, region, *handles, mesh=None, more=()):
        edit = self.write_edit({"region": region, "handles": list(handles)})
        return self.step(mesh or self.mesh, "out.ply", edit, *more)["advice"]

    def test_a_region_that_nothing_holds_has_advice(self):
        stay = {"vertices": "0"}
        two = self.write("two.ply", files.ply_plain(together(DOME, moved(DOME, 1, (5, 0, 0)))))
        small = self.write("small.ply", files.ply_plain(moved(DOME, 1e-3)))
        by_radius = r"\ANothing holds the surface, .* Give a radius below (\S+), or add a handle group that stays\.\Z"
        for mesh, region, radius in ((self.mesh, {"radius": 350}, 1), (self.mesh, {"radius": 1.5, "padding": 0}, 1), (two, {"radius": 350}, 1),
                                     (small, {"radius": 0.35}, 1e-3)):
            with self.subTest(region):
                lift = {**LIFT["handles"][0], "translation": [0, 0, 0.2 * radius]}
                found = re.search(by_radius, self.advice(region, lift, mesh=mesh))
                self.assertIsNotNone(found)
                largest = float(found[1])
                self.assertTrue(0.7 * radius < largest < 1.2 * radius, largest)
                self.assertEqual(self.advice({"radius": 0.99 * largest}, lift, mesh=mesh), "")
        lift = LIFT["handles"][0]
        pair = self.write("pair.ply", files.ply_plain(together(DOME, moved(DOME, 0.3, (5, 0, 0)))))
        each = {**lift, "vertices": f"{CENTRE},{441 + CENTRE}"}
        smaller = float(re.search(by_radius, self.advice({"radius": 350}, each, mesh=pair))[1])
        for region in ({"radius": 0.99 * smaller}, {"radius": 0.2, "tips": True}):
            self.assertNotIn("Nothing holds", self.advice(region, each, mesh=pair), region)
        self.assertRegex(self.advice({"radius": 9}, {**lift, "vertices": "1-440"}), r"\ANothing holds .*: all .*handle\. Add a handle group that stays\.\Z")
        given = r"\ANothing holds the surface, .* Leave a part of the surface out of the region, or add "
        for region in ({"within": {"point": [0.5, 0.5, HEIGHT], "radius": 9}}, {"vertices": "0-440"}):
            self.assertRegex(self.advice(region, lift), given)
        both = {"vertices": f"0,{CENTRE}", "targets": [[0, 0, 0.1], [0.5, 0.5, HEIGHT + 0.1]]}
        self.assertRegex(self.advice({"radius": 9}, both), r"\ANothing holds")
        for region, handles in (({"component": True}, (lift,)), ({"radius": 9}, (lift, stay)), ({"radius": 9, "held": "0"}, (lift,)),
                                ({"radius": 9}, (stay,)), ({"radius": 0.35}, (lift,))):
            self.assertNotIn("Nothing holds", self.advice(region, *handles), region)
        self.assertNotIn("Nothing holds", self.advice({"radius": 9}, lift, more=("--fraction", "0")))
        loose = self.write("loose.ply", files.ply_plain(([*DOME[0], (0.5, 0.5, HEIGHT + 0.01)], DOME[1])))
        self.assertNotIn("Nothing holds", self.advice({"radius": 0.35}, {**lift, "vertices": f"{CENTRE},441"}, mesh=loose))
        self.refused(ADVISED, "Nothing holds the surface", self.mesh, "new.ply",
                     self.write_edit({"region": {"radius": 9}, "handles": [lift]}), "--strict")


class Messages(LandmarkTest):
    def test_refusals_name_the_landmark(self):
        mesh = self.write("sheet.ply", files.ply_plain(SHEET))
        self.write("from.csv", table(NAMED))
        self.write("to.csv", table(TARGETS))
        landmarks = {"landmarks": {"from": "from.csv", "to": "to.csv"}}
        near = {"within": {"point": list(NAMED["nose"]), "radius": 0.2}}
        outside = r'4 of 5 handle vertices lie outside the region, the first is vertex 45: .* Vertex 45 is the landmark "nape"\.\n'
        self.refused(REFUSED, outside, mesh, "out.ply", self.write_edit({"region": near, "handles": [landmarks]}))
        self.refused(REFUSED, r"\AStep 2 of 2: " + outside, mesh, "out.ply", self.write_edit(LIFT, {"region": near, "handles": [landmarks]}))
        self.refused(REFUSED, r'Vertex 97 is in handle groups 0 and 1: .* Vertex 97 is the landmark "chin"\.\n', mesh, "out.ply",
                     self.write_edit({"region": {"component": True}, "handles": [landmarks, {"vertices": "97"}]}))
        weights = {**landmarks, "weights": [1, 1, 1, 2, 1]}
        self.refused(REFUSED, r'Handle vertex 97 has the weight 2: .* is the landmark "chin"\.\n', mesh, "out.ply",
                     self.write_edit({"region": {"component": True}, "handles": [weights]}))
        points = {"points": [NAMED["nose"], NAMED["nape"]], "targets": [NAMED["nose"], NAMED["nape"]]}
        self.refused(REFUSED, r'Vertex 45 is the landmark "steps\[0\]\.handles\[0\]\.points\[1\]"\.\n', mesh, "out.ply",
                     self.write_edit({"region": near, "handles": [points]}))
        edit = self.write_edit({"region": {"radius": 0.35}, "handles": [{**landmarks, "weights": [1, 1, 1, 1, 1]}],
                                "handle_weight": 0.001})
        self.assertIn(f'at vertex {CENTRE} ("nose"): raise handle_weight', self.step(mesh, "out.ply", edit)["advice"])

    def test_a_missing_file_of_an_edit_is_said_with_its_folder(self):
        edit = self.write_edit({"region": {"component": True}, "handles": [{"landmarks": {"from": "from.csv", "to": "b/to.csv"}}]})
        looked = r"is not the path of a file\. It was looked for in the folder \"{}\"\.\n"
        self.refused(REFUSED, looked.format(self.folder), self.mesh, "out.ply", edit)
        self.write("from.csv", table(NAMED))
        self.refused(REFUSED, looked.format(self.folder / "b"), self.mesh, "out.ply", edit)
        self.refused(REFUSED, looked.format(self.work), self.mesh, "out.ply", "-", given=edit.read_bytes())

    def test_utf_16_is_named(self):
        plain = self.write("plain.csv", table(NAMED))
        picked = "<PickedPoints>" + "".join(f'<point x="{x}" y="{y}" z="{z}" name="{n}"/>' for n, (x, y, z) in NAMED.items()) + "</PickedPoints>"
        texts = {"csv": table(NAMED), "tsv": table(NAMED, separator="\t"), "fcsv": fiducials(NAMED, "RAS"), "mrk.json": markups(NAMED, "RAS"), "pp": picked}
        meshes = {"ply": files.ply_plain(SHEET), "off": files.off(SHEET), "obj": files.obj(SHEET), "stl": files.stl_text(SHEET)}
        for encoding, mark in (("utf-16", ""), ("utf-16-le", ""), ("utf-16-be", "\ufeff")):
            for suffix, text in texts.items():
                path = self.write("a." + suffix, (mark + text).encode(encoding))
                self.refused(REFUSED, rf'a\.{re.escape(suffix)}".* text .*in UTF-16: save it in UTF-8\.', self.mesh, "out.ply", "--landmarks", path, plain)
        for suffix, content in meshes.items():
            path = self.write("a." + suffix, content.decode().encode("utf-16"))
            self.refused(UNREADABLE, r"cannot be read: it is text in UTF-16: save it in UTF-8\.", "--info", path)
        self.done("--info", self.write("mark.stl", files.stl_binary(SHEET, b"\xff\xfe")))


if __name__ == "__main__":
    unittest.main()
