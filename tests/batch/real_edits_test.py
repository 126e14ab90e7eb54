# SPDX-License-Identifier: GPL-3.0-or-later
"""The edits that the real meshes' own notes propose, through meshlabserver or laplacian-edit."""
import functools
import math
import os
import pathlib
import re
import unittest

from host import HostTest, laplacian_edit
from ply import Ply
from shapes import neighbours, within

MESHES = pathlib.Path(os.environ["LAPEDIT_MESHES"])

HANDLE_MISS = 0.005  # of the handle's displacement: what the default weights promise
RIM_JUMP = 0.002  # of the handle's displacement, between the region's rim and the fixed vertex next to it


class RealEdits(HostTest):
    @classmethod
    @functools.lru_cache(maxsize=None)
    def original(cls, name):
        """What the host makes of the mesh without an edit: its numbers, its precision."""
        case = cls()
        path, _ = case.edited([], MESHES / name)
        mesh = Ply(path)
        return mesh, mesh.points(), neighbours(len(mesh.points()), mesh.faces())

    def check(self, name, handle, radius, size, translation, **settings):
        """@param size  number of the region's vertices as the notes give it, for a radius of fewer digits"""
        before, points, around = self.original(name)
        path, log = self.edited(
            [laplacian_edit(handle_point=points[handle], radius=radius, translation=translation, **settings)],
            MESHES / name)
        after = Ply(path)
        new_points = after.points()
        region = within(points, around, handle, radius)
        self.assertAlmostEqual(len(region), size, delta=3)
        classes = [int(n) for n in re.search(r"(\d+) handle, (\d+) free, (\d+) anchor vertices", log).groups()]
        self.assertEqual(sum(classes), len(region))
        self.assertEqual(classes[0], 1)

        self.assertEqual(after.faces(), before.faces())
        fixed = [v for v in range(len(points)) if v not in region]
        bits, new_bits = before.point_bits(), after.point_bits()
        self.assertEqual([v for v in fixed if bits[v] != new_bits[v]], [])
        self.assertTrue(all(map(math.isfinite, (c for p in new_points for c in p))))

        way = math.hypot(*translation)
        target = [p + t for p, t in zip(points[handle], translation)]
        self.assertLess(math.dist(new_points[handle], target), HANDLE_MISS * way)
        rim = [v for v in region if any(w not in region for w in around[v])]
        jump = max((math.dist(points[v], new_points[v]) for v in rim), default=0.0)
        self.assertLess(jump, RIM_JUMP * way, f"{100 * jump / way:.3f} %")
        return region, points, new_points

    def test_mannequin_small_region_of_the_paper(self):
        region, _, _ = self.check("mannequin.off", 8624, 0.61167, 1201, (0, -0.9, 0))
        self.assertEqual(len(region), 1201)

    def test_mannequin_large_region_of_the_paper(self):
        region, _, _ = self.check("mannequin.off", 8624, 1.2155, 3395, (0, -0.9, 0))
        self.assertEqual(len(region), 3395)

    def test_mannequin_pulled_by_thirty_percent(self):
        self.check("mannequin.off", 8624, 1.2155, 3395, (0, -1.29, 0))

    def test_octopus_most_of_a_tentacle(self):
        self.check("octopus.off", 3175, 0.6, 1385, (0, 0.437, 0))

    def test_octopus_whole_tentacle(self):
        self.check("octopus.off", 3175, 0.8, 1818, (0, 0.437, 0))

    def test_octopus_about_the_paper_s_region(self):
        self.check("octopus.off", 3175, 0.985, 4684, (0, 0.437, 0))

    def test_octopus_most_of_the_body(self):
        self.check("octopus.off", 3175, 1.4352, 12774, (0, 0.437, 0))

    def test_octopus_body_without_rim(self):
        self.check("octopus.off", 3175, 1.74, 16554, (0, 0.437, 0))

    def test_octopus_body_without_anchors_follows_its_handle(self):
        region, points, new_points = self.check("octopus.off", 3175, 1.74, 16554, (0, 0.437, 0), padding=0)
        for v in region:
            self.assertLess(math.dist(new_points[v], [points[v][0], points[v][1] + 0.437, points[v][2]]), 2e-7)

    def test_bumpy_plane_small_hill(self):
        self.check("bumpy_plane.off", 20200, 30, 5949, (0, 0, 42.5))

    def test_bumpy_plane_large_hill(self):
        self.check("bumpy_plane.off", 20200, 40, 11217, (0, 0, 42.5))

    def test_bumpy_plane_with_the_paper_s_size_reaches_the_open_border(self):
        self.check("bumpy_plane.off", 20200, 65.24, 32280, (0, 0, 42.5))

    def test_bunny_s_ear_on_a_mesh_with_isolated_vertices(self):
        self.check("bunny.ply", 23637, 0.06, 1905, (0.03, -0.05, 0.03))

    def test_igea_s_nose(self):
        self.check("igea.ply", 31536, 0.02, 5482, (0, 0, 0.02))

    def test_igea_s_nose_with_a_large_region(self):
        self.check("igea.ply", 31536, 0.0374, 20000, (0, 0, 0.02))


if __name__ == "__main__":
    unittest.main()
