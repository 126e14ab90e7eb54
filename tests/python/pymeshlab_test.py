# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package with a PyMeshLab from PyPI. Run by run.sh in the environment that has both."""
import concurrent.futures
import unittest

import numpy
import pymeshlab

import laplacian_edit.pymeshlab
from laplacian_edit import EditRefused
from package_test import PULL, grid, with_handle


def mesh_set(points=None, faces=None, **attributes):
    made = pymeshlab.MeshSet()
    made.add_mesh(pymeshlab.Mesh(*(grid() if points is None else (points, faces)), **attributes))
    return made


def vertices(of):
    return of.current_mesh().vertex_matrix()


class PyMeshLab(unittest.TestCase):
    def test_as_arrays(self):
        for text in ({"steps": [PULL]}, {"steps": [PULL, {**PULL, "method": "paper"}]}):
            for fraction in (1.0, 0.3):
                one = mesh_set()
                report = laplacian_edit.pymeshlab.edit(one, text, fraction)
                expected = laplacian_edit.edit(*grid(), text, fraction=fraction)
                numpy.testing.assert_array_equal(vertices(one), expected.vertices)  # but for the sign of a zero
                self.assertEqual(report["steps"][0]["free"], expected.report["steps"][0]["free"])

    def test_coordinates_of_all_sizes(self):
        """PyMeshLab's filter writes them to the bit."""
        points, faces = grid()
        points = (points + 1000.123) * numpy.array([1e-9, 1, 1e9])
        text = with_handle(vertices=220, translation=[1e-9, 2.7, 1e9 / 3])
        text["steps"][0]["region"] = {"component": True}
        text["steps"][0]["handles"].append({"vertices": "0"})
        one = mesh_set(points, faces)
        laplacian_edit.pymeshlab.edit(one, text)
        numpy.testing.assert_array_equal(vertices(one), laplacian_edit.edit(points, faces, text).vertices)

    def test_everything_else_stays(self):
        points, faces = grid()
        values = numpy.random.default_rng(1)
        one = mesh_set(points, faces, v_color_matrix=values.random((441, 4)), v_scalar_array=values.random(441),
                       f_color_matrix=values.random((800, 4)), f_scalar_array=values.random(800))
        one.add_mesh(pymeshlab.Mesh(*grid(5)), "other")
        one.set_current_mesh(0)
        one.compute_texcoord_by_function_per_wedge()
        one.compute_selection_by_condition_per_vertex(condselect="x < 7")
        one.compute_selection_by_condition_per_face(condselect="y0 < 7")
        one.compute_matrix_from_translation(axisx=3.0, freeze=False)
        one.set_mesh_name(newname="mine")

        def state():
            mesh = one.current_mesh()
            return [array.tobytes() for array in (
                mesh.vertex_color_matrix(), mesh.vertex_scalar_array(), mesh.face_color_matrix(), mesh.face_scalar_array(),
                mesh.wedge_tex_coord_matrix(), mesh.vertex_selection_array(), mesh.face_selection_array(), mesh.face_matrix(),
                (mesh.transform_matrix if hasattr(mesh, "transform_matrix") else mesh.trasform_matrix)(),
                one.mesh(1).vertex_matrix())] + [mesh.label(), one.current_mesh_id(), mesh.is_visible(), mesh.bounding_box().max()[0]]

        before = state()
        laplacian_edit.pymeshlab.edit(one, {"steps": [PULL]})
        self.assertEqual(state(), before)
        numpy.testing.assert_array_equal(vertices(one), laplacian_edit.edit(points, faces, {"steps": [PULL]}).vertices)
        self.assertEqual(one.mesh_number() if hasattr(one, "mesh_number") else one.number_meshes(), 2)
        # The set works as before.
        laplacian_edit.pymeshlab.edit(one, {"steps": [PULL]})
        one.set_current_mesh(1)
        one.delete_current_mesh()
        one.apply_filter("meshing_invert_face_orientation")

    def test_normals_are_those_of_the_new_shape(self):
        one = mesh_set()
        laplacian_edit.pymeshlab.edit(one, {"steps": [PULL]})
        other = mesh_set(vertices(one), one.current_mesh().face_matrix())
        other.compute_normal_per_vertex()
        unit = [each / numpy.linalg.norm(each, axis=1, keepdims=True)
                for each in (one.current_mesh().vertex_normal_matrix(), other.current_mesh().vertex_normal_matrix())]
        self.assertGreater((unit[0] * unit[1]).sum(axis=1).min(), 0.98)

    def test_selection(self):
        step = {"region": {"selected": True}, "handles": [{"vertices": 220, "translation": [0, 0, 3]}]}
        one = mesh_set()
        one.compute_selection_by_condition_per_vertex(condselect="x > 3 && x < 17 && y > 3 && y < 17")
        chosen = one.current_mesh().vertex_selection_array()
        laplacian_edit.pymeshlab.edit(one, {"steps": [step]})
        expected = laplacian_edit.edit(*grid(), {"steps": [{**step, "region": {"vertices": chosen}}]}).vertices
        numpy.testing.assert_array_equal(vertices(one), expected)

    def test_fit(self):
        points, faces = grid()
        text = {"steps": [{"region": {"component": True}, "fit": {"to": "scan", "align": "none"}}]}
        one = mesh_set()
        laplacian_edit.pymeshlab.edit(one, text, scans={"scan": (points * [1, 1, 2], faces)})
        expected = laplacian_edit.edit(points, faces, text, scans={"scan": (points * [1, 1, 2], faces)}).vertices
        numpy.testing.assert_array_equal(vertices(one), expected)
        self.assertGreater(numpy.abs(expected - points).max(), 0.1)

    def test_refusals_change_nothing(self):
        one = mesh_set()
        before = vertices(one)
        cloud = pymeshlab.MeshSet()
        cloud.add_mesh(pymeshlab.Mesh(grid()[0]))
        empty = mesh_set()
        empty.set_selection_all()
        empty.meshing_remove_selected_vertices_and_faces()
        for given, text, why in ((one, with_handle(vertices=[4410]), "vertex 4410 is outside the edit"), (one, {"steps": []}, "^steps: "),
                                 (one, {"steps": [{**PULL, "region": {"selected": True}}]}, "selected"),
                                 (pymeshlab.MeshSet(), {"steps": [PULL]}, "^mesh_set: there are 0 layers"),
                                 (empty, {"steps": [PULL]}, "vertices"), (cloud, {"steps": [PULL]}, "faces"),
                                 (object(), {"steps": [PULL]}, "^mesh_set: .* is no MeshSet")):
            with self.assertRaisesRegex(EditRefused, why) as caught:
                laplacian_edit.pymeshlab.edit(given, text)
            self.assertNotIn("Failed to apply", str(caught.exception))
        numpy.testing.assert_array_equal(vertices(one), before)
        laplacian_edit.pymeshlab.edit(one, {"steps": [PULL]})
        self.assertGreater(numpy.abs(vertices(one) - before).max(), 3)

    def test_unused_and_infinite_vertices(self):
        points, faces = grid()
        points[440] = numpy.nan
        faces = faces[~(faces == 440).any(axis=1)]
        one = mesh_set(points, faces)
        if len(vertices(one)) == 441:
            with self.assertRaisesRegex(EditRefused, "not finite"):
                laplacian_edit.pymeshlab.edit(one, {"steps": [PULL]})

    def test_threads(self):
        def edited(height):
            one = mesh_set()
            laplacian_edit.pymeshlab.edit(one, with_handle(vertices=[220], translation=[0, 0, height]))
            return vertices(one)[220, 2]

        heights = [0.25 * k for k in range(1, 17)]
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for height, z in zip(heights, pool.map(edited, heights)):
                self.assertAlmostEqual(z, grid()[0][220, 2] + height, delta=0.01)


if __name__ == "__main__":
    unittest.main()
