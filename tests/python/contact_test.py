# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits that stop at contact: after them IPC Toolkit finds no intersection. Run by run.sh with the package.

Environment:
  LAPEDIT_MAKE_MESH  the program that generates the meshes
"""
import functools
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import ipctk
import numpy
import trimesh

from laplacian_edit import EditRefused, edit

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "cli"))

from surfaces import grid, together, tube as round_tube  # noqa: E402


@functools.lru_cache(None)
def mesh(name):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "mesh.ply")
        subprocess.run([os.environ["LAPEDIT_MAKE_MESH"], name, str(path)], check=True, stdout=subprocess.DEVNULL)
        loaded = trimesh.load(path, process=False)
    return numpy.array(loaded.vertices), numpy.array(loaded.faces)


def tube(rings, around, radius, low, high):
    """An open tube along y."""
    points, faces = round_tube(around, rings, high - low, closed=False)
    return points[:, [2, 0, 1]] * [radius, 1, radius] + [0, low, 0], faces


def turned(axis, degrees, center, **more):
    return {"rotation": {"axis": axis, "degrees": degrees, "center": center}, **more}


def crosses(points, faces):
    """Whether an edge passes through a face, by IPC Toolkit."""
    edges = ipctk.edges(faces)
    return ipctk.has_intersections(ipctk.CollisionMesh(points, edges, faces), numpy.asarray(points, float))


def pulled(name, radius, place, size, **motion):
    """A disc of a generated mesh as the handle."""
    points, faces = mesh(name)
    disc = numpy.flatnonzero(numpy.linalg.norm(points - place, axis=1) < size)
    return points, faces, {"region": {"radius": radius}, "handles": [{"vertices": disc, **motion}]}


def between_ends(points, faces, axis, low, high, first=0, **motion):
    """The vertices beyond a high coordinate move, and those below a low one are held. @param first  vertex of the piece"""
    ends = [first + numpy.flatnonzero(end) for end in (points[first:, axis] < low, points[first:, axis] > high)]
    return points, faces, {"region": {"component": True}, "handles": [{"vertices": ends[0]}, {"vertices": ends[1], **motion}]}


def sheet():
    points, faces = grid(60, 40)
    u, v = (points[:, :2] / [59, 39]).T
    return numpy.stack([3 * u, 2 * v, 0.02 * numpy.sin(20 * u) * numpy.sin(15 * v)], 1), faces


HAND = (1.08, -0.4, 0.1)
CASES = {
    "fingers": lambda: pulled("hand", 1.2, (0.05, 1.6, 0), 0.2, translation=[0.35, -0.1, 0]),
    "hand on thigh": lambda: pulled("person", 1.4, HAND, 0.25, **turned([0, 0, 1], -55, [0.4, 0.8, 0])),
    "arm through body": lambda: pulled("person", 1.3, HAND, 0.25, translation=[-1.3, 0.3, 0.05]),
    "elbow": lambda: between_ends(*tube(140, 40, 0.3, -2, 2), 1, -0.5, 0.5, **turned([0, 0, 1], 150, [0, 0, 0])),
    "coil": lambda: between_ends(*tube(200, 16, 0.1, 0, 4), 1, 0.3, 3.7, **turned([0, 0, 1], 360, [0, 3.85, 0], translation=[0.05, -3.6, 0])),
    "ear": lambda: pulled("creature", 0.5, (1.2, 1.2, 0.62), 0.15, translation=[0.05, -0.25, -0.45]),
    "nose": lambda: pulled("coarse_head", 0.6, (0, -0.13, 1.2), 0.12, translation=[0.1, -0.45, -0.35]),
    "sheet": lambda: between_ends(*sheet(), 0, 0.6, 2.4, **turned([0, 1, 0], -186, [1.5, 0, 0])),
    "squashed": lambda: between_ends(*tube(80, 36, 0.4, -1.2, 1.2), 1, -1, 1, translation=[0, -1.7, 0]),
    "sleeve": lambda: between_ends(*together(tube(80, 24, 0.25, -2, 2), tube(50, 40, 0.4, -1.2, 0.8), 0), 1, -1, 0.6, first=80 * 24,
                                   translation=[0.45, 0, 0]),
    "thumb": lambda: pulled("hand", 1.1, (side := max(mesh("hand")[0], key=lambda p: abs(p[0]))), 0.2,
                            translation=list(0.9 * (numpy.array([0.05, 0.6, 0.3]) - side))),
    "horn": lambda: pulled("creature", 1, (1.28, 1.95, 0.3), 0.15, translation=[0, -0.5, -0.75])}


def both_ways(case):
    points, faces, step = CASES[case]()
    plain = edit(points, faces, {"steps": [step]})
    return points, faces, step, plain, edit(points, faces, {"steps": [{**step, "contact": True}]})


class Contact(unittest.TestCase):
    def test_nothing_crosses(self):
        for case in CASES:
            with self.subTest(case):
                points, faces, _, plain, stopped = both_ways(case)
                self.assertFalse(crosses(points, faces))
                self.assertTrue(crosses(plain[0], faces))
                self.assertFalse(crosses(stopped[0], faces))
                self.assertFalse(crosses(stopped[0].astype(numpy.float32), faces))

    def test_the_report_says_what_stopped(self):
        points, faces, step, plain, stopped = both_ways("sleeve")
        report = stopped.report["steps"][0]
        group = step["handles"][1]
        off = (points + group["translation"] - stopped.vertices)[group["vertices"]]
        missed = numpy.linalg.norm(off.mean(axis=0))
        self.assertLess(numpy.linalg.norm(off - off.mean(axis=0), axis=1).max(), 0.1 * missed, "the group yields as a whole")
        self.assertIn(f"group 1 stops {missed:.3g} before its target, at vertex", report["stopped"])
        self.assertIn("would cross", report["advice"])
        self.assertTrue(report["converged"])
        self.assertGreater(report["contacts"], 0)
        self.assertIsNone(plain.report["steps"][0]["contacts"])

    def test_a_jam_is_reported(self):
        points, faces, step = CASES["fingers"]()
        step["handles"][0]["translation"] = [1.05, -0.3, 0]
        jammed = edit(points, faces, {"steps": [{**step, "contact": True}]})
        report = jammed.report["steps"][0]
        self.assertFalse(report["converged"])
        self.assertRegex(report["stopped"], r"^handle group 0 stops [\d.]+ before its target, at vertex \d+$")
        self.assertIn("contacts jam there; move it less", report["advice"])

    def test_an_elbow_stops_before_it_tears(self):
        points, faces, step = CASES["elbow"]()
        fore = step["handles"][1]["vertices"]
        rest = points[fore] - points[fore].mean(axis=0)
        for degrees in (180, 240):
            step["handles"][1]["rotation"]["degrees"] = degrees
            stopped = edit(points, faces, {"steps": [{**step, "contact": True}]})
            u, _, v = numpy.linalg.svd(rest.T @ (stopped.vertices[fore] - stopped.vertices[fore].mean(axis=0)))
            cosine = ((u @ v).trace() - 1) / 2
            self.assertAlmostEqual(numpy.degrees(numpy.arccos(cosine)), 158, delta=5)
            self.assertTrue(stopped.report["steps"][0]["converged"])
            self.assertLess(stopped.report["steps"][0]["stretch_rms"], 0.12)
            self.assertFalse(crosses(stopped.vertices, faces))

    def test_what_is_far_from_contact_stays(self):
        points, faces, step, plain, stopped = both_ways("nose")
        moved = numpy.linalg.norm(stopped.vertices - plain.vertices, axis=1)
        largest = numpy.linalg.norm(plain.vertices - points, axis=1).max()
        touching = points[numpy.flatnonzero(moved > 0.1 * moved.max())]
        away = numpy.array([numpy.linalg.norm(touching - point, axis=1).min() > 0.25 for point in points])
        self.assertGreater(moved.max(), 0.02 * largest)
        self.assertLess(moved[away].max(), 0.02 * largest)

    def test_a_piece_that_moves_as_a_whole_stops(self):
        points, faces, step = CASES["sleeve"]()
        step["handles"] = step["handles"][1:]
        self.assertTrue(crosses(edit(points, faces, {"steps": [step]}).vertices, faces))
        stopped = edit(points, faces, {"steps": [{**step, "contact": True}]})
        self.assertFalse(crosses(stopped.vertices, faces))
        moved = (stopped.vertices - points)[80 * 24:, 0]
        self.assertGreater(moved.min(), 0.1)
        self.assertLess(moved.max(), 0.16)

    def test_pieces_that_cross_at_rest_stay_free(self):
        points, faces = together(tube(80, 24, 0.25, -2, 2), tube(50, 40, 0.3, -1.2, 0.8), 0)
        points[80 * 24:] = points[80 * 24:] @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
        self.assertTrue(crosses(points, faces))
        *_, step = between_ends(points, faces, 1, -1.6, 1.6, **turned([1, 0, 0], 40, [0, 1.6, 0]))
        plain, free = (edit(points, faces, {"steps": [{**step, **more}]}) for more in ({}, {"contact": True}))
        self.assertEqual(plain.vertices.tobytes(), free.vertices.tobytes())

    def test_a_mirrored_edit_stays_symmetric(self):
        points, faces, step = CASES["ear"]()
        mirror = {"point": [0, 0, 0], "normal": [0, 0, 1]}
        both_ears = edit(points, faces, {"steps": [{**step, "mirror": mirror, "contact": True}]}).vertices
        self.assertFalse(crosses(both_ears, faces))
        image = both_ears * [1, 1, -1]
        self.assertLess(max(numpy.linalg.norm(both_ears - point, axis=1).min() for point in image[::50]), 0.02)

    def test_only_the_default_method_has_it(self):
        points, faces, step = CASES["sheet"]()
        with self.assertRaisesRegex(EditRefused, "contact: has no meaning with the method linear"):
            edit(points, faces, {"steps": [{**step, "method": "linear", "contact": True}]})


if __name__ == "__main__":
    unittest.main()
