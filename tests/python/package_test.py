# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package, installed from its wheel. Run by run.sh in a fresh virtual environment.

Environment:
  LAPEDIT_COMMAND  laplacian-edit, for SameBits
"""
import array
import concurrent.futures
import copy
import importlib.metadata
import json
import mmap
import os
import pathlib
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest

import numpy
import trimesh

import laplacian_edit
from laplacian_edit import EditRefused, Editor, edit

try:
    import pyvista
except ImportError:  # newer than this Python
    pyvista = None

PULL = {"region": {"radius": 9}, "handles": [{"vertices": "220", "translation": [0.5, 0, 4]}]}


def grid(n=21, dtype=float):
    """A bumpy square of n x n vertices, whose coordinates single precision has."""
    x, y = numpy.meshgrid(numpy.arange(n), numpy.arange(n))
    z = numpy.sin(x * 0.7) * numpy.cos(y * 0.9) * 0.3
    points = numpy.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(numpy.float32).astype(dtype)
    corner = (numpy.arange(n - 1)[:, None] * n + numpy.arange(n - 1)).ravel()
    faces = numpy.concatenate([numpy.stack([corner, corner + 1, corner + n + 1], axis=1),
                               numpy.stack([corner, corner + n + 1, corner + n], axis=1)])
    return points, faces


def with_handle(**keys):
    return {"steps": [{"region": {"radius": 9}, "handles": [keys]}]}


def write_ply(path, points, faces):
    kind = {4: "float", 8: "double"}[points.dtype.itemsize]
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
            + "".join(f"property {kind} {name}\n" for name in "xyz")
            + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    body = b"".join(struct.pack(f"<B{len(face)}i", len(face), *face) for face in faces)
    path.write_bytes(head.encode() + points.tobytes() + body)


def program(points, faces, text, fraction=1.0, scan=None):
    """Lets laplacian-edit edit a mesh. @param scan  is scan.ply. @return vertices and report"""
    with tempfile.TemporaryDirectory() as folder:
        mesh, out, report = (pathlib.Path(folder, name) for name in ("in.ply", "out.ply", "report.json"))
        write_ply(mesh, points, faces)
        if scan:
            write_ply(pathlib.Path(folder, "scan.ply"), *scan)
        pathlib.Path(folder, "edit.json").write_text(json.dumps({"laplacian_edit": 1, **text}), encoding="utf-8")
        subprocess.run([os.environ["LAPEDIT_COMMAND"], "-q", "--fraction", str(fraction), "--report", report, mesh, out,
                        pathlib.Path(folder, "edit.json")], check=True)
        data = out.read_bytes()
        start = data.index(b"end_header\n") + len(b"end_header\n")
        after = numpy.frombuffer(data, points.dtype, points.size, start).reshape(points.shape)
        return after, json.loads(report.read_text(encoding="utf-8"))


def figures(report, *others):
    """Returns the figures of a report that depend on the edit alone, not on times and earlier poses."""
    others += ("milliseconds",)
    return [{key: value for key, value in step.items() if key not in others} for step in report["steps"]]


class SameBits(unittest.TestCase):
    EDITS = {
        "pull": {"steps": [PULL]},
        "two steps": {"steps": [PULL, {"region": {"component": True}, "handles": [
            {"vertices": "0-20"}, {"vertices": "420-440", "rotation": {"axis": [1, 0, 0], "degrees": 40, "center": [10, 10, 0]}}]}]},
        "mirror": {"steps": [{**PULL, "mirror": {"point": [8, 0, 0], "normal": [1, 0, 0]}}]},
        "paper": {"steps": [{**PULL, "method": "paper"}]},
        "targets": with_handle(points=[[10, 10, 0], [12, 10, 0]], targets=[[10, 10, 3], [12, 10, 2]]),
    }

    def test_as_the_program(self):
        for dtype in (numpy.float32, numpy.float64):
            for name, text in self.EDITS.items():
                for fraction in (1.0, 0.3):
                    with self.subTest(dtype=dtype, edit=name, fraction=fraction):
                        mesh = grid(dtype=dtype)
                        expected, other = program(*mesh, text, fraction)
                        vertices, report = edit(*mesh, text, fraction=fraction)
                        self.assertEqual(vertices.dtype, dtype)
                        self.assertEqual(vertices.tobytes(), expected.tobytes())
                        self.assertGreater(abs(vertices - mesh[0]).max(), 0.5)
                        self.assertEqual(figures(report), figures(other["outputs"][0]))
                        self.assertEqual(report["mesh"], other["mesh"])

    def test_polygons_as_the_program(self):
        points, faces = grid(dtype=numpy.float32)
        quads = numpy.concatenate([faces[:400], faces[400:, 2:]], axis=1)
        mixed = [list(face) for face in quads[:200]] + [list(face) for k in range(200, 400) for face in
                                                        (quads[k, [0, 1, 2]], quads[k, [0, 2, 3]])]
        flat = numpy.concatenate([[len(face), *face] for face in mixed])
        expected = program(points, mixed, {"steps": [PULL]})[0]
        for given in (mixed, flat, flat.tolist(), iter(mixed)):
            self.assertEqual(edit(points, given, {"steps": [PULL]}).vertices.tobytes(), expected.tobytes())
        expected = program(points, quads.tolist(), {"steps": [PULL]})[0]
        for given in (quads, numpy.insert(quads, 0, 4, axis=1).ravel()):
            # The counts of a file's triangles do not hold for polygons.
            text = {"mesh": {"vertices": 441, "faces": 7}, "steps": [PULL]}
            self.assertEqual(edit(points, given, text).vertices.tobytes(), expected.tobytes())

    def test_a_fit_as_the_program(self):
        template, scan = (trimesh.creation.icosphere(subdivisions=levels) for levels in (2, 3))
        points, faces, shape = numpy.array(template.vertices, numpy.float32), template.faces, scan.vertices * [1, 1.2, 0.9]
        text = {"steps": [{"region": {"component": True}, "fit": {"to": "scan.ply", "align": "none", "detail": 0.1, "exclude": {"vertices": "7-8"}}}]}
        expected = program(points, faces, text, scan=(shape, scan.faces))[0].tobytes()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "edit.json")
            path.write_text(json.dumps({"laplacian_edit": 1, **text}))
            self.assertEqual(edit(points, faces, path, scans={"scan.ply": (shape, scan.faces)}).vertices.tobytes(), expected)
        text["steps"][0]["fit"]["exclude"]["vertices"] = numpy.arange(7, 9)
        for given in ((shape, scan.faces), trimesh.Trimesh(shape, scan.faces, process=False)):
            fitted, report = edit(points, faces, text, scans={"scan.ply": given})
            self.assertEqual(fitted.tobytes(), expected)
        self.assertLess(report["steps"][0]["fit"]["to_scan"]["rms"], 0.05)
        self.assertGreater(numpy.abs(fitted - points).max(), 0.15)
        cloud = edit(points, faces, text, scans={"scan.ply": (shape, None, scan.vertices / [1, 1.2, 0.9])}).vertices
        self.assertLess(numpy.abs(cloud - fitted).max(), 0.05)


class Forms(unittest.TestCase):
    NUMBERS = [219, 220, 221]

    def forms(self):
        mask = numpy.zeros(441, bool)
        mask[self.NUMBERS] = True
        wide = numpy.zeros((3, 2), numpy.int64)
        wide[:, 1] = self.NUMBERS
        return {
            "text": "219-221", "list": self.NUMBERS, "tuple": tuple(self.NUMBERS), "set": set(self.NUMBERS),
            "frozenset": frozenset(self.NUMBERS), "range": range(219, 222), "generator": (k for k in self.NUMBERS),
            "map": map(int, "219 220 221".split()), "dictionary's keys": dict.fromkeys(self.NUMBERS).keys(),
            "nested lists": [[219], [220, 221]], "list of arrays": [numpy.array([219, 220]), numpy.array([221])],
            "mask": mask, "list of booleans": mask.tolist(), "array.array": array.array("i", self.NUMBERS),
            "bytes of an array": memoryview(numpy.array(self.NUMBERS, numpy.int32)), "column": numpy.array(self.NUMBERS)[:, None],
            "strided": wide[:, 1], "reversed twice": numpy.array(self.NUMBERS[::-1])[::-1], "numpy numbers": list(numpy.array(self.NUMBERS)),
            **{f"of {kind}": numpy.array(self.NUMBERS, kind) for kind in ("u2", "i4", "u4", "i8", "u8", ">i4")},
        }

    def test_every_form_of_a_vertex_list(self):
        mesh = grid()
        expected = edit(*mesh, with_handle(vertices="219-221", translation=[0, 0, 3])).vertices.tobytes()
        for name, given in self.forms().items():
            with self.subTest(form=name):
                self.assertEqual(edit(*mesh, with_handle(vertices=given, translation=[0, 0, 3])).vertices.tobytes(), expected)
        with tempfile.TemporaryDirectory() as folder:
            numpy.save(pathlib.Path(folder, "numbers.npy"), self.NUMBERS)
            pathlib.Path(folder, "numbers.txt").write_text("219\n220, 221\n")
            pathlib.Path(folder, "row.txt").write_text("219 220 221\n")
            for name in ("numbers.npy", "row.txt"):
                given = with_handle(vertices=pathlib.Path(folder, name), translation=[0, 0, 3])
                self.assertEqual(edit(*mesh, given).vertices.tobytes(), expected)
        one = edit(*mesh, with_handle(vertices="220", translation=[0, 0, 3])).vertices.tobytes()
        for single in (220, numpy.int64(220), numpy.uint8(220), numpy.array(220)):
            self.assertEqual(edit(*mesh, with_handle(vertices=single, translation=[0, 0, 3])).vertices.tobytes(), one)
        for key in ("held", "vertices"):
            step = {"region": {"vertices": range(441), key: range(441) if key == "vertices" else {0, 440}},
                    "handles": [{"vertices": 220, "translation": (0, 0, 3)}]}
            edit(*mesh, {"steps": [step]})

    def test_every_form_of_points(self):
        points, faces = grid()
        expected = edit(points, faces, with_handle(points=[[10, 10, 0], [12, 10, 0]], targets=[[10, 10, 3], [12, 10, 3]]))
        where, to = numpy.array([[10, 10, 0], [12, 10, 0]]), numpy.array([[10, 10, 3], [12, 10, 3]])
        for form in (lambda a: a, lambda a: a.tolist(), lambda a: tuple(map(tuple, a)), iter, lambda a: a.astype("f4"),
                     lambda a: numpy.asfortranarray(a, float), lambda a: numpy.repeat(a, 2, axis=0)[::2], lambda a: a.astype(">f8"),
                     lambda a: (row for row in a)):
            again = edit(points, faces, with_handle(points=form(where), targets=form(to)))
            self.assertEqual(again.vertices.tobytes(), expected.vertices.tobytes())
        single = edit(points, faces, with_handle(points=numpy.array([10, 10, 0]), translation=numpy.array([0, 0, 3.0]))).vertices
        self.assertAlmostEqual(single[220, 2], points[220, 2] + 3, delta=0.01)
        matrix = numpy.eye(4)
        matrix[2, 3] = 3
        for form in (matrix, matrix.ravel(), matrix.tolist(), numpy.asfortranarray(matrix)):
            moved = edit(points, faces, with_handle(vertices=220, matrix=form, weights=numpy.ones(1))).vertices
            self.assertEqual(moved.tobytes(), single.tobytes())

    def test_every_layout_of_a_mesh(self):
        points, faces = grid()
        expected = edit(points, faces, {"steps": [PULL]}).vertices
        wide = numpy.zeros((441, 5))
        wide[:, 1:4] = points
        read_only = points.copy()
        read_only.flags.writeable = False
        for given in (points.tolist(), numpy.asfortranarray(points), wide[:, 1:4], points[::-1][::-1], read_only, iter(points),
                      points.astype(">f8")):
            for corners in (faces, faces.tolist(), numpy.asfortranarray(faces.astype("u2")), iter(faces)):
                given = given if hasattr(given, "__len__") else iter(points)
                vertices = edit(given, corners, {"steps": [PULL]}).vertices
                self.assertEqual(vertices.shape, (441, 3))
                numpy.testing.assert_array_equal(vertices, expected)
        self.assertEqual(edit(points.astype(">f4"), faces, {"steps": [PULL]}).vertices.dtype, numpy.dtype(">f4"))
        whole = numpy.rint(points).astype(int)
        self.assertEqual(edit(whole, faces, {"steps": [PULL]}).vertices.dtype, float)

    def test_given_arrays_do_not_change(self):
        points, faces = grid()
        step = copy.deepcopy(PULL)
        vertices = edit(points, faces, {"steps": [step]}).vertices
        numpy.testing.assert_array_equal(points, grid()[0])
        self.assertEqual(step, PULL)
        self.assertTrue(vertices.flags.owndata or vertices.base is None or vertices.base is not points)
        vertices[:] = 0  # is the caller's
        outside = edit(points, faces, {"steps": [PULL]}).vertices[(numpy.abs(points - points[220]) > 9).any(axis=1)]
        self.assertEqual(outside.tobytes(), points[(numpy.abs(points - points[220]) > 9).any(axis=1)].tobytes())

    def test_meshes_of_other_libraries(self):
        points, faces = grid()
        expected = edit(points, faces, {"steps": [PULL]}).vertices
        tensors = types.SimpleNamespace(vertex=types.SimpleNamespace(positions=types.SimpleNamespace(numpy=lambda: points)),
                                        triangle=types.SimpleNamespace(indices=types.SimpleNamespace(numpy=lambda: faces)))
        meshes = [trimesh.Trimesh(points, faces, process=False), types.SimpleNamespace(vertices=points, triangles=faces), tensors,
                  types.SimpleNamespace(vertices=points, cells=faces.tolist(), edges=[])]
        if pyvista:
            meshes.append(pyvista.PolyData(points, numpy.insert(faces, 0, 3, axis=1).ravel()))
        for mesh in meshes:
            with self.subTest(type=type(mesh)):
                for vertices in (edit(mesh, {"steps": [PULL]}).vertices, edit(mesh, edit={"steps": [PULL]}).vertices,
                                 Editor(mesh, PULL).pose(), Editor(mesh, step={"steps": [PULL]}).pose()):
                    self.assertIs(type(vertices), numpy.ndarray)
                    numpy.testing.assert_array_equal(vertices, expected)
                self.assertEqual(laplacian_edit.nearest(mesh, [10, 10, 0]).tolist(), [220])
        if pyvista:
            with self.assertRaisesRegex(EditRefused, "extract_surface"):
                edit(meshes[-1].cast_to_unstructured_grid(), {"steps": [PULL]})
        with self.assertRaisesRegex(EditRefused, r'mesh.cells_dict\["triangle"\]'):  # meshio's
            edit(types.SimpleNamespace(points=points, cells=[], cells_dict={"triangle": faces}), {"steps": [PULL]})
        with self.assertRaisesRegex(EditRefused, "Scene"):
            edit(trimesh.Scene(meshes[0]), {"steps": [PULL]})

    def test_selection(self):
        points, faces = grid()
        step = {"region": {"selected": True}, "handles": [{"vertices": 220, "translation": [0, 0, 3]}]}
        chosen = numpy.abs(points - points[220]).max(axis=1) <= 6
        expected = edit(points, faces, {"steps": [{**step, "region": {"vertices": chosen}}]}).vertices
        for selected in (chosen, numpy.flatnonzero(chosen), set(numpy.flatnonzero(chosen).tolist())):
            numpy.testing.assert_array_equal(edit(points, faces, {"steps": [step]}, selected=selected).vertices, expected)
        of_faces = chosen[faces].all(axis=1)
        for selected in (of_faces, numpy.flatnonzero(of_faces)):
            numpy.testing.assert_array_equal(edit(points, faces, {"steps": [step]}, selected_faces=selected).vertices, expected)
            quads = numpy.concatenate([faces[:400], faces[400:, 2:]], axis=1)
            both = numpy.flatnonzero(of_faces[:400] & of_faces[400:])
            edit(points, quads, {"steps": [step]}, selected_faces=both)
        with self.assertRaisesRegex(EditRefused, "selected"):
            edit(points, faces, {"steps": [step]}, selected=[])
        with self.assertRaisesRegex(EditRefused, "^selected: vertex 441 does not exist"):
            edit(points, faces, {"steps": [step]}, selected=[441])


class Refusals(unittest.TestCase):
    def refusals(self):
        """Returns of each: what is called, the key, and a part of the text."""
        points, faces = grid()
        broken = faces.copy()
        broken[5, 1] = 441
        holed = points.copy()
        holed[221, 1] = numpy.nan

        fit = {"steps": [{"region": {"component": True}, "fit": {"to": "a"}}]}

        def one(**keys):
            return lambda: edit(points, faces, with_handle(**keys))

        handle = "steps[0].handles[0]"
        return {
            "NaN": (one(vertices=220, translation=[0, 0, float("nan")]), handle + ".translation[2]", "nan is not finite"),
            "infinity in points": (one(points=[[0, 0, 0], [0, numpy.inf, 0]]), handle + ".points[1][1]", "inf is not finite"),
            "NaN in a setting": (lambda: edit(points, faces, {"steps": [{**PULL, "membrane": numpy.float64("nan")}]}),
                                 "steps[0].membrane", "nan is not finite"),
            "vertex that does not exist": (one(vertices=[4410]), handle + ".vertices", "vertex 4410 is outside"),
            "negative vertex": (one(vertices=[3, -1]), handle + ".vertices", "-1 is no vertex number"),
            "half a vertex": (one(vertices=[3, 1.5]), handle + ".vertices", "1.5 is no vertex number"),
            "a boolean among numbers": (one(vertices=[True, 3]), handle + ".vertices", "True is no vertex number"),
            "a short mask": (one(vertices=numpy.ones(440, bool)), handle + ".vertices", "440 entries: .* 441"),
            "an empty mask": (one(vertices=numpy.zeros(441, bool)), handle + ".vertices", "no vertex in it"),
            "an empty list": (one(vertices=[]), handle + ".vertices", "no vertex in it"),
            "words for vertices": (one(vertices=["nose"]), handle + ".vertices[0]", "nose"),
            "text that is no list": (one(vertices="a-b"), handle + ".vertices", '"a-b" is no vertex number or range'),
            "two coordinates": (one(points=[[1, 2]]), handle + ".points", r"shape \(1, 2\)"),
            "a short translation": (one(vertices=220, translation=[1, 2]), handle + ".translation", "a list of 3 numbers"),
            "a matrix of 3 x 3": (one(vertices=220, matrix=numpy.eye(3)), handle + ".matrix", "a list of 16 numbers"),
            "an unknown key": (lambda: edit(points, faces, {"steps": [{**PULL, "regio": 1}]}), "steps[0]", 'unknown key "regio"'),
            "no steps": (lambda: edit(points, faces, {"steps": []}), "steps", "a list of one or more steps"),
            "another mesh": (lambda: edit(points, faces, {"mesh": {"vertices": 440}, "steps": [PULL]}), "mesh", "440"),
            "a setting out of range": (lambda: edit(points, faces, {"steps": [{**PULL, "membrane": -1}]}), "steps[0].membrane", "membrane weight is -1"),
            "an object": (lambda: edit(points, faces, {"steps": [{**PULL, "membrane": object()}]}), "steps[0].membrane", "no form in JSON"),
            "no edit": (lambda: edit(points, faces, 7), "edit", "int is no edit"),
            "a file that is not there": (lambda: edit(points, faces, pathlib.Path("nowhere.json")), "edit", "nowhere.json"),
            "a folder as a file": (lambda: edit(points, faces, pathlib.Path()), "edit", "no regular file"),
            "broken JSON": (lambda: edit(points, faces, '{"steps": ['), "edit", "not valid JSON"),
            "a fraction of 2": (lambda: edit(points, faces, {"steps": [PULL]}, fraction=2), "fraction", "2 is outside"),
            "a flat array of vertices": (lambda: edit(points.ravel(), faces, {"steps": [PULL]}), "vertices", r"shape \(1323,\)"),
            "half precision": (lambda: edit(points.astype("f2"), faces, {"steps": [PULL]}), "vertices", "float16"),
            "rows of different lengths": (lambda: edit([[1, 2, 3], [1]], faces, {"steps": [PULL]}), "vertices", "different lengths"),
            "no faces": (lambda: edit(points, [], {"steps": [PULL]}), "faces", "face"),
            "corners that are no integers": (lambda: edit(points, faces / 2, {"steps": [PULL]}), "faces", "float64"),
            "a corner that does not exist": (lambda: edit(points, broken, {"steps": [PULL]}), "faces", "441"),
            "a negative corner": (lambda: edit(points, faces - 1, {"steps": [PULL]}), "faces", "-1 is no vertex number"),
            "a list of polygons that ends early": (lambda: edit(points, [3, 0, 1], {"steps": [PULL]}), "faces", "polygon 0 has 3 corners"),
            "a vertex that is not finite": (lambda: edit(holed, faces, {"steps": [PULL]}), "steps[0].region", "vertex 221"),
            "an object without vertices": (lambda: edit(object(), {"steps": [PULL]}), "vertices", "has no vertices and faces"),
            "a scan that was not given": (lambda: edit(points, faces, fit), "scans", r'give scans=\{"a": mesh\}'),
            "a scan without faces": (lambda: edit(points, faces, fit, scans={"a": points}), 'scans["a"]', "neither faces nor normals"),
            "a cloud without normals": (lambda: edit(points, faces, fit, scans={"a": (points, None, None)}), 'scans["a"]', "nor normals"),
            "a scan of three arrays": (lambda: edit(points, faces, fit, scans={"a": (points, faces, points)}), 'scans["a"]', "3 values"),
            "a cloud with too few normals": (lambda: edit(points, faces, fit, scans={"a": (points, None, points[1:])}), 'scans["a"][2]',
                                             "440 normals for 441 points"),
            "a scan of one point": (lambda: edit(points, faces, fit, scans={"a": (points[:1], None, points[:1])}), "steps[0].fit.to", '"a" has no point'),
            "a fit in an editor": (lambda: Editor(points, faces, fit), "steps[0].fit", r"call edit\(\) with scans"),
            "two steps in an editor": (lambda: Editor(points, faces, {"steps": [PULL, PULL]}), "steps", "has 2"),
            "handles for other groups": (lambda: Editor(points, faces, PULL).pose([{}, {}]), "handles", "there are 2"),
            "handles of other vertices": (lambda: Editor(points, faces, PULL).pose({"vertices": 3}), "handles[0]", "not the vertices"),
            "other weights": (lambda: Editor(points, faces, PULL).pose({"translation": [0, 0, 1], "weights": [0.5]}), "handles[0]",
                              "not the weights"),
            "NaN in handles": (lambda: Editor(points, faces, PULL).pose({"translation": [numpy.nan, 0, 0]}),
                               "handles[0].translation[0]", "nan"),
            "a report before a pose": (lambda: Editor(points, faces, PULL).report, "report", "no pose yet"),
        }

    def test_key_of_each_refusal_by_the_core(self):
        points, faces = grid()
        far = [[10, 10, 0], [10, 10, 90]]
        plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
        whole = {"region": {"component": True}, "handles": None}
        for key, step in {
                "region.radius": {"region": {"radius": -1}}, "region.padding": {"region": {"radius": 9, "padding": 2}},
                "region.connect": {"region": {"radius": 9, "connect": -1}}, "region.vertices": {"region": {"vertices": [0, 500]}},
                "region.held": {"region": {"radius": 9, "held": [500]}}, "region.within.radius": {"region": {"within": {"point": [9, 9, 0], "radius": -1}}},
                "region.within.point": {"region": {"within": {"point": [9, 9, 99], "radius": 1}}}, "region.selected": {"region": {"selected": True}},
                "region": {"region": {"vertices": [0, 1]}}, "handles[0].points[1]": {"handles": [{"points": far}]},
                "handles[0].weights": {"handles": [{"vertices": [3, 4], "weights": [1, 2]}]},
                "handles[1].vertices": {"handles": [{"vertices": 3}, {"vertices": [3, 4]}]},
                "handles[1].targets": {"handles": [{"vertices": 3}, {"vertices": [4, 4], "targets": [[0, 0, 0], [1, 0, 0]]}]},
                "handles[0].rotation": {"handles": [{"vertices": 3, "rotation": {"axis": [0, 0, 1], "degrees": 5}}]},
                "handles[0].rotation.axis": {"handles": [{"vertices": [3, 4], "rotation": {"axis": [0, 0, 0], "degrees": 5}}]},
                "handles[0].scale": {"handles": [{"vertices": [3, 4], "scale": 0}]}, "handles[0].selected": {"handles": [{"selected": True}]},
                "handles[0].matrix": {"handles": [{"vertices": [3, 4], "matrix": numpy.diag([-1, 1, 1, 1])}, {"vertices": [8, 9]}]},
                "mirror.normal": {"mirror": {**plane, "normal": [0, 0, 0]}}, "mirror": {"mirror": plane},
                "order": {"order": 9}, "fit.detail": {**whole, "fit": {"to": "a", "detail": 9}},
                "fit.distance": {**whole, "fit": {"to": "a", "distance": -1}},
                "fit.exclude.vertices": {**whole, "fit": {"to": "a", "exclude": {"vertices": [500]}}},
        }.items():
            with self.subTest(key=key), self.assertRaises(EditRefused) as caught:
                step = {name: value for name, value in {**PULL, **step}.items() if value is not None}
                edit(points, faces, {"steps": [PULL, step]}, scans={"a": (points, faces)})
            self.assertEqual(caught.exception.key, "steps[1]." + key, caught.exception)
        with self.assertRaises(EditRefused) as caught:
            edit(points, faces, {"steps": [{**PULL, "handles": [{"vertices": [4410]}]}]})
        self.assertEqual(caught.exception.vertex, 4410)
        with self.assertRaises(EditRefused) as caught:
            Editor(points, faces, {**PULL, "region": {"radius": -1}})
        self.assertEqual(caught.exception.key, "steps[0].region.radius")

    def test_arguments_of_other_kinds(self):
        points, faces = grid()
        cycle = {"region": {"radius": 9}}
        cycle["handles"] = [cycle]
        ring, deep = [], []
        ring.append(ring)
        for _ in range(100000):
            deep = [deep]
        step = {"steps": [PULL]}
        for key, call in {
                "edit": lambda: edit(points, faces, {"steps": [cycle]}), "steps": lambda: edit(points, faces, {"steps": deep}),
                "steps[0].handles[0].vertices": lambda: edit(points, faces, with_handle(vertices=ring)),
                "steps[0].handles[0].vertices ": lambda: edit(points, faces, with_handle(vertices={1, "a"})),
                "steps[0].handles[0].vertices  ": lambda: edit(points, faces, with_handle(vertices={True, 7})),
                "steps[0].membrane": lambda: edit(points, faces, {"steps": [{**PULL, "membrane": numpy.longdouble("1e4000")}]}),
                "steps[0].membrane ": lambda: edit(points, faces, {"steps": [{**PULL, "membrane": 10**5000}]}),
                "steps[0].method": lambda: edit(points, faces, {"steps": [{**PULL, "method": b"linear"}]}),
                "steps[0]": lambda: edit(points, faces, {"steps": [{**PULL, 5: 1}]}), "points": lambda: laplacian_edit.nearest(points, faces, ring),
                "vertices": lambda: edit(points.astype(complex), faces, step), "faces": lambda: edit(points, ring, step),
                "vertices ": lambda: edit(points > 0, faces, step), "selected": lambda: edit(points, faces, step, selected=deep),
                "landmarks_folder": lambda: edit(points, faces, step, landmarks_folder=5), "space": lambda: edit(points, faces, step, space=5),
                "space ": lambda: Editor(points, faces, PULL, space="XYZ"), "scans": lambda: edit(points, faces, step, scans=5),
                "scans ": lambda: edit(points, faces, step, scans={5: (points, faces)}), "fraction": lambda: edit(points, faces, step, fraction=1j),
                "fraction ": lambda: edit(points, faces, step, fraction=10**400), "progress": lambda: edit(points, faces, step, progress=5),
                "to_file": lambda: laplacian_edit.fit_landmarks("from.csv", 5), "from_file": lambda: Editor(points, faces, PULL).landmarks("a\0b", "c"),
        }.items():
            with self.subTest(argument=key), self.assertRaises(EditRefused) as caught:
                call()
            self.assertEqual(caught.exception.key, key.strip(), caught.exception)
        low = numpy.longdouble(0.25)
        for value in (low, numpy.array(low), numpy.float16(0.25)):
            self.assertEqual(edit(points, faces, {"steps": [{**PULL, "membrane": value}]}, fraction=low).vertices.tobytes(),
                             edit(points, faces, {"steps": [{**PULL, "membrane": 0.25}]}, fraction=0.25).vertices.tobytes())

    def test_masked_entries_are_refused(self):
        points, faces = grid()
        group = {"region": {"radius": 9}, "handles": [{"vertices": [219, 220]}]}

        def masked(values):
            values = numpy.ma.array(values)
            values[1:2] = numpy.ma.masked
            return values

        def handle(**keys):
            return lambda: edit(points, faces, {"steps": [{**group, "handles": [{"vertices": [219, 220], **keys}]}]})

        step, fit = {"steps": [PULL]}, {"steps": [{"region": {"component": True}, "fit": {"to": "a"}}]}
        for key, call in {
                "vertices": lambda: edit(masked(points), faces, step), "vertices ": lambda: edit(list(masked(points)), faces, step),
                "faces": lambda: edit(points, masked(faces), step), "selected": lambda: edit(points, faces, step, selected=masked([1, 2])),
                "selected_faces": lambda: edit(points, faces, step, selected_faces=masked([1, 2])),
                "points": lambda: laplacian_edit.nearest(points, faces, masked(points[:3])),
                "steps[0].handles[0].vertices": handle(vertices=masked([219, 220])),
                "steps[0].handles[0].vertices ": handle(vertices=[219, numpy.ma.masked]),
                "steps[0].handles[0].targets": handle(targets=masked(points[:2])), "steps[0].handles[0].weights": handle(weights=masked([1, 1])),
                "steps[0].handles[0].translation": handle(translation=masked([0, 0, 1])), "steps[0].handles[0].scale": handle(scale=numpy.ma.masked),
                "steps[0].region.held": lambda: edit(points, faces, {"steps": [{**group, "region": {"radius": 9, "held": masked([1, 2])}}]}),
                'scans["a"].vertices': lambda: edit(points, faces, fit, scans={"a": (masked(points), faces)}),
                'scans["a"].faces': lambda: edit(points, faces, fit, scans={"a": (points, masked(faces))}),
                'scans["a"][2].vertices': lambda: edit(points, faces, fit, scans={"a": (points, None, masked(points))}),
        }.items():
            with self.subTest(argument=key), self.assertRaisesRegex(EditRefused, "masked") as caught:
                call()
            self.assertEqual(caught.exception.key, key.strip())
        self.assertEqual(edit(numpy.ma.array(points), numpy.ma.array(faces), step).vertices.tobytes(), edit(points, faces, step).vertices.tobytes())

    def test_faces_are_never_read_as_others(self):
        square = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
        tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]

        def count(n, faces):
            step = {"region": {"component": True}, "handles": [{"vertices": 0}, {"vertices": 3, "translation": [0, 0, 1]}]}
            points = numpy.random.default_rng(n).random((n, 3))
            return edit(points, faces, {"steps": [step]}).report["mesh"]["faces"]

        for n, faces in ((8, square), (4, tetrahedron), (441, grid()[1])):  # as PyVista has them
            fans = len(faces) * (len(faces[0]) - 2)
            with self.subTest(vertices=n):
                self.assertEqual(count(n, numpy.insert(faces, 0, len(faces[0]), axis=1).ravel()), fans)
                with self.assertRaisesRegex(EditRefused, r"faces\[:, 1:\]"):
                    count(n, numpy.insert(faces, 0, len(faces[0]), axis=1))
                with self.assertRaisesRegex(EditRefused, r"\(m, 3\)"):
                    count(n, numpy.ravel(faces))
        random = numpy.random.default_rng(0)
        for k in range(500):
            faces = random.integers(0, 12, (random.integers(1, 9), 3 + k % 2))
            with self.subTest(faces=faces), self.assertRaises(EditRefused):
                count(12, faces.ravel())
        for faces in ([[0, 1, 2, 3], [4, 5]], [[0, 1, 2, 3], [4, 4, 5]], [[0, 1, 2, 3], [4, 4, 5, 5]], [2, 0, 1, 4, 0, 1, 2, 3], [[2, 0, 1], [2, 4, 5]]):
            with self.subTest(faces=faces), self.assertRaisesRegex(EditRefused, "different corners|begins with 2|unclear"):
                count(8, faces)
        # The example of PyVista's documents.
        self.assertEqual(count(5, [4, 0, 1, 2, 3, 3, 0, 1, 4, 3, 1, 2, 4]), 4)
        self.assertEqual(count(8, [*square[1:], square[0][:3], [0, 2, 3]]), 12)

    def test_refusals_by_name(self):
        refusals = self.refusals()
        self.assertGreaterEqual(len(refusals), 20)
        for name, (call, key, text) in refusals.items():
            with self.subTest(refusal=name):
                with self.assertRaisesRegex(EditRefused, text) as caught:
                    call()
                self.assertEqual(caught.exception.key, key, caught.exception)
                self.assertIsInstance(caught.exception, ValueError)
                self.assertRegex(str(caught.exception), r"[.:]")
                self.assertTrue(caught.exception.cause)
                self.assertTrue(name != "a vertex that is not finite" or caught.exception.cause == "NotFinite")
                again = pickle.loads(pickle.dumps(caught.exception))
                self.assertEqual((str(again), again.key, again.cause, again.vertex),
                                 (str(caught.exception), key, caught.exception.cause, caught.exception.vertex))


class Editing(unittest.TestCase):
    def test_poses_are_edits(self):
        points, faces = grid()
        editor = Editor(points, faces, PULL)
        for fraction in (1.0, 0, 0.25, 1):
            expected = edit(points, faces, {"steps": [PULL]}, fraction=fraction)
            for pose in (editor.pose(fraction), editor.pose(fraction=fraction), editor.pose(1, fraction=fraction)):
                numpy.testing.assert_array_equal(pose, expected.vertices)
            self.assertEqual(figures(editor.report), figures(expected.report))
        down = {"steps": [{**PULL, "handles": [{"vertices": 220, "translation": [0, 0, -2], "scale": 1}]}]}
        for handles in ({"translation": [0, 0, -2]}, [{"translation": numpy.array([0, 0, -2])}],
                        {"vertices": [220], "translation": [0, 0, -2]}, {"targets": points[220] + [0, 0, -2]}):
            numpy.testing.assert_allclose(editor.pose(handles), edit(points, faces, down).vertices, atol=1e-12)
        half = edit(points, faces, down, fraction=0.5).vertices
        numpy.testing.assert_array_equal(editor.pose({"translation": [0, 0, -2]}, fraction=0.5), half)
        numpy.testing.assert_array_equal(editor.pose(), edit(points, faces, {"steps": [PULL]}).vertices)

    def test_an_editor_keeps_what_it_was_given(self):
        points, faces = grid()
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "from.csv").write_text("a,3,3,0\nb,15,3,0\nc,3,15,0\n")
            (folder / "to.csv").write_text("a,3,3,1\nb,16,3,0\nc,3,15,2\n")
            files = {"from": str(folder / "from.csv"), "to": str(folder / "to.csv")}
            to = points[:3] + 1
            landmarks = {"region": {"component": True}, "handles": [{"landmarks": files}]}
            targets = {"region": {"radius": 9}, "handles": [{"vertices": numpy.arange(3), "targets": to}]}
            for step in (landmarks, PULL, targets):
                given = [array.copy() for array in (points, faces.astype(numpy.int32))]
                editor, expected = Editor(*given, step), Editor(points, faces, step)
                for array in given:
                    array += 7
                to += 1
                (folder / "from.csv").write_text("a,9,9,0\n")
                for pose in (1.0, 0.3, [{}]):
                    with self.subTest(step=step, pose=pose):
                        numpy.testing.assert_array_equal(editor.pose(pose), expected.pose(pose))
                numpy.testing.assert_array_equal(editor.pose([{}]), points)
                self.assertEqual(editor.nearest(points[[5, 77]]).tolist(), [5, 77])

    def test_an_editor_is_not_called_by_its_progress(self):
        # So large that a pose takes several times 40 ms, after which progress is called.
        editor = Editor(*grid(301), {"region": {"component": True}, "handles": [{"vertices": 45300, "translation": [0, 0, 9]}, {"vertices": 0}]})
        with self.assertRaisesRegex(EditRefused, "calls the Editor that calls it"):
            editor.pose(progress=lambda *_: editor.report)

    def test_an_end_of_the_process_with_edits_in_threads(self):
        code = """if True:
            import sys, threading, time, numpy, laplacian_edit
            x, y = numpy.meshgrid(numpy.arange(151.0), numpy.arange(151.0))
            points = numpy.stack([x.ravel(), y.ravel(), numpy.sin(x * y).ravel()], axis=1)
            corner = (numpy.arange(150)[:, None] * 151 + numpy.arange(150)).ravel()
            faces = numpy.stack([corner, corner + 1, corner + 152, corner + 151], axis=1)
            step = {"region": {"component": True}, "handles": [{"vertices": 11000, "translation": [0, 0, 9]}, {"vertices": 0}]}
            def work(progress):
                while True:
                    laplacian_edit.edit(points, faces, {"steps": [step]}, progress=progress)
            for progress in (None, lambda *_: None, lambda *_: time.sleep(0.01)):
                threading.Thread(target=work, args=[progress], daemon=True).start()
            time.sleep(float(sys.argv[1]))"""
        for delay in (0.1, 0.6):
            done = subprocess.run([sys.executable, "-c", code, str(delay)], capture_output=True, text=True, timeout=120, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    @unittest.skipUnless(hasattr(os, "fork"), "no fork")
    def test_a_forked_process_drops_an_editor(self):
        code = """if True:
            import os, signal, numpy, laplacian_edit
            x, y = numpy.meshgrid(numpy.arange(61.0), numpy.arange(61.0))
            points = numpy.stack([x.ravel(), y.ravel(), numpy.sin(x).ravel()], axis=1)
            corner = (numpy.arange(60)[:, None] * 61 + numpy.arange(60)).ravel()
            faces = numpy.stack([corner, corner + 1, corner + 62, corner + 61], axis=1)
            editor = laplacian_edit.Editor(points, faces, {"region": {"radius": 25}, "handles": [{"vertices": 1860, "translation": [0, 0, 9]}]})
            pose = editor.pose()
            if os.fork() == 0:
                signal.alarm(20)
                assert (editor.pose() == pose).all()
                del editor
            elif os.wait()[1] != 0:
                raise ChildProcessError"""
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_mirrored_and_welded_steps(self):
        points, faces = grid()
        corners = faces.ravel()
        mirrored = {**PULL, "mirror": {"point": [8, 0, 0], "normal": [1, 0, 0]}}
        for step in (PULL, mirrored):
            for mesh in ((points, faces), (points[corners], numpy.arange(len(corners)).reshape(-1, 3))):
                with self.subTest(step=step, vertices=len(mesh[0])):
                    editor = Editor(*mesh, step)
                    expected = edit(*mesh, {"steps": [step]}).vertices
                    numpy.testing.assert_array_equal(editor.pose({"translation": [0.5, 0, 4]}), expected)
                    numpy.testing.assert_array_equal(editor.pose(), expected)
        text = json.dumps({"laplacian_edit": 1, "steps": [PULL]})
        numpy.testing.assert_array_equal(Editor(points, faces, text).pose(), edit(points, faces, text).vertices)
        flat = {"region": {"vertices": numpy.linalg.norm(points - points[220], axis=1) < 4}, "detail": 0}
        numpy.testing.assert_array_equal(Editor(points, faces, flat).pose(), edit(points, faces, {"steps": [flat]}).vertices)
        by_position = {"mesh": {"positions": {"vertices": "220", "points": [points[90]]}}, "steps": [PULL]}
        editor = Editor(points, faces, by_position)
        numpy.testing.assert_array_equal(editor.pose({"translation": [0.5, 0, 4]}), edit(points, faces, by_position).vertices)

    def test_region_and_nearest(self):
        points, faces = grid()
        editor = Editor(points, faces, PULL)
        region = editor.region
        self.assertEqual(region.handles.tolist(), [220])
        self.assertEqual(numpy.sort(numpy.concatenate(region[1:])).tolist(), region.vertices.tolist())
        moved = numpy.flatnonzero((editor.pose() != points).any(axis=1))
        self.assertLessEqual(set(moved.tolist()), set(region.vertices.tolist()))
        self.assertEqual(editor.nearest([[0, 0, 0], [20, 20, 9]]).tolist(), [0, 440])
        self.assertEqual(laplacian_edit.nearest(points, faces, (3, 1, 0)).tolist(), [24])

    def test_transfer(self):
        """Values of a scan at its nearest points: those of the nearest triangle's plane, here z = 0, and NaN farther away."""
        points, faces = grid()
        random = numpy.random.default_rng(3)
        at = numpy.column_stack([random.uniform(0, 20, (500, 2)), random.uniform(-0.5, 0.5, 500)])
        x, y = at[:, 0], at[:, 1]
        values = numpy.stack([points[:, 0] ** 2, 3 - points[:, 1], numpy.arange(len(points)) % 7], axis=1)
        scan = points * [1, 1, 0], faces
        found = laplacian_edit.transfer(at, scan, values, within=1)
        numpy.testing.assert_allclose(found[:, 1], 3 - y, rtol=0, atol=1e-12)
        low = numpy.floor(x)
        numpy.testing.assert_allclose(found[:, 0], low**2 + (x - low) * (2 * low + 1), rtol=0, atol=1e-9)  # linear between columns
        corners = numpy.abs(at[:, :2] - numpy.rint(at[:, :2])).max(axis=1) < 0.05
        near = numpy.rint(at[corners])
        numpy.testing.assert_allclose(found[corners, 2], (21 * near[:, 1] + near[:, 0]) % 7, rtol=0, atol=0.7)
        limited = laplacian_edit.transfer(at, scan, values[:, 1], within=0.25)
        numpy.testing.assert_array_equal(numpy.isnan(limited), numpy.abs(at[:, 2]) > 0.25)
        cloud = laplacian_edit.transfer(points + [0.1, 0.2, 0], (points, None, points + 1), numpy.arange(len(points), dtype=numpy.uint16))
        numpy.testing.assert_array_equal(cloud, numpy.arange(len(points)))
        for key, call in {"values": lambda: laplacian_edit.transfer(at, scan, values[1:]), "scan": lambda: laplacian_edit.transfer(at, points, values),
                          "within": lambda: laplacian_edit.transfer(at, scan, values, within=-1)}.items():
            with self.assertRaises(EditRefused) as caught:
                call()
            self.assertEqual(caught.exception.key, key)

    def test_progress(self):
        points, faces = grid(101)
        step = {"region": {"component": True}, "handles": [{"vertices": 5100, "translation": [0, 0, 9]}, {"vertices": 0}]}
        seen = []
        edit(points, faces, {"steps": [step]}, progress=lambda share, stage: seen.append((share, stage)))
        self.assertEqual(seen[-1], (1.0, "done"))
        self.assertTrue(all(0 <= share <= 1 and stage for share, stage in seen))

        class Enough(Exception):
            pass

        def stop(*_):
            raise Enough

        with self.assertRaises(Enough):
            edit(points, faces, {"steps": [step]}, progress=stop)
        editor = Editor(*grid(), PULL)  # so small that only the last call of the progress function comes
        with self.assertRaises(Enough):
            editor.pose(progress=stop)
        with self.assertRaisesRegex(EditRefused, "no pose yet"):
            editor.report

    @unittest.skipIf(sys.platform == "win32", "no signals")
    def test_ctrl_c(self):
        points, faces = grid(201)
        before = points.copy()
        step = {"region": {"component": True}, "handles": [{"vertices": 20100, "translation": [0, 0, 9]}, {"vertices": 0}]}
        for delay in (0.02, 0.1):
            timer = threading.Timer(delay, os.kill, (os.getpid(), signal.SIGINT))
            with self.assertRaises(KeyboardInterrupt):
                timer.start()
                while True:
                    edit(points, faces, {"steps": [step]})
            timer.join()
        numpy.testing.assert_array_equal(points, before)
        edit(*grid(), {"steps": [PULL]})

    def test_200_edits_in_four_threads(self):
        mesh = grid(41)

        def edited(k):
            step = {"region": {"radius": 15}, "handles": [{"vertices": 840, "translation": [0, 0, 0.02 * k]}]}
            return edit(*mesh, {"steps": [step]}).vertices.tobytes()

        def edits(threads):
            start = time.perf_counter()
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                return list(pool.map(edited, range(200))), time.perf_counter() - start

        (expected, alone), (at_once, together) = edits(1), edits(4)
        self.assertEqual(at_once, expected)
        print(f"200 edits in 4 threads: {alone / together:.2f} times the speed of one thread")
        editor = Editor(*mesh, PULL)
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            poses = [pose.tobytes() for pose in pool.map(editor.pose, [k / 40 for k in range(41)])]
        self.assertEqual(poses, [editor.pose(k / 40).tobytes() for k in range(41)])

    @unittest.skipUnless(os.path.exists("/proc/self/statm"), "no /proc")
    def test_1000_edits_take_no_more_memory(self):
        points, faces = grid()
        page = mmap.PAGESIZE

        def edits(count):
            for k in range(count):
                edit(points, faces, {"steps": [PULL]})
                if k % 10 == 0:
                    with self.assertRaises(EditRefused):
                        edit(points, faces, with_handle(vertices=[4410]))
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * page

        before = edits(300)
        self.assertLess(edits(1000) - before, 4 << 20)


class Package(unittest.TestCase):
    def test_what_is_in_it(self):
        files = [str(file) for file in importlib.metadata.files("laplacian-edit")]
        self.assertEqual(sum(".so" in name or ".pyd" in name for name in files), 1, files)
        for name in ("py.typed", "_core.pyi", "pymeshlab.py"):
            self.assertIn(f"laplacian_edit/{name}", files)
        self.assertEqual(importlib.metadata.requires("laplacian-edit"), ["numpy"])
        package = pathlib.Path(laplacian_edit.__file__).parent
        self.assertLess(sum(path.stat().st_size for path in package.iterdir() if path.is_file()), 8 << 20)
        code = "import sys, laplacian_edit; print(*[m for m in sys.modules if m in ('trimesh', 'pyvista', 'open3d', 'pymeshlab')])"
        done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
        self.assertEqual(done.stdout, "\n")


if __name__ == "__main__":
    unittest.main()
