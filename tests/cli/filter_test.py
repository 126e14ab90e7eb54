# SPDX-License-Identifier: GPL-3.0-or-later
"""The filters' parameters and what they leave unchanged, on generated meshes."""
import json
import math
import re
import subprocess
import unittest

import numpy as np

from host import CENTRE, COMMAND, TOOL, UP, DomeHost, laplacian_edit, laplacian_fit, project, replay, select_faces, select_vertices
from ply import Ply, bits_of, float_of, write_ply
from shapes import in_reach, moved, together
from surfaces import Z, rotation


def motion(degrees, offset):
    """The matrix of a rotation about the z-axis and a translation."""
    return np.vstack([np.hstack([rotation(Z, degrees), np.reshape(offset, (3, 1))]), [0, 0, 0, 1]])


def moved_by(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


class FilterTest(DomeHost):
    def bits(self, filters, mesh=None, **options):
        """Coordinate bits of the result, and the log."""
        path, log = self.edited(filters, mesh or self.mesh, **options)
        return Ply(path).point_bits(), log

    def moved_vertices(self, bits):
        return {v for v, p in enumerate(self.points) if bits[v] != tuple(map(bits_of, p))}


class Fit(FilterTest):
    copy = '<filter name="Duplicate Current layer"></filter>'

    def test_a_layer_is_fitted_to_another(self):
        lifted, _ = self.bits([laplacian_edit(**self.lift)])
        bits, log = self.bits([self.copy, laplacian_edit(**self.lift), laplacian_fit(align=3)])
        distance = [max(math.dist(p, map(float_of, q)) for p, q in zip(self.points, points)) for points in (lifted, bits)]
        self.assertGreater(distance[0], 0.19)
        self.assertLess(distance[1], 0.13)  # along the surface too
        self.assertRegex(log, 'Fit to the layer "dome.ply".* alignment: none')
        fit = {"region": {"component": True}, "fit": {"to": "dome.ply", "align": "none"}}
        again, _ = self.bits([self.copy, laplacian_edit(**self.lift), replay(fit)])
        self.assertEqual(again, bits)

    @unittest.skipUnless(COMMAND, "the program is compared")
    def test_the_program_gives_the_same_bits(self):
        path, _ = self.edited([self.copy, laplacian_edit(**self.lift)], self.mesh)
        bits, _ = self.bits([self.copy, laplacian_edit(**self.lift), laplacian_fit()])
        out = self.folder / "fitted.ply"
        subprocess.run([COMMAND, "-q", "--fit", self.mesh, path, out], check=True)
        self.assertEqual(Ply(out).point_bits(), bits)

    @unittest.skipIf(TOOL, "meshlabserver opens projects")
    def test_points_picked_in_both_layers_align_them_in_the_coordinates_of_both(self):
        path, _ = self.edited([laplacian_edit(**self.lift)], self.mesh)
        to_scan, template = motion(40, (0.5, 0, 2)), motion(20, (0, 4, 0))
        world = moved_by(motion(160, (3, -1, 0.5)), np.array(Ply(path).points()))
        scan = moved_by(to_scan, world).tolist()
        write_ply(self.folder / "scan.ply", scan, self.faces)
        # The scan's points are named as if it were turned round, which nothing but landmarks can decide.
        for name, points in (("dome", self.points), ("scan", scan[::-1])):
            (self.folder / f"{name}_picked_points.pp").write_text("<PickedPoints>" + "".join(
                f'<point x="{points[v][0]!r}" y="{points[v][1]!r}" z="{points[v][2]!r}" name="{v}"/>' for v in (0, 20, 420, 440, CENTRE))
                + "</PickedPoints>")
            self.addCleanup((self.folder / f"{name}_picked_points.pp").unlink)
        layers = project((self.folder / "scan.ply", np.linalg.inv(to_scan).ravel()), (self.mesh, template.ravel()))
        path, log = self.edited([laplacian_fit(align=2)], None, project_text=layers)
        self.assertIn('Fit to the layer "layer0"', log)
        self.assertIn("by landmarks", log)
        placed = moved_by(template, np.array(Ply(path).points()))
        self.assertLess(np.linalg.norm(placed - world[::-1], axis=1).max(), 0.2)

    def test_a_missing_layer_is_refused(self):
        for name, sentence in (("", "There is no other layer"), ("nose", 'no other layer, so none is named "nose": open')):
            result = self.run_host([laplacian_fit(scan=name)], self.mesh)
            self.assertIn(sentence, result.text)
            self.assertIsNone(result.output)


class Settings(FilterTest):
    def test_every_setting_changes_the_result_but_not_the_rest_of_the_mesh(self):
        region = in_reach(self.points, CENTRE, 0.35)
        plain, _ = self.bits([laplacian_edit(**self.lift)])
        self.assertLessEqual(self.moved_vertices(plain), region)
        seen = [plain]
        for change, expected in (({"method": 1}, "Method: paper"), ({"method": 2}, "Method: linear"), ({"laplacian": 1}, "umbrella"),
                                 ({"laplacian": 2}, "cotangent"), ({"method": 2, "order": 2}, "order 2"),
                                 ({"method": 2, "order": 3}, "order 3"), ({"membrane": 0}, "membrane 0"), ({"padding": 0.5}, ""),
                                 ({"translation": (0.1, 0, 0.1)}, "")):
            with self.subTest(change):
                bits, log = self.bits([laplacian_edit(**{**self.lift, **change})])
                self.assertNotIn(bits, seen)
                seen.append(bits)
                self.assertLessEqual(self.moved_vertices(bits), region)
                self.assertTrue(all(math.isfinite(float_of(c)) for p in bits for c in p))
                self.assertIn(expected, log)

    def test_values_of_the_method_are_the_defaults(self):
        for method, values in ((0, {"laplacian": 4, "membrane": 500}), (1, {"laplacian": 1, "membrane": 0})):
            short, _ = self.bits([laplacian_edit(**self.lift, method=method)])
            self.assertEqual(short, self.bits([laplacian_edit(**self.lift, method=method, **values)])[0])

    def test_selected_vertices_are_the_handle(self):
        picked = [v for v, p in enumerate(self.points) if math.dist(p[:2], (0.5, 0.5)) < 0.12]
        select = select_vertices("(x-0.5)*(x-0.5)+(y-0.5)*(y-0.5)<0.0144")
        settings = {"handle_source": 1, "radius": 0.3, "rotation_axis": (0, 0, 2), "rotation_angle": 30, "scale": 1.2}
        bits, log = self.bits([select, laplacian_edit(**settings)])
        self.assertIn(f"{len(picked)} handle", log)
        same, _ = self.bits([replay({
            "region": {"radius": 0.3},
            "handles": [{"vertices": ",".join(map(str, picked)),
                         "rotation": {"axis": [0, 0, 2], "degrees": 30}, "scale": 1.2}]})])
        self.assertEqual(bits, same)

    def test_an_edit_without_movement_says_so(self):
        _, log = self.bits([laplacian_edit(**{**self.lift, "translation": (0, 0, 0)})])
        self.assertIn("The handle did not move", log)
        _, log = self.bits([laplacian_edit(**self.lift)])
        self.assertNotIn("did not move", log)

    def test_a_vertex_is_taken_by_its_number(self):
        by_point, log = self.bits([laplacian_edit(**self.lift)])
        self.assertRegex(log, r"; its vertex is (0|\S+e-(0[789]|1\d)) from the handle point")
        away = [c + 0.003 for c in self.points[CENTRE]]
        beside, log = self.bits([laplacian_edit(**{**self.lift, "handle_point": away})])
        self.assertIn("; its vertex is 0.0052 from the handle point", log)
        by_number, log = self.bits([laplacian_edit(**{**self.lift, "handle_point": (9, 9, 9)}, handle_source=2,
                                                   handle_vertex=CENTRE)])
        self.assertNotIn("handle point", log)
        self.assertEqual(by_number, by_point)
        self.assertEqual(beside, by_point)

    def test_selected_faces_are_the_region(self):
        inside = {v for v, p in enumerate(self.points) if 0.19 < p[0] < 0.81 and 0.29 < p[1] < 0.81}
        condition = " && ".join(f"({c}{k}>0.{low}) && ({c}{k}<0.81)" for c, low in (("x", 19), ("y", 29)) for k in "012")
        bits, log = self.bits([select_faces(condition), laplacian_edit(**{**self.lift, "region_source": 1})])
        counts = re.search(r"(\d+) handle, (\d+) free, (\d+) anchor vertices; (\d+) fixed", log).groups()
        self.assertEqual(sum(map(int, counts[:3])), len(inside))
        touched = self.moved_vertices(bits)
        self.assertIn(CENTRE, touched)
        self.assertLessEqual(touched, inside)
        same, _ = self.bits([replay({**self.lift_json, "region": {"vertices": ",".join(map(str, inside))}})])
        self.assertEqual(bits, same)

    def test_whole_component_follows_and_others_stay(self):
        two = together((self.points, self.faces), moved((self.points, self.faces), offset=(2, 0, 0)))
        mesh = write_ply(self.folder / "two.ply", *two)
        bits, log = self.bits([laplacian_edit(**{**self.lift, "region_source": 2})], mesh)
        self.assertIn("0 anchor", log)
        n = len(self.points)
        self.assertEqual(bits[n:], [tuple(map(bits_of, p)) for p in two[0][n:]])
        for v in range(n):
            target = [c + t for c, t in zip(self.points[v], UP)]
            self.assertLess(math.dist(target, [float_of(c) for c in bits[v]]), 2e-7)


class Replay(FilterTest):
    def test_all_settings_mean_the_same_in_both_filters(self):
        edited, _ = self.bits([laplacian_edit(
            **self.lift, padding=0.3, method=1, laplacian=2, order=2, membrane=7.5)])
        replayed, _ = self.bits([replay({
            **self.lift_json, "region": {"radius": 0.35, "padding": 0.3}, "method": "paper", "laplacian": "cotangent",
            "order": 2, "membrane": 7.5})])
        self.assertEqual(edited, replayed)

    def test_fraction_goes_part_of_the_way(self):
        half, _ = self.bits([replay(self.lift_json, fraction=0.5)])
        same, _ = self.bits([laplacian_edit(**{**self.lift, "translation": (0, 0, 0.1)})])
        self.assertEqual(half, same)

    def test_text_and_paths(self):
        """A text with quotes and newlines, a file by its absolute and relative path."""
        text = json.dumps({"laplacian_edit": 1, "steps": [self.lift_json]}, indent=2)
        file = self.folder / "ed it & <co>" / "lift.json"
        file.parent.mkdir()
        file.write_text(text)
        same, _ = self.bits([replay(self.lift_json)])
        for edit in (f" \n\t{text}\n", file, file.relative_to(self.folder)):
            self.assertEqual(self.bits([replay(edit)])[0], same)

    def test_landmarks_are_converted_to_the_space_of_the_file(self):
        """Of the layer's own file, since MeshLab does not keep what its header says."""
        mesh = self.folder / "space.ply"
        mesh.write_bytes(self.mesh.read_bytes().replace(b"\nelement vertex", b"\ncomment SPACE=LPS\nelement vertex", 1))
        results = []
        for name, system, sign in (("lps", "l,p,s", 1), ("ras", "r,a,s", -1)):
            for end, lift in (("from", 0), ("to", 0.1)):
                rows = [(sign * x, sign * y, z + lift * (v == CENTRE)) for v in (CENTRE, 45, 70, 388) for x, y, z in [self.points[v]]]
                (self.folder / f"{end}_{name}.csv").write_text(f"label,{system}\n" + "".join(
                    f"{k},{x!r},{y!r},{z!r}\n" for k, (x, y, z) in enumerate(rows)))
            landmarks = {end: str(self.folder / f"{end}_{name}.csv") for end in ("from", "to")}
            results.append(self.bits([replay({"region": {"component": True}, "handles": [{"landmarks": landmarks}]})], mesh))
        self.assertEqual(results[0][0], results[1][0])
        self.assertNotIn("were converted", results[0][1])
        self.assertIn("Landmarks were converted to the coordinate system of the mesh: from RAS to LPS", results[1][1])

    def test_a_missing_file_is_said_with_the_folder(self):
        for edit in ("no.json", {"region": {"radius": 1}, "handles": [{"landmarks": {"from": "no.pp", "to": "no.pp"}}]}):
            self.assert_refused(self.run_host([replay(edit)], self.mesh),
                                rf"the path of a file\. It was looked for in the folder \"{self.folder.resolve()}\"\.")


@unittest.skipIf(TOOL, "meshlabserver opens projects")
class Layer(FilterTest):
    MATRIX = (0, -2, 0, 5, 2, 0, 0, -3, 0, 0, 2, 7, 0, 0, 0, 1)

    def test_parameters_are_in_layer_coordinates_and_the_transform_stays(self):
        edited, _ = self.bits([laplacian_edit(**self.lift)])
        saved = self.folder / "saved.mlp"
        for step in (laplacian_edit(**self.lift), replay(self.lift_json)):
            path, _ = self.edited([step], None, project_text=project((self.mesh, self.MATRIX)), project_out=saved)
            self.assertEqual(Ply(path).point_bits(), edited)
            matrix = re.search(r"<MLMatrix44>(.*?)</MLMatrix44>", saved.read_text(), re.DOTALL).group(1)
            self.assertEqual([float(x) for x in matrix.split()], list(self.MATRIX))


if __name__ == "__main__":
    unittest.main()
