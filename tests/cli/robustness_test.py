# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes with the faults of real scans: the edit works wherever the mathematics allows."""
import math
import unittest

from host import CENTRE, UP, FilterHost, laplacian_edit
from ply import Ply, bits_of, float_of, write_ply
from shapes import dome, in_reach, neighbours, within

RADIUS = 0.35


class RobustnessTest(FilterHost):
    def check(self, points, faces, log_says="^"):
        """Lifts the middle of the dome that the mesh begins with, with both operators."""
        mesh = write_ply(self.folder / "faulty.ply", points, faces)
        triangles = [f for f in faces if len(set(f)) == 3]
        reached = within(points, neighbours(len(points), triangles), CENTRE, RADIUS)
        possible = in_reach(points, CENTRE, RADIUS)
        for laplacian in (1, 2):
            path, log = self.edited([laplacian_edit(handle_point=points[CENTRE], radius=RADIUS, translation=UP,
                                                    laplacian=laplacian)], mesh, save=["vn"])
            self.assertIn("1 handle", log)
            self.assertRegex(log, log_says if laplacian == 2 else "^")
            after = Ply(path)
            bits = after.point_bits()
            self.assertEqual(len(bits), len(points))
            for v, (row, before) in enumerate(zip(bits, points)):
                if v in possible:
                    self.assertTrue(all(math.isfinite(float_of(c)) for c in row), f"vertex {v}")
                else:  # the reader of a text chooses the payload of a NaN
                    self.assertEqual([c if n == n else n == n for c, n in zip(row, map(float_of, row))],
                                     [bits_of(n) if n == n else n == n for n in before], f"vertex {v}")
            target = [c + t for c, t in zip(points[CENTRE], UP)]
            self.assertLess(math.dist(target, [float_of(c) for c in bits[CENTRE]]), 0.002)
            normals = after.elements["vertex"]
            for name in ("nx", "ny", "nz"):
                for v in reached:
                    self.assertTrue(math.isfinite(float_of(normals[name][v])), f"normal of vertex {v}")

    def test_non_finite_coordinates_outside_the_region(self):
        points, faces = dome()
        points[0] = (math.nan, 0, 0)
        points[20] = (0, math.inf, 0)
        points[440] = (math.nan, math.nan, math.nan)
        self.check(points, faces)

    def test_faces_without_area(self):
        points, faces = dome()
        a, b = CENTRE + 2, CENTRE + 3
        points[a], points[b] = (0.5, 0.59375, 0.3125), (0.5, 0.65625, 0.25)
        points.append((0.5, 0.625, 0.28125))  # on the edge ab, without any rounding
        faces.append((a, len(points) - 1, b))
        self.check(points, faces, r"edges at degenerate triangles")

    def test_edges_without_length_and_duplicated_vertices(self):
        points, faces = dome()
        a = CENTRE + 2
        points.append(points[a])  # a sliver of no width between a and its double
        faces.append((a, len(points) - 1, a + 1))
        self.check(points, faces, r"; 1 more at the places of these move along")

    def test_faces_that_are_no_manifold(self):
        points, faces = dome()
        fin = [(CENTRE + 1, CENTRE + 2, 441), (CENTRE + 1, CENTRE + 2, 442), (CENTRE + 2, 442, 441)]
        for fault, more_points, faulty in (
                ("a vertex twice", [], faces + [(CENTRE, CENTRE, CENTRE + 1), (CENTRE + 2, CENTRE + 2, CENTRE + 2)]),
                ("isolated vertices", [points[CENTRE], (0.5, 0.5, 0.4), (7, 7, 7)], faces),
                ("edges of three faces", [(0.5, 0.5, 0.8), (0.55, 0.5, 0.8)], faces + fin),
                ("orientations", [], [f[::-1] if i % 3 == 0 else f for i, f in enumerate(faces)]),
                ("repeated faces", [], faces + faces[300:340])):
            with self.subTest(fault):
                self.check(points + more_points, faulty)


if __name__ == "__main__":
    unittest.main()
