# SPDX-License-Identifier: GPL-3.0-or-later
"""What a whole fit has to hold, by laplacian-edit with NumPy: a generated head in two triangulations, and a warp of space, so
that the true correspondence is known."""
import unittest

import numpy as np

from edits_test import handle, run, step
from surfaces import X, Y, Z, ball, grid, near, nearest, normals_of, rotation, together, tube


def head(levels=4, degrees=0):
    """Star-shaped, looks to +z, with a nose, ears, a chin and a neck. @param degrees  of the triangulation"""
    points, faces = ball(levels)
    d = points @ rotation((3, 1, 2), degrees).T
    bumps = sum(height * np.exp(width * (d @ at / np.linalg.norm(at) - 1)) for at, height, width in (
        (np.array((0, -0.1, 1)), 0.35, 60), (np.array((1, 0.1, -0.1)), 0.2, 60), (np.array((-1, 0.1, -0.1)), 0.2, 60),
        (np.array((0, -0.8, 0.6)), 0.2, 25), (np.array((0, -1, -0.3)), 0.7, 12), (np.array((0, 0.6, -0.8)), 0.15, 6)))
    return d * ((1 + bumps) / np.linalg.norm(d / (0.8, 1, 0.92), axis=1))[:, None], faces


def warped(p):
    """A smooth change of a head's shape, some hundredths of its size."""
    x, y, z = p.T
    return np.stack([x * (1.06 + 0.05 * np.sin(1.9 * y)) + 0.04 * np.sin(1.3 * z), 0.97 * y + 0.05 * np.sin(1.7 * x + 0.4) + 0.03 * np.sin(2.1 * z),
                     z * (0.96 + 0.05 * np.cos(1.5 * y)) + 0.04 * np.sin(1.6 * x)], 1)


HEAD = head()
TRUTH = warped(HEAD[0])
OTHER = head(4, 25)
SCAN = warped(OTHER[0]), OTHER[1]
MARKS = (10, 150, 300, 500, 700, 1000, 1200, 1600)


def error(found, truth=TRUTH):
    """Mean, over the size."""
    size = np.sqrt(2 * ((truth - truth.mean(0)) ** 2).sum(1).mean())
    return np.linalg.norm(found - truth, axis=1).mean() / size


def revolved(radius, levels, degrees, amount):
    """A surface about the y axis, warped by an amount. @param degrees  of the triangulation"""
    p, faces = ball(levels)
    p = p @ rotation((3, 1, 2), degrees).T
    around = np.sqrt(np.maximum(1e-9, np.hypot(p[:, 0], p[:, 2])))
    q = np.stack([p[:, 0] / around * radius(p[:, 1]), 1.6 * p[:, 1], p[:, 2] / around * radius(p[:, 1])], 1)
    x, y, z = q.T
    return q + amount * np.stack([np.sin(1.7 * y + 1), np.sin(2.1 * z + 0.4 + y), np.sin(1.9 * x - 1.1 * y)], 1), faces


def bone(y):
    return 0.16 + 0.2 * y**4 + np.maximum(0.03 * y, 0)


def without(mesh, gone):
    """@param gone  of points"""
    points, faces = mesh
    return points, faces[~gone(points)[faces].any(1)]


class Fits(unittest.TestCase):
    def fit(self, mesh=HEAD, scan=SCAN, landmarks=None, more=(), region=None, **settings):
        """@param landmarks  vertices and targets. @return positions; the report is kept"""
        one = {"region": region or {"component": True}, "fit": {"to": "scan.ply", **settings}}
        if landmarks:
            one["handles"] = [{"vertices": [int(v) for v in landmarks[0]], "targets": np.asarray(landmarks[1]).tolist()}]
        poses, self.report = run(mesh, one, *more, scan=scan)
        self.assertIsNotNone(poses, self.report)
        return poses[0]

    def advice(self, **given):
        self.fit(**given)
        return self.report["advice"] or ""

    def refused(self, sentence, *steps, mesh=HEAD, scan=SCAN):
        poses, refusal = run(mesh, *steps, scan=scan)
        self.assertIsNone(poses, sentence)
        self.assertIn(sentence, refusal)

    def test_a_warp_from_another_triangulation(self):
        found = self.fit()
        self.assertLess(error(found), 0.014)
        self.assertLess(np.linalg.norm(found - TRUTH, axis=1).max(), 0.06)
        self.assertGreater(error(HEAD[0]), 0.04)
        fit = self.report["fit"]
        self.assertGreater(min(fit[way]["matched"] for way in ("to_scan", "from_scan")), 0.97)
        self.assertLess(fit["to_scan"]["rms"], 0.01)
        self.assertEqual((self.report["flipped"], self.report["advice"] or ""), (0, ""))

    def test_a_scan_that_is_turned_moved_and_scaled(self):
        for scale in (1e-6, 1e6):
            def move(p):
                return scale * (p @ rotation((1, 2, 0.5), 130).T + (3, -2, 5))
            self.assertLess(error(self.fit(scan=(move(SCAN[0]), SCAN[1])), move(TRUTH)), 0.02)
            self.assertAlmostEqual(self.report["fit"]["scale"] / scale, 1, delta=0.05)

    def test_holes_and_missing_parts(self):
        def gone(p):
            return (p[:, 1] < -1.1) | (np.linalg.norm(p - warped(np.array([(0.7, 0.3, 0.4)])), axis=1) < 0.2) | (
                np.linalg.norm(p - warped(np.array([(-0.3, 0.9, 0.2)])), axis=1) < 0.25)
        self.assertLess(error(self.fit(scan=without(SCAN, gone))), 0.025)
        self.assertLess(self.report["fit"]["to_scan"]["matched"], 0.95)
        self.assertGreater(self.report["fit"]["from_scan"]["matched"], 0.95)

    def test_clouds(self):
        """Plain; with the inner side of a mask, half of whose points cannot be partners; with 30 % outliers; with normals inwards."""
        points, normals, random = SCAN[0], normals_of(*SCAN), np.random.default_rng(1)
        count = len(points) * 3 // 7
        outliers = random.uniform(-1, 1, (count, 3)) * (1.3, 1.8, 1.5), random.uniform(-1, 1, (count, 3))
        clouds = {"plain": (points, [], normals, 0.025), "mask": (np.vstack([points, points - 0.2 * normals]), [], np.vstack([normals, -normals]), 0.025),
                  "outliers": (np.vstack([points, outliers[0]]), [], np.vstack([normals, outliers[1]]), 0.05)}
        for name, (*cloud, bound) in clouds.items():
            self.assertLess(error(self.fit(scan=cloud)), bound, name)
        self.assertLess(error(self.fit(scan=(points, SCAN[1][:, ::-1]))), 0.013)
        self.assertTrue(self.report["fit"]["reversed_normals"])

    def test_landmarks_are_met_and_align(self):
        def move(p):
            return 2 * p @ rotation(X, 170).T + (1, 0, 0)
        marks = np.array(MARKS[:5])
        found = self.fit(scan=(move(SCAN[0]), SCAN[1]), landmarks=(marks, move(TRUTH)[marks]), accuracy=0)
        self.assertTrue(self.report["fit"]["by_landmarks"])
        self.assertLess(error(found, move(TRUTH)), 0.012)
        self.assertLess(np.linalg.norm(found - move(TRUTH), axis=1)[marks].max(), 0.02)

    def inaccurate(self, by):
        marks = np.array(MARKS)
        off = np.stack([np.sin(3 * marks), np.sin(5 * marks + 1), np.sin(7 * marks + 2)], 1)
        return marks, TRUTH[marks] + by * off / np.linalg.norm(off, axis=1)[:, None]

    def test_landmarks_are_met_as_their_accuracy_says(self):
        marks, targets = self.inaccurate(0.03)
        alone, by_default = error(self.fit()), error(self.fit(landmarks=(marks, targets)))
        self.assertLess(by_default, 1.1 * alone)
        exact = self.fit(landmarks=(marks, targets), accuracy=0)
        self.assertGreater(error(exact), by_default)
        self.assertLess(np.linalg.norm(exact[marks] - targets, axis=1).max(), 0.015)

    def test_landmarks_that_contradict_have_advice(self):
        marks, targets = self.inaccurate(0.01)
        self.assertEqual(self.advice(landmarks=(marks, targets)), "")
        for wrong in (TRUTH[900], (2, 2, 2)):
            self.assertRegex(self.advice(landmarks=(marks, np.vstack([targets[:3], [wrong], targets[4:]]))), "^The landmark .*vertex 500")
        marks, targets = marks[:6], TRUTH[marks[:6]]
        self.assertIn("exchanged", self.advice(landmarks=(marks, targets[[0, 4, 2, 3, 1, 5]])))
        self.assertIn("do not match", self.advice(landmarks=(marks, np.roll(targets, 2, axis=0))))

    def test_landmarks_slide_along_the_scan(self):
        for slide, low, high in ((1, 0, 0.02), (0, 0.08, 0.2)):
            normal = normals_of(*HEAD)[200]
            target = HEAD[0][200] + 0.1 * np.cross(normal, (0.3, 0.5, 0.1)) / np.linalg.norm(np.cross(normal, (0.3, 0.5, 0.1)))
            one = {"region": {"component": True}, "fit": {"to": "scan.ply", "align": "none", "accuracy": 0},
                   "handles": [{"vertices": "200", "targets": [target.tolist()], "slide": slide}]}
            _, report = run(HEAD, one, scan=HEAD)
            self.assertTrue(low <= report["handle_residual"] <= high, report["handle_residual"])
            self.assertFalse(report["advice"])  # a target that the vertex slides away from is not wrong

    def test_a_bend_in_mode_pose(self):
        def bent(p):
            """By 60 degrees about the middle, smoothly."""
            t = np.clip((p[:, 0] - 3) / 4, 0, 1)
            a = np.radians(60) * t
            radius = 4 / np.radians(60)
            base = np.stack([3 + radius * np.sin(a), radius * (1 - np.cos(a)), 0 * a], 1)
            rest = np.where(p[:, :1] < 3, p - (3, 0, 0), np.stack([np.maximum(0, p[:, 0] - 7), p[:, 1], p[:, 2]], 1))
            return base + np.stack([np.cos(a) * rest[:, 0] - np.sin(a) * rest[:, 1], np.sin(a) * rest[:, 0] + np.cos(a) * rest[:, 1], rest[:, 2]], 1)

        def limb(around, rings):
            points, faces = tube(around, rings, 10)
            return points * (1, *2 * (0.9,)) * (1, *2 * (1,)) + 0.1 * np.sin(points[:, :1]) * points * (0, 1, 0.5), faces
        arm, (points, faces) = limb(24, 60), limb(30, 71)
        marks = np.array((0, 24 * 15 + 3, 24 * 30 + 9, 24 * 45 + 15, len(arm[0]) - 1))
        found = self.fit(mesh=arm, scan=(bent(points), faces), landmarks=(marks, bent(arm[0])[marks]), mode="pose")
        self.assertLess(error(found, bent(arm[0])), 0.02)
        self.assertEqual((self.report["fit"]["scale"], self.report["flipped"]), (1, 0))

    def test_a_thin_plate_keeps_its_sides(self):
        def plate(around, rings):
            points, faces = tube(around, rings, 4)
            return points * (1, 1, 0.01), faces

        def twisted(p):
            a = np.radians(90) * p[:, 0] / 4
            return np.stack([p[:, 0], np.cos(a) * p[:, 1] - np.sin(a) * p[:, 2], np.sin(a) * p[:, 1] + np.cos(a) * p[:, 2]], 1)
        template, (points, faces) = plate(48, 60), plate(70, 83)
        truth, marks = twisted(template[0]), np.array((0, 24, 48 * 59, 48 * 59 + 24))
        self.assertGreater(error(template[0], truth), 0.1)
        found = self.fit(mesh=template, scan=(twisted(points), faces), landmarks=(marks, truth[marks]), mode="pose")
        self.assertLess(error(found, truth), 0.012)
        self.assertEqual((self.report["advice"] or "", self.report["flipped"]), ("", 0))

    def test_what_is_outside_of_a_part_stays(self):
        away = np.linalg.norm(HEAD[0] - (0, -0.1, 1.2), axis=1)
        bulged = HEAD[0] + np.where(away < 0.5, 0.2 * (1 - (away / 0.5) ** 2) ** 2, 0)[:, None] * Z
        part = {"vertices": np.flatnonzero(away < 0.8).tolist()}
        found = self.fit(scan=(bulged, HEAD[1]), region=part)
        self.assertTrue((found[away >= 0.8] == HEAD[0][away >= 0.8]).all())
        self.assertLess(np.linalg.norm(found - bulged, axis=1).max(), 0.08)  # of a bulge of 0.2
        self.refused("", {"region": part, "fit": {"to": "scan.ply", "align": "rigid"}}, scan=(bulged, HEAD[1]))

    def test_excluded_vertices_follow_the_others(self):
        middle = warped(np.array([(0, 0.8, 0.6)]))[0]
        away = np.linalg.norm(SCAN[0] - middle, axis=1) / 0.4
        dented = SCAN[0] * np.where(away < 1, 1 - 0.25 * (1 - away**2), 1)[:, None]
        excluded = near((TRUTH, None), middle, 0.5)
        faces = np.flatnonzero((away < 1.1)[SCAN[1]].any(1)).tolist()
        errors = [np.linalg.norm(self.fit(scan=(dented, SCAN[1]), **more) - TRUTH, axis=1)[excluded].mean()
                  for more in ({"exclude": {"vertices": excluded.tolist()}}, {"exclude": {"scan_faces": faces}}, {})]
        self.assertLess(max(errors[:2]), 0.4 * errors[2])
        everything = f"0-{len(SCAN[1]) - 1}"
        for sentence, exclude in ((f"has {len(SCAN[1])} faces", {"scan_faces": [len(SCAN[1])]}), ("leave some", {"scan_faces": everything}),
                                  ("No face of the scan", {"scan_selected": True}), ("vertices, scan_faces or scan_selected", {})):
            self.refused(sentence, {"region": {"component": True}, "fit": {"to": "scan.ply", "exclude": exclude}})

    def test_orientation_of_shapes_that_are_nearly_symmetric_is_kept(self):
        for radius in (bone, lambda y: 0.5 + 0.2 * np.sin(3 * y + 0.6), lambda y: 0.3 + 0.1 * np.exp(-8 * (y - 0.3) ** 2)):  # a vase, a limb
            for amount in (0.02, 0.06):
                mesh, truth = revolved(radius, 3, 0, 0), revolved(radius, 3, 0, amount)[0]
                self.assertLess(error(self.fit(mesh=mesh, scan=revolved(radius, 4, 25, amount)), truth), error(mesh[0], truth))

    def test_shapes_that_slid_along_themselves_have_advice(self):
        mesh, marks = revolved(bone, 3, 0, 0), (7, 90, 180, 270, 350, 430, 520, 610)
        for amount, landmarks, slid in ((0.03, False, False), (0.12, False, True), (0.12, True, False)):
            truth = revolved(bone, 3, 0, amount)[0]
            advice = self.advice(mesh=mesh, scan=revolved(bone, 4, 25, amount), landmarks=(marks, truth[list(marks)]) if landmarks else None)
            self.assertEqual("may have slid along the scan, since another smooth" in advice, slid, advice)

    def test_what_fits_in_several_orientations_has_advice_if_it_was_moved(self):
        """An ellipsoid with a nose, turned about its axis; where it lies nothing is said."""
        def egg(levels, degrees):
            points, faces = ball(levels)
            d = points @ rotation((3, 1, 2), degrees).T
            return d * ((1 + 0.05 * np.exp(25 * (d @ (0, -0.0995, 0.995) - 1))) / np.linalg.norm(d / (0.8, 1, 0.92), axis=1))[:, None], faces
        mesh, scan = egg(4, 0), egg(4, 25)
        for degrees in (170, 10):
            self.assertIn("Another orientation", self.advice(mesh=mesh, scan=(warped(scan[0]) @ rotation(Y, degrees).T, scan[1])))
        self.assertEqual(self.advice(mesh=mesh, scan=(1.03 * scan[0], scan[1])), "")

    def test_place_on_part_of_a_scan_and_beside_another_object_is_kept(self):
        sphere = ball(3)
        for scan, bound in ((without(SCAN, lambda p: p[:, 0] < -0.1), 0.04), (without(SCAN, lambda p: p[:, 1] < 0), 0.03),
                            (together(SCAN, (0.8 * sphere[0], sphere[1]), (3, 0.5, 0)), 0.014)):
            self.assertLess(error(self.fit(scan=scan)), bound)

    def test_scans_that_mislead_are_fitted_or_have_advice(self):
        """Two layers, outliers, normals that are flipped at random or on one half; the outer of two layers is taken if a wall's."""
        random = np.random.default_rng(2)
        count = len(SCAN[1]) * 3 // 7
        places = random.uniform(-1, 1, (count, 1, 3)) * (1.3, 1.8, 1.5) + 0.05 * random.uniform(-1, 1, (count, 3, 3))

        def flipped(which):
            return SCAN[0], np.where(which[:, None], SCAN[1][:, ::-1], SCAN[1])
        wall = together(SCAN, (0.95 * SCAN[0], SCAN[1][:, ::-1]), (0, 0, 0))
        self.assertLess(error(self.fit(scan=wall)), 0.02)
        self.assertLess(error(self.fit(mesh=(0.96 * HEAD[0], HEAD[1]), scan=wall, mode="pose")), 0.02)  # the inner one is nearer
        for scan in (together(SCAN, (0.9 * SCAN[0], SCAN[1]), (0, 0, 0)), together(SCAN, (places.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)), 0),
                     *(flipped(random.random(len(SCAN[1])) < share) for share in (0.5, 0.25)), flipped(SCAN[0][SCAN[1][:, 0], 0] > 0)):
            found = self.fit(scan=scan)
            self.assertTrue(error(found) < 0.5 * error(HEAD[0]) or self.report["advice"], error(found))

    def test_other_units_missing_parts_and_mirrored_scans_have_advice(self):
        self.assertIn("same unit", self.advice(scan=(1000 * SCAN[0], SCAN[1])))
        self.assertNotEqual(self.advice(scan=without(SCAN, lambda p: p[:, 2] < 0.8)), "")
        self.assertNotEqual(self.advice(scan=tube(24, 30, 4)), "")  # has many orientations
        self.assertEqual(self.advice(mode="pose"), "")

        def swollen(p):
            return p + 0.6 * np.exp(-4 * ((p - (0.8, 0.6, 0.3)) ** 2).sum(1))[:, None] * (1, 0.4, 0.5)
        mesh = swollen(HEAD[0]), HEAD[1]
        self.assertEqual(self.advice(mesh=mesh, scan=(swollen(SCAN[0]), SCAN[1])), "")
        self.assertRegex(self.advice(mesh=mesh, scan=(swollen(SCAN[0]) * (-1, 1, 1), SCAN[1][:, ::-1])), "^The template's mirror image")

    def test_exchanged_landmarks_turn_a_head_inside_out(self):
        """A ball beside it keeps its partners."""
        sphere, marks = ball(2), np.arange(0, len(HEAD[0]), 40)
        both = together(HEAD, (0.4 * sphere[0], sphere[1]), (0, 3, 0))
        found = self.advice(mesh=both, scan=both, landmarks=(marks, HEAD[0][marks] * (-1, 1, 1)), align="none", accuracy=0)
        self.assertIn("turned inside out, from a volume of ", found)

    def test_borders_of_sheets_are_drawn_if_they_slid_or_if_asked(self):
        def sheet(cells, shift):
            points, faces = grid(cells, cells)
            x, y = points[:, :2].T / (cells - 1)
            return np.stack([x + shift * np.sin(3 * y), y, 0.05 * np.sin(4 * x) * np.cos(3 * y)], 1), faces
        mesh, near, far = sheet(40, 0), sheet(57, 0.01), sheet(57, 0.1)
        truth = sheet(40, 0.01)[0]
        self.assertLess(error(self.fit(mesh=mesh, scan=near, borders=True), truth), 0.6 * error(self.fit(mesh=mesh, scan=near), truth))
        self.assertEqual(self.report["fit"]["slid"], 0)
        found = self.fit(mesh=mesh, scan=far)
        self.assertGreater(self.report["fit"]["slid"], 0)
        self.assertTrue((self.fit(mesh=mesh, scan=far, borders=True) == found).all())
        cropped = without(far, lambda p: p[:, 0] > 0.8)
        self.fit(mesh=mesh, scan=cropped)
        self.assertEqual(self.report["fit"]["slid"], 0)

    def test_pieces_that_the_scan_does_not_show_follow_the_surface(self):
        """An eye behind the surface and a lash on it, and a ball beside it, which the scan shows."""
        sphere = ball(2)
        eye, shown = (0.13 * sphere[0] + (-0.3, 0.15, 0.6), sphere[1]), (0.25 * sphere[0] + (0, 1.75, 0), sphere[1])
        lash = HEAD[0][nearest(HEAD, (0.4, 0.2, 0.9))] + np.array([(-0.1, 0, 0), (0.1, 0, 0), (0.1, 0.02, 0.08), (-0.1, 0.02, 0.08)])
        first, whole = len(HEAD[0]), HEAD
        for piece in (eye, (lash, np.array([(0, 1, 2), (0, 2, 3)])), shown):
            whole = together(whole, piece, 0)
        count = len(whole[0]) - first - len(shown[0])
        truth = warped(whole[0])
        truth[first + count:] = shown[0] + 0.1
        scan = together(SCAN, (shown[0] + 0.1, shown[1]), 0)
        for landmarks in (None, (np.array(MARKS[:4]), truth[list(MARKS[:4])])):
            errors = np.linalg.norm(self.fit(mesh=whole, scan=scan, landmarks=landmarks) - truth, axis=1)
            self.assertEqual(self.report["fit"]["hidden_pieces"], 2)
            self.assertLess(errors[first:first + count].mean(), 0.02)
            self.assertLess(errors[first + count:].mean(), 0.03)  # of 0.17
        found = self.fit(mesh=whole, scan=scan, exclude={"vertices": list(range(first + count, len(truth)))})
        self.assertEqual(self.report["fit"]["hidden_pieces"], 3)
        self.assertGreater(np.linalg.norm(found - truth, axis=1)[first + count:].mean(), 0.1)  # the scan does not draw it

    def test_a_piece_that_lies_where_another_lies_has_advice(self):
        """The third one of a row of heads is missing: its neighbour draws it."""
        def row(levels, degrees, *places):
            whole = head(levels, degrees)
            for at in places:
                whole = together(whole, head(levels, degrees), at)
            return whole
        places = [(1.9 * k, 0.3 * np.sin(k), 0.15 * k * k) for k in range(1, 6)]
        mesh = row(3, 0, *places)
        self.assertIn("lie where other parts of it lie too", self.advice(mesh=mesh, scan=row(3, 25, *places[:1], *places[2:])))
        self.assertEqual(self.advice(mesh=mesh, scan=row(3, 25, *places)), "")

    def test_coordinates_numbers_mirror_images_soups_and_nan_points_without_faces_change_nothing(self):
        expected = self.fit()

        def moved(p):
            return 3 * p @ rotation((1, 2, 0.5), 130).T + (7, -4, 2)

        def renumbered(mesh):
            return mesh[0][::-1], np.roll((len(mesh[0]) - 1 - mesh[1])[::-1], 1, axis=1)

        def with_nan_first(mesh):
            return np.vstack([np.full((1, 3), np.nan), mesh[0]]), mesh[1] + 1
        self.assertLess(np.abs(self.fit(mesh=(moved(HEAD[0]), HEAD[1]), scan=(moved(SCAN[0]), SCAN[1])) - moved(expected)).max(), 1e-7)
        self.assertLess(np.abs(self.fit(mesh=renumbered(HEAD), scan=renumbered(SCAN))[::-1] - expected).max(), 1e-7)
        image = [(points * (-1, 1, 1), faces[:, ::-1]) for points, faces in (HEAD, SCAN)]
        self.assertLess(np.abs(self.fit(mesh=image[0], scan=image[1]) * (-1, 1, 1) - expected).max(), 1e-7)
        self.assertTrue((self.fit(scan=with_nan_first(SCAN)) == expected).all())
        self.assertTrue((self.fit(mesh=with_nan_first(HEAD))[1:] == expected).all())
        soup = HEAD[0][HEAD[1].ravel()], np.arange(HEAD[1].size).reshape(-1, 3)
        self.assertLess(error(self.fit(mesh=soup), TRUTH[HEAD[1].ravel()]), 0.02)

    def test_a_fit_is_a_step_among_others_and_has_fractions(self):
        fit = {"region": {"component": True}, "fit": {"to": "scan.ply"}}
        (rest, half, whole), _ = run(HEAD, fit, fractions="0,0.5,1", scan=SCAN)
        self.assertTrue((rest == HEAD[0]).all())
        self.assertLess(np.abs(half - 0.5 * (HEAD[0] + whole)).max(), 1e-14)
        (both,), report = run(HEAD, fit, step(handle(5, translation=(0, 0, 0.1)), region={"radius": 0.6}), scan=SCAN)
        self.assertGreater(np.linalg.norm(both[5] - whole[5]), 0.09)
        self.assertIsNone(report.get("fit"))

    def test_what_cannot_be_fitted_is_refused(self):
        def fit(*handles, **more):
            return {"region": {"component": True}, "fit": {"to": "scan.ply", **more}, **({"handles": list(handles)} if handles else {})}
        for scale in (1e80, 1e-80):
            self.refused("another unit of length", fit(), mesh=(scale * HEAD[0], HEAD[1]))
            self.refused("scan", fit(), scan=(scale * SCAN[0], SCAN[1]))
        for align in ("rigid", "none"):
            self.refused("bring both to the same unit", fit(align=align), scan=(2000 * SCAN[0], SCAN[1]))
        self.refused("has no targets", fit({"vertices": "3"}))
        self.refused("mirror", {**fit(), "mirror": {"point": [0, 0, 0], "normal": [1, 0, 0]}})
        self.refused("Vertex 3 has two landmarks", fit(*({"vertices": "3", "targets": [[0, k, 1]]} for k in (0, 1))))
        self.refused("stop at contact", {**fit(), "contact": True})
        self.refused("is empty", fit(to=""))
        self.refused("1000000", fit(exclude={"vertices": [1000000]}))
        self.refused("", fit(), scan=(SCAN[0], [], 0 * SCAN[0]))
        self.refused("", fit(), scan=(0 * SCAN[0], SCAN[1]))
        self.refused("", fit(), scan=(0 * SCAN[0] + 0.3, [], 0 * SCAN[0] + Z))
        for detail in (0, 0.5):
            self.refused("detail", fit(detail=detail))
        far = SCAN[0] + 100 * X, SCAN[1]
        self.refused("or give three landmarks", fit(align="none", distance=1), scan=far)
        marks = {"vertices": "3,100,250", "targets": [[-100, 0, 0]] * 3}
        self.refused("although 3 landmarks were given", fit(marks, align="none", distance=1), scan=far)
        self.refused("left and right may be exchanged", fit(marks, align="none", distance=1), scan=far)


if __name__ == "__main__":
    unittest.main()
