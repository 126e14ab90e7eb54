# SPDX-License-Identifier: GPL-3.0-or-later
"""A template fitted to scans by the program: meshes and clouds, landmarks, a saved edit, and refusals."""
import json
import math
import struct
import unittest

import numpy as np

from program import CENTRE, DOME, REFUSED, UNREADABLE, WRONG_USAGE, ProgramTest, files
from shapes import dome
from surfaces import normals_of

TRUTH = [(1.05 * x + 0.05 * math.sin(2 * y), y, 1.2 * z) for x, y, z in DOME[0]]


def scan(rows=27):
    points, faces = dome(rows, rows + 4)
    return [(1.05 * x + 0.05 * math.sin(2 * y), y, 1.2 * z) for x, y, z in points], faces


def error(points):
    return sum(math.dist(p, q) for p, q in zip(points, TRUTH)) / len(TRUTH)


def picked(points):
    return "<PickedPoints>" + "".join(f'<point x="{x!r}" y="{y!r}" z="{z!r}" name="{name}"/>'
                                      for name, (x, y, z) in points.items()) + "</PickedPoints>"


class Fit(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scan = self.folder / "scan.ply"
        self.scan.write_bytes(files.ply_plain(scan()))
        self.out = self.work / "out.ply"
        corners = {"a": 0, "b": 20, "c": 420, "d": 440, "e": CENTRE}
        (self.folder / "from.pp").write_text(picked({name: DOME[0][v] for name, v in corners.items()}))
        (self.folder / "to.pp").write_text(picked({name: TRUTH[v] for name, v in corners.items()}))

    def result(self):
        lines = self.out.read_text().split("end_header\n")[1].splitlines()
        return [tuple(map(float, line.split())) for line in lines[:len(TRUTH)]]

    def fitted(self, *arguments):
        self.done("--fit", self.scan, self.mesh, self.out, "--report", self.work / "report.json", *arguments)
        step, = json.loads((self.work / "report.json").read_text())["outputs"][0]["steps"]
        return step

    def test_symmetrise(self):
        points, faces = dome(21, 21)
        points = [(x, y, 0.2 * math.sin(math.pi * x) + 0.2 * y * y + 0.05 * math.exp(-30 * ((x - 0.3) ** 2 + (y - 0.5) ** 2)))
                  for x, y, _ in points]
        crooked = self.folder / "crooked.ply"
        crooked.write_bytes(files.ply_plain((points, faces)))
        plane = {"point": [0.5, 0, 0], "normal": [1, 0, 0]}
        self.write_edit({"region": {"component": True}, "fit": {}, "mirror": plane})
        self.done("-q", crooked, self.out, self.edit)
        by_plane = self.result()

        def heights(of):
            return [abs(of[21 * i + j][2] - of[21 * (20 - i) + j][2]) for i in range(2, 19) for j in range(2, 19)]

        self.assertLess(max(heights(by_plane)), 0.5 * max(heights(points)))
        self.done("-q", "--symmetrise", crooked, self.out)
        self.assertLess(max(heights(self.result())), 0.5 * max(heights(points)))
        self.refused(WRONG_USAGE, "without --fit", "--symmetrise", "--fit", self.scan, crooked, self.out)

    def test_a_scan_and_landmarks(self):
        landmarks = ["--landmarks", self.folder / "from.pp", self.folder / "to.pp"]
        step = self.fitted(*landmarks)
        self.assertLess(error(self.result()), 0.5 * error(DOME[0]))
        self.assertTrue(step["fit"]["by_landmarks"])
        self.assertGreater(step["fit"]["to_scan"]["matched"], 0.5)
        self.assertEqual(len(step["landmarks"]), 5)
        self.assertEqual(step["folded"], 0)
        whole = self.out.read_bytes()
        self.write_edit({"region": {"component": True}, "fit": {"to": "scan.ply"},
                         "handles": [{"landmarks": {"from": "from.pp", "to": "to.pp"}}]})
        self.done("-q", self.mesh, self.out, self.edit)
        self.assertEqual(self.out.read_bytes(), whole)
        self.write_edit({"region": {"component": True}, "fit": {"to": "scan.ply", "accuracy": 0},
                         "handles": [{"landmarks": {"from": "from.pp", "to": "to.pp"}}]})
        self.done("-q", self.mesh, self.out, self.edit)
        self.assertLess(error(self.result()), 0.25 * error(DOME[0]))

    def test_a_place_that_the_template_cannot_store_has_advice(self):
        points, faces = scan()
        self.scan.write_bytes(files.ply_plain(([(x + 1e5, y, z) for x, y, z in points], faces), "double"))
        for scalar in ("float", "double"):
            self.mesh.write_bytes(files.ply_plain(DOME, scalar))
            advice = self.fitted()["advice"]
            self.assertEqual("in steps of 0.0119" in advice, scalar == "float", advice)

    def test_a_cloud_with_normals(self):
        points, faces = map(np.array, scan(41))
        sums = normals_of(points, faces)
        for name, numbers, form in (("float", "<6f", "binary_little_endian"), ("double", ">6d", "binary_big_endian")):
            header = f"ply\nformat {form} 1.0\nelement vertex {len(points)}\n" + "".join(
                f"property {name} {key}\n" for key in ("x", "y", "z", "nx", "ny", "nz")) + "end_header\n"
            self.scan.write_bytes(header.encode() + b"".join(struct.pack(numbers, *p, *n) for p, n in zip(points, sums)))
            self.fitted("--landmarks", self.folder / "from.pp", self.folder / "to.pp")
            self.assertLess(error(self.result()), 0.5 * error(DOME[0]), name)

    def test_selected_faces_of_the_scan_are_excluded(self):
        """They have the lid of a box that is not part of the object: without them the fit is as without the lid."""
        points, faces = scan()
        lid = [(x, y, z + 0.15) for x, y, z in points if 0.3 < x < 0.7 and 0.3 < y < 0.7]
        more = [(len(points), len(points) + k, len(points) + k + 1) for k in range(1, len(lid) - 1)]
        results = []
        for selected in (True, False):
            rows = [("Biiii", (3, *f, 0)) for f in faces] + [("Biiii", (3, *f, 32)) for f in more if selected]
            self.scan.write_bytes(files.rows_of_ply("ascii", [
                ("vertex", ["float x", "float y", "float z"], [("fff", p) for p in points + lid]),
                ("face", ["list uchar int vertex_indices", "int flags"], rows)]))
            self.write_edit({"region": {"component": True}, "fit": {"to": "scan.ply", **({"exclude": {"scan_selected": True}} if selected else {})}})
            self.done("-q", self.mesh, self.out, self.edit)
            results.append(self.out.read_bytes())
        self.assertEqual(*results)

    def test_refusals(self):
        self.refused(WRONG_USAGE, "template and the output", "--fit", self.scan, self.mesh)
        self.refused(WRONG_USAGE, "suffixes are", "--fit", "scan.xyz", self.mesh, self.out)
        self.refused(WRONG_USAGE, "same file", "--fit", self.scan, self.mesh, self.scan)
        self.refused(UNREADABLE, "missing.ply", "--fit", "missing.ply", self.mesh, self.out)
        (self.folder / "other.pp").write_text(picked({"nose": TRUTH[CENTRE], "chin": TRUTH[0]}))
        self.refused(REFUSED, "paired by name", "--fit", self.scan, "--landmarks", self.folder / "from.pp", self.folder / "other.pp", self.mesh, self.out)
        for targets in ([[0, 0, 0]], [[0, 0, 0]] * 3):
            self.write_edit({"region": {"component": True}, "fit": {"to": "scan.ply"}, "handles": [{"vertices": "1-2", "targets": targets}]})
            self.refused(REFUSED, "targets", self.mesh, self.out, self.edit)
        self.write_edit({"region": {"component": True}, "fit": {"to": "far.ply", "align": "none", "distance": 1}})
        (self.folder / "far.ply").write_bytes(files.ply_plain(([(x + 100, y, z) for x, y, z in TRUTH], DOME[1])))
        self.refused(REFUSED, "no partner", self.mesh, self.out, self.edit)
        for x in (0, 2):
            (self.folder / "triangle.ply").write_bytes(files.ply_plain(([(0, 0, 0), (1, 0, 0), (x, 2 - x, 0)], [(0, 1, 2)])))
            self.refused(REFUSED, "The region of the fit has a single triangle, or none with an area: give",
                         "--fit", self.scan, self.folder / "triangle.ply", self.out)
        self.scan.write_bytes(files.ply_plain((DOME[0], [])))
        self.refused(REFUSED, "neither faces nor normals", "--fit", self.scan, self.mesh, self.out)
        self.scan.write_bytes(files.ply_plain(([], [])))
        self.refused(REFUSED, "no points", "--fit", self.scan, self.mesh, self.out)


if __name__ == "__main__":
    unittest.main()
