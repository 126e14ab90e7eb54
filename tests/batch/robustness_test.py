# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes with the faults of real scans: the edit works wherever the mathematics allows."""
import math
import unittest

from host import FilterHost, laplacian_edit
from ply import Ply, bits_of, float_of, write_ply
from shapes import dome, moved, neighbours, together, within

CENTRE = 21 * 10 + 10  # vertex in the middle of the dome
RADIUS = 0.35


class RobustnessTest(FilterHost):
    def check(self, points, faces, log_says=None, **change):
        """Lifts the middle of the dome that the mesh begins with, with both operators. @return the last result"""
        mesh = write_ply(self.folder / "faulty.ply", points, faces)
        triangles = [f for f in faces if len(set(f)) == 3]
        reached = within(points, neighbours(len(points), triangles), CENTRE, RADIUS)
        for laplacian in (0, 1):
            path, log = self.edited([laplacian_edit(**{
                "handle_point": points[CENTRE], "radius": RADIUS, "translation": (0, 0, 0.2), "laplacian": laplacian,
                **change})], mesh)
            self.assertIn("1 handle", log)
            if laplacian == 1 and log_says:
                self.assertRegex(log, log_says)
            after = Ply(path)
            bits = after.point_bits()
            self.assertEqual(len(bits), len(points))
            for v, row in enumerate(bits):
                if v not in reached:
                    for now, before in zip(row, points[v]):
                        if math.isnan(before):  # the reader of a text chooses its payload
                            self.assertTrue(math.isnan(float_of(now)), f"vertex {v}")
                        else:
                            self.assertEqual(now, bits_of(before), f"vertex {v}")
                else:
                    self.assertTrue(all(math.isfinite(float_of(c)) for c in row), f"vertex {v}")
            target = [c + t for c, t in zip(points[CENTRE], (0, 0, 0.2))]
            self.assertLess(math.dist(target, [float_of(c) for c in bits[CENTRE]]), 0.002)
            normals = after.elements["vertex"]
            for name in ("nx", "ny", "nz"):
                for v in reached:
                    self.assertTrue(math.isfinite(float_of(normals[name][v])), f"normal of vertex {v}")
        return bits

    def edited(self, filters, mesh, **options):
        return super().edited(filters, mesh, save=("vn",), **options)

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
        self.check(points, faces, r"edges at degenerate triangles")

    def test_faces_that_name_a_vertex_twice(self):
        points, faces = dome()
        self.check(points, faces + [(CENTRE, CENTRE, CENTRE + 1), (CENTRE + 2, CENTRE + 2, CENTRE + 2)])

    def test_isolated_vertices(self):
        points, faces = dome()
        points += [points[CENTRE], (0.5, 0.5, 0.4), (7, 7, 7)]
        bits = self.check(points, faces)
        self.assertEqual(bits[441:], [tuple(map(bits_of, p)) for p in points[441:]])

    def test_non_manifold_edges(self):
        points, faces = dome()
        points += [(0.5, 0.5, 0.8), (0.55, 0.5, 0.8)]
        fin = [(CENTRE + 1, CENTRE + 2, 441), (CENTRE + 1, CENTRE + 2, 442), (CENTRE + 2, 442, 441)]
        self.check(points, faces + fin)

    def test_inconsistent_orientation(self):
        points, faces = dome()
        self.check(points, [f[::-1] if i % 3 == 0 else f for i, f in enumerate(faces)])

    def test_many_components(self):
        mesh = dome()
        for k in range(40):
            mesh = together(mesh, moved(dome(3, 3), 0.2, (0.3 + 0.01 * k, 0.4, 0.3)))
        self.check(*mesh)

    def test_repeated_faces(self):
        points, faces = dome()
        self.check(points, faces + faces[300:340])


if __name__ == "__main__":
    unittest.main()
