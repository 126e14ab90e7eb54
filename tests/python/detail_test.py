# SPDX-License-Identifier: GPL-3.0-or-later
"""The key `detail`: dents and bumps are removed or exaggerated, with and without a handle. Run by run.sh."""
import unittest

import numpy
import trimesh

from laplacian_edit import EditRefused, edit

DEPTH = 0.3


def plate(n=25):
    """An uneven plate with a dent in its middle."""
    x, y = (axis.ravel() for axis in numpy.meshgrid(*2 * [numpy.linspace(-1, 1, n)]))
    inner = (abs(x) < 0.99) & (abs(y) < 0.99)
    random = numpy.random.default_rng(7)
    x, y = (axis + inner * random.uniform(-0.3, 0.3, axis.size) * 2 / n for axis in (x, y))
    corner = (numpy.arange(n - 1)[:, None] * n + numpy.arange(n - 1)).ravel()
    faces = numpy.concatenate([numpy.stack([corner, corner + 1, corner + n + 1], axis=1),
                               numpy.stack([corner, corner + n + 1, corner + n], axis=1)])
    return numpy.stack([x, y, -DEPTH * numpy.exp(-(x * x + y * y) / 0.0625)], axis=1), faces


def within(points, radius=0.85):
    return {"vertices": numpy.hypot(points[:, 0], points[:, 1]) < radius}


def changed(mesh, detail, fraction=1.0, **keys):
    step = {"region": within(mesh[0]), "detail": detail, **keys}
    return edit(*mesh, {"steps": [step]}, fraction=fraction).vertices


class Detail(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = plate()
        cls.points, cls.faces = cls.mesh

    def test_a_dent_becomes_flat(self):
        for method in ("default", "linear", "paper"):
            with self.subTest(method=method):
                flat = changed(self.mesh, 0, method=method)
                self.assertLess(abs(flat[:, 2]).max(), 0.01 * DEPTH)
                outside = ~within(self.points)["vertices"]
                self.assertEqual(flat[outside].tobytes(), self.points[outside].tobytes())

    def test_a_bump_on_a_sphere_becomes_round(self):
        sphere = trimesh.creation.icosphere(subdivisions=4)
        height = sphere.vertices[:, 2]
        bump = 0.1 * numpy.exp(-(numpy.arccos(numpy.clip(height, -1, 1)) / 0.15)**2)
        points = sphere.vertices * (1 + bump)[:, None]
        step = {"region": {"vertices": height > numpy.cos(0.6)}, "detail": 0}
        after = edit(points, sphere.faces, {"steps": [step]}).vertices
        self.assertLess(abs(numpy.linalg.norm(after, axis=1) - 1).max(), 0.02)

    def test_the_change_is_linear_in_the_number_and_in_the_fraction(self):
        change = changed(self.mesh, 0) - self.points
        for detail in (0.5, 1.25, 2):
            expected = self.points + (1 - detail) * change
            numpy.testing.assert_allclose(changed(self.mesh, detail), expected, atol=1e-14)
        numpy.testing.assert_allclose(changed(self.mesh, 0, fraction=0.25), self.points + 0.25 * change, atol=1e-14)

    def test_one_changes_no_bit(self):
        pull = {"handles": [{"points": [[0.3, 0.2, 0]], "translation": [0, 0.1, 0.3]}], "method": "default"}
        step = {"region": within(self.points), **pull}
        self.assertEqual(changed(self.mesh, 1, **pull).tobytes(), edit(*self.mesh, {"steps": [step]}).vertices.tobytes())

    def test_handles_reach_their_targets(self):
        way = numpy.array([0, 0.1, 0.4])
        vertex = int(numpy.hypot(self.points[:, 0] - 0.2, self.points[:, 1]).argmin())
        for detail in (0, 1, 2):
            after = changed(self.mesh, detail, handles=[{"vertices": [vertex], "translation": way.tolist()}])
            self.assertLess(numpy.linalg.norm(after[vertex] - self.points[vertex] - way), 0.005 * numpy.linalg.norm(way))
        held = changed(self.mesh, 0, handles=[{"vertices": [vertex]}])
        self.assertLess(numpy.linalg.norm(held[vertex] - self.points[vertex]), 0.005 * DEPTH)

    def test_a_rotated_scaled_mirrored_mesh_gives_the_same(self):
        flat = changed(self.mesh, 0)
        turn = trimesh.transformations.euler_matrix(0.3, 0.5, 0.8)[:3, :3]
        for linear in (turn, 1000 * turn, numpy.diag([1, 1, -1])):
            faces = self.faces if numpy.linalg.det(linear) > 0 else self.faces[:, ::-1]
            step = {"region": within(self.points), "detail": 0}
            after = edit(self.points @ linear.T, faces, {"steps": [step]}).vertices
            numpy.testing.assert_allclose(after, flat @ linear.T, atol=1e-8 * abs(linear).max())

    def test_both_sides_of_a_mirror(self):
        points = self.points + [3, 0, 0]
        both = numpy.concatenate([points, points * [-1, 1, 1]])
        faces = numpy.concatenate([self.faces, self.faces[:, ::-1] + len(points)])
        chosen = numpy.concatenate([within(self.points)["vertices"], numpy.zeros(len(points), bool)])
        step = {"region": {"vertices": chosen}, "mirror": {"point": [0, 0, 0], "normal": [1, 0, 0]}, "detail": 0}
        after = edit(both, faces, {"steps": [step]}).vertices
        self.assertLess(abs(after[:, 2]).max(), 0.01 * DEPTH)

    def test_refusals_say_what_to_do(self):
        for step, part in (({"region": {"radius": 0.8}, "detail": 0}, "vertices, within or selected"),
                           ({"region": {"component": True}, "detail": 0}, "vertices, within or selected"),
                           ({"region": {"vertices": numpy.arange(len(self.points))}, "detail": 0}, "smaller region"),
                           ({"region": within(self.points), "detail": 2.5}, "from 0 to 2"),
                           ({"region": within(self.points), "handles": []}, "handle groups"),
                           ({"region": {"component": True}, "handles": [{"vertices": [0]}], "detail": 0}, "vertices that stay")):
            with self.subTest(step=part), self.assertRaisesRegex(EditRefused, part):
                edit(*self.mesh, {"steps": [step]})


if __name__ == "__main__":
    unittest.main()
