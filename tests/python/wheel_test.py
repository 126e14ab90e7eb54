# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel with a PyMeshLab from PyPI. Run by wheel_test.sh in the environment that has both.

Environment:
  LAPEDIT_PYMESHLAB  the release that is installed, such as 2025.7
  LAPEDIT_COMMAND    laplacian-edit
  LAPEDIT_MESHES     folder of the real meshes, may be empty
"""
import concurrent.futures
import importlib.metadata
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
from xml.sax.saxutils import quoteattr

import numpy
import pymeshlab

import pymeshlab_laplacian_edit as package
from pymeshlab_laplacian_edit import _plugin

HERE = pathlib.Path(__file__).resolve().parent
PROJECT = HERE.parent.parent
sys.path.insert(0, str(PROJECT / "tests/hosts"))

import ply_meshes  # noqa: E402

MESHES = os.environ["LAPEDIT_MESHES"]
PULL = {"region": {"radius": 9}, "handles": [{"vertices": "220", "translation": [0.5, 0, 4]}]}


def grid(n=21):
    """A bumpy square of n x n vertices in single precision, so that all hosts read the same."""
    x, y = numpy.meshgrid(numpy.arange(n), numpy.arange(n))
    z = numpy.sin(x * 0.7) * numpy.cos(y * 0.9) * 0.3
    points = numpy.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(numpy.float32).astype(float)
    corner = (numpy.arange(n - 1)[:, None] * n + numpy.arange(n - 1)).ravel()
    faces = numpy.concatenate([numpy.stack([corner, corner + 1, corner + n + 1], axis=1),
                               numpy.stack([corner, corner + n + 1, corner + n], axis=1)])
    return points, faces


def mesh_set(points=None, faces=None):
    made = pymeshlab.MeshSet()
    made.add_mesh(pymeshlab.Mesh(*(grid() if points is None else (points, faces))))
    return made


def vertices(of):
    return of.current_mesh().vertex_matrix()


def program(mesh, out, edit, fraction=1.0):
    """Lets laplacian-edit make a file, which has single precision. @return its report"""
    text, report = out + ".json", out + ".report"
    pathlib.Path(text).write_text(json.dumps(edit), encoding="utf-8")
    subprocess.run([os.environ["LAPEDIT_COMMAND"], "-q", "--fraction", str(fraction), "--report", report, mesh, out, text],
                   check=True)
    return json.loads(pathlib.Path(report).read_text(encoding="utf-8"))


def loaded(mesh):
    made = pymeshlab.MeshSet()
    made.load_new_mesh(mesh)
    return made


class Wheel(unittest.TestCase):
    def compare(self, mesh, edit, fraction):
        with tempfile.TemporaryDirectory() as folder:
            # The mesh in single precision, which both read alike.
            common, out = os.path.join(folder, "in.ply"), os.path.join(folder, "out.ply")
            ply_meshes.write(pathlib.Path(common), *mesh)
            other = program(common, out, edit, fraction)
            here, expected = loaded(common), vertices(loaded(out))
        before = vertices(here)
        report = package.edit(here, edit, fraction)
        after = vertices(here)
        self.assertEqual(after.shape, expected.shape)
        # Of a single step nothing but the last rounding differs.
        step = numpy.spacing(numpy.abs(expected).max(axis=1, keepdims=True).astype(numpy.float32)).astype(float)
        self.assertLessEqual((numpy.abs(after - expected) / step).max(), 0.51 if len(edit["steps"]) == 1 else 4.0)
        self.assertGreater(numpy.abs(after - before).max(), 1e-3)
        same = ("mesh_vertices", "handle", "free", "anchors", "fixed", "method", "laplacian", "order", "solver")
        self.assertEqual([[one[key] for key in same] for one in report["steps"]],
                         [[one[key] for key in same] for one in other["outputs"][0]["steps"]])
        self.assertEqual(set(report["steps"][0]), set(other["outputs"][0]["steps"][0]))
        self.assertEqual(report["mesh"], other["mesh"])

    def test_generated_mesh_as_the_program(self):
        self.compare(grid(), {"laplacian_edit": 1, "steps": [PULL]}, 1.0)

    def test_vertices_at_the_same_place_stay_together(self):
        points, faces = grid()
        corners = faces.ravel()
        soup = points[corners], numpy.arange(len(corners)).reshape(-1, 3)
        step = {"region": {"radius": 9}, "handles": [{"points": [points[220].tolist()], "translation": [0.5, 0, 4]}]}
        one, other, apart = mesh_set(*soup), mesh_set(), mesh_set(*soup)
        for made, weld in ((one, True), (other, True), (apart, False)):
            package.edit(made, {"steps": [{**step, "weld": weld}]})
        numpy.testing.assert_allclose(vertices(one), vertices(other)[corners], atol=1e-9)
        self.assertGreater(numpy.abs(vertices(apart) - vertices(one)).max(), 0.1)

    @unittest.skipUnless(MESHES, "needs the real meshes")
    def test_recorded_edits_as_the_program(self):
        count = 0
        for edit in sorted((PROJECT / "tests/hosts/edits").glob("*/*.json")):
            mesh = pathlib.Path(MESHES, edit.parent.name)
            if mesh.exists() and mesh.suffix in (".off", ".ply"):
                with self.subTest(edit=str(edit)):
                    self.compare(ply_meshes.read(mesh), json.loads(edit.read_text(encoding="utf-8")), 0.37 if count % 2 else 1.0)
                    count += 1
        self.assertGreater(count, 20)

    def test_arrays_are_taken(self):
        numbers = numpy.array([219, 220, 221], dtype=numpy.int32)
        targets = grid()[0][numbers] + [0, 0, numpy.float64(3)]
        matrix = numpy.eye(4)
        matrix[2, 3] = 3
        results = []
        for handle in ({"vertices": numbers, "targets": targets}, {"vertices": "219-221", "targets": targets.tolist()},
                       {"vertices": numbers, "matrix": matrix}, {"vertices": "219-221", "matrix": matrix.ravel().tolist()},
                       {"vertices": list(numbers), "matrix": matrix.ravel(), "weights": numpy.ones(3)}):
            one = mesh_set()
            package.edit(one, {"steps": [{"region": {"radius": numpy.float64(9)}, "handles": [handle]}]})
            results.append(vertices(one))
        numpy.testing.assert_array_equal(results[0], results[1])
        for other in results[3:]:
            numpy.testing.assert_array_equal(results[2], other)
        numpy.testing.assert_allclose(results[2][220], grid()[0][220] + [0, 0, 3], atol=1e-2)

    def test_refusals_change_nothing(self):
        one = mesh_set()
        before = vertices(one), one.current_mesh().vertex_normal_matrix()
        for edit, why in (({"steps": [{**PULL, "handles": [{"vertices": [4410]}]}]}, "^Handle vertex 4410 does not exist"),
                          ({"steps": [{"regio": 1}]}, 'unknown key "regio"'), ({"steps": []}, "step"),
                          ({"steps": [PULL], "mesh": {"vertices": 440}}, "440")):
            with self.assertRaisesRegex(package.EditRefused, why):
                package.edit(one, edit)
        with self.assertRaisesRegex(package.EditRefused, "fraction"):
            package.edit(one, {"steps": [PULL]}, 1.5)
        with self.assertRaisesRegex(TypeError, "1.5 is no integer"):
            package.edit(one, {"steps": [{**PULL, "handles": [{"vertices": [1.5]}]}]})
        with self.assertRaises(ValueError):
            package.edit(one, {"steps": [{**PULL, "membrane": float("nan")}]})
        with self.assertRaisesRegex(package.EditRefused, "0 layers"):
            package.edit(pymeshlab.MeshSet(), {"steps": [PULL]})
        numpy.testing.assert_array_equal(before[0], vertices(one))
        numpy.testing.assert_array_equal(before[1], one.current_mesh().vertex_normal_matrix())
        # The set works as before.
        package.edit(one, {"steps": [PULL]})
        other = mesh_set()
        package.edit(other, {"steps": [PULL]})
        numpy.testing.assert_array_equal(vertices(one), vertices(other))
        one.apply_filter("meshing_invert_face_orientation")

    def test_only_the_current_mesh(self):
        one = mesh_set()
        one.add_mesh(pymeshlab.Mesh(*grid()))
        package.edit(one, {"steps": [PULL]})
        numpy.testing.assert_array_equal(one.mesh(0).vertex_matrix(), grid()[0])
        self.assertGreater(numpy.abs(one.mesh(1).vertex_matrix() - grid()[0]).max(), 3)

    def test_threads(self):
        def edited(height):
            one = mesh_set()
            step = {**PULL, "handles": [{"vertices": [220], "translation": [0, 0, height]}]}
            report = package.edit(one, {"steps": [step]})
            return vertices(one)[220, 2], report["steps"][0]["handle_displacement"]

        heights = [0.25 * k for k in range(1, 17)]
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for height, (z, displacement) in zip(heights, pool.map(edited, heights)):
                self.assertAlmostEqual(z, grid()[0][220, 2] + height, delta=0.01)
                self.assertAlmostEqual(displacement, height, places=9)

    def test_second_import(self):
        count = pymeshlab.filter_list().count("apply_coord_laplacian_editing_replay")
        self.assertEqual(count, 1)
        for name in [name for name in sys.modules if name.startswith("pymeshlab_laplacian_edit")]:
            del sys.modules[name]
        import pymeshlab_laplacian_edit as again  # pylint: disable=import-outside-toplevel,reimported
        self.assertIsNot(again, package)
        self.assertEqual(pymeshlab.filter_list().count("apply_coord_laplacian_editing_replay"), 1)
        again.edit(mesh_set(), {"steps": [PULL]})

    def test_another_version_is_refused(self):
        self.assertIn(os.environ["LAPEDIT_PYMESHLAB"], package.SUPPORTED)
        for version in ("2021.10", "2025.70", "2026.1.post1", "dev"):
            with self.assertRaisesRegex(ImportError, f"^PyMeshLab {re.escape(version)} is installed, but .* 2022.2, 2025.7 only"):
                _plugin.plugin_path(version)
        other = next(each for each in package.SUPPORTED if each != os.environ["LAPEDIT_PYMESHLAB"])
        before = len(pymeshlab.filter_list())
        with self.assertRaises(pymeshlab.PyMeshLabException):
            pymeshlab.load_plugin(str(_plugin.plugin_path(other)))
        self.assertEqual(len(pymeshlab.filter_list()), before)

    def test_numpy_that_crashes_pymeshlab_is_refused(self):
        _plugin.require_numpy("2022.2.post4", "1.26.4")
        _plugin.require_numpy("2025.7", "2.4.6")
        with self.assertRaisesRegex(ImportError, "^PyMeshLab 2022.2.post4 crashes with NumPy 2.4.6: pip install 'numpy<2'"):
            _plugin.require_numpy("2022.2.post4", "2.4.6")

    def test_readme(self):
        """The examples of both documents run as they are printed."""
        for document, printed in (("filter_laplacian_edit/python/README.md", r"\d+ free vertices; 0\.\d+\n.*step.*\n"),
                                  ("README.md", r"0\.\d+\n")):
            with self.subTest(document=document):
                example = re.search(r"```python\n(.*?)```", (PROJECT / document).read_text("utf-8"), re.DOTALL)[1]
                done = subprocess.run([sys.executable, "-c", example], check=True, capture_output=True, text=True)
                self.assertRegex(done.stdout, rf"^{printed}$")

    def test_filter_of_its_own(self):
        one = mesh_set()
        figures = one.apply_filter("apply_coord_laplacian_editing", handle_source=2, handle_vertex=220,
                                   translation=numpy.array([0.0, 0.0, 4.0]))
        self.assertEqual(figures["handle"], 1)

    def test_filter_script(self):
        """A script of MeshLab's window or meshlabserver."""
        text = json.dumps({"laplacian_edit": 1, "steps": [PULL]})
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "edit.mlx")
            path.write_text('<!DOCTYPE FilterScript><FilterScript><filter name="Laplacian Edit Replay">'
                            f'<Param type="RichString" name="edit" value={quoteattr(text)}/>'
                            '<Param type="RichFloat" name="fraction" value="1"/></filter></FilterScript>', encoding="utf-8")
            one, other = mesh_set(), mesh_set()
            one.load_filter_script(str(path))
        one.apply_filter_script()
        package.edit(other, {"steps": [PULL]})
        numpy.testing.assert_array_equal(vertices(one), vertices(other))
        self.assertGreater(numpy.abs(vertices(one) - grid()[0]).max(), 3)

    def test_what_is_in_it(self):
        files = [str(file) for file in importlib.metadata.files("meshlab-laplacian-edit")]
        libraries = [name for name in files if ".so" in name]
        self.assertEqual(len(libraries), len(package.SUPPORTED), libraries)
        self.assertIn("pymeshlab_laplacian_edit/py.typed", files)
        for name in libraries:
            path = pathlib.Path(_plugin.__file__).parent.parent / name
            text = subprocess.run(["readelf", "-d", path], check=True, capture_output=True, text=True).stdout
            self.assertNotRegex(text, r"R(UN)?PATH|blas|libOpenGL")


if __name__ == "__main__":
    unittest.main()
