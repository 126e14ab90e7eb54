# SPDX-License-Identifier: GPL-3.0-or-later
"""The filters refuse what they cannot do with one sentence, and the mesh is not written."""
import json
import math
import unittest

from host import CENTRE, TOOL, DomeHost, laplacian_edit, replay, select_vertices
from ply import write_ply


class RefusalTest(DomeHost):
    def refused(self, filters, sentence, mesh=None):
        with self.subTest(sentence):
            self.assert_refused(self.run_host(filters, mesh or self.mesh), sentence)

    def refused_edit(self, sentence, before=(), mesh=None, **change):
        self.refused([*before, laplacian_edit(**{**self.lift, **change})], sentence, mesh)


class Parameters(RefusalTest):
    def test_values(self):
        """One of each kind: the core's tests try all that it refuses."""
        for sentence, change in (
                (r"radius is 0.* greater than 0", {"radius": 0}),
                (r"\(0\.5, 0\.5, 9\) is .* nearest vertex, number \d+.*diagonal", {"handle_point": (0.5, 0.5, 9)}),
                (r"The handle vertex is -1, but there are 441 vertices: give a number from 0 to 440\.", {"handle_source": 2, "handle_vertex": -1}),
                (r"order .*is 2, but the method default has 1 only: .* use another method", {"order": 2}),
                (r"membrane.* is -?nan", {"membrane": "nan"}),
                (rf"group 0 is vertex {CENTRE} alone, which cannot be scaled by 2 .*: name several", {"scale": 2}),
                (r"rotation axis is \(0, 0, 0\)", {"rotation_axis": (0, 0, 0), "rotation_angle": 10}),
                (r"translation is not a finite number", {"translation": ("inf", 0, 0)}),
                (r"laplacian is 5: give 0 \(Default of the method\) or 1 \(Umbrella\) or 2 \(Cotangent\) or 3 \(Mean value\) or 4 \(Surface\)", {"laplacian": 5}),
                (r"region_source is -1: give 0 \(", {"region_source": -1})):
            self.refused_edit(sentence, **change)

    def test_empty_selections(self):
        self.refused_edit(r"No vertex is selected: select some of the 441 vertices", handle_source=1)
        self.refused_edit(r"No face is selected: select some of the 800 faces", region_source=1)

    def test_wrong_type_in_the_script(self):
        wrong = laplacian_edit(**self.lift).replace('type="RichInt" name="order"', 'type="RichFloat" name="order"')
        self.refused([wrong], r"parameter order is a Float, which is of the wrong type")


class Meshes(RefusalTest):
    def test_point_cloud(self):
        cloud = write_ply(self.folder / "cloud.ply", self.points, [])
        self.refused_edit(r"441 vertices but no faces", mesh=cloud)
        self.refused([replay(self.lift_json)], r"441 vertices but no faces", cloud)

    def test_empty_mesh(self):
        everything = '<filter name="Delete Selected Vertices"/>'
        before = [select_vertices("x>-1"), everything]
        self.refused_edit(r"no vertices", before)
        self.refused([*before, replay(self.lift_json)], r"no vertices")

    def test_no_mesh_at_all(self):
        for step in (laplacian_edit(**self.lift), replay(self.lift_json)):
            before = ['<filter name="Delete Current Mesh"/>'] if TOOL else []
            self.assert_refused(self.run_host([*before, step], self.mesh if TOOL else None), r"There are 0 layers")

    def test_non_finite_coordinates_inside_the_region(self):
        for bad in (math.nan, math.inf):
            points = list(self.points)
            points[CENTRE + 2] = (points[CENTRE + 2][0], bad, 0)
            mesh = write_ply(self.folder / "bad.ply", points, self.faces)
            self.refused_edit(rf"{CENTRE + 2}", mesh=mesh)


class Scripts(RefusalTest):
    def test_edits(self):
        self.refused([replay("")], r"No edit is given")
        self.refused([replay("{")], r"line 1")
        self.refused([replay(str(self.folder / "none.json"))], r"none\.json.* nor the path of a file")
        other = {"laplacian_edit": 1, "mesh": {"vertices": 440, "faces": 800}, "steps": [self.lift_json]}
        self.refused([replay(json.dumps(other))], r"440 vertices.* 441 vertices")

    def test_later_step_is_named_and_nothing_is_changed(self):
        bad = {"region": {"radius": -1}, "handles": [{"vertices": "1"}]}
        self.refused([replay(json.dumps({"laplacian_edit": 1, "steps": [self.lift_json, bad]}))], r"Step 2 of 2: ")

    def test_fraction(self):
        self.refused([replay(self.lift_json, fraction=2)], r"fraction is 2.* 0 .* 1 ")
        self.refused([replay(self.lift_json, fraction="nan")], r"fraction is -?nan")


if __name__ == "__main__":
    unittest.main()
