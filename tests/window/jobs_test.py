# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs in the real window, each in few actions, by X events."""
import math
import unittest

from tool import ToolTest, part
from ply import write_ply
from shapes import dome, together


class Jobs(ToolTest):
    SIDE = 61
    MIDDLE = 30 * SIDE + 30
    DEPTH = 0.06
    WALL = 0.72

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        flat, faces = dome(cls.SIDE, cls.SIDE)
        dented = [(x, y, -cls.DEPTH * math.exp(-(math.dist((x, y), (0.5, 0.5)) / 0.09) ** 4)) for x, y, _ in flat]
        cls.dent = write_ply(cls.folder / "dent.ply", dented, faces)

        def is_open(v):
            return abs(flat[v][1] - 0.5) < 0.06 * (1 - (abs(flat[v][0] - 0.5) / 0.2) ** 2)

        kept = [f for f in faces if not all(is_open(v) for v in f)]
        sides = {(f[k], f[k - 2]) for f in kept for k in range(3)}
        cls.lips = sorted({v for a, b in sides if (b, a) not in sides for v in (a, b) if 0.1 < flat[v][0] < 0.9
                           and 0.1 < flat[v][1] < 0.9})
        cls.mouth = write_ply(cls.folder / "mouth.ply", [(x, y, 0.2 * x * (1 - x)) for x, y, _ in flat], kept)
        tower = [(x, y, 0.4 * math.exp(-(math.dist((x, y), (0.5, 0.5)) / 0.1) ** 4)) for x, y, _ in flat]
        wall = [(cls.WALL, 0.3 + 0.4 * x, 0.08 + 0.5 * y) for x, y, _ in dome(21, 21)[0]]
        cls.scene = write_ply(cls.folder / "wall.ply", *together((tower, faces), (wall, dome(21, 21)[1])))

    def stroke(self, w, points, *keys):
        """Draws from point to point of the screen with the left button, while keys are held."""
        steps = [c for key in keys for c in ("keydown", key)] + ["mousemove", *points[0], "sleep", 0.2, "mousedown", 1]
        for point in points[1:]:
            steps += ["mousemove", *point, "sleep", 0.05]
        w.x(*steps, "mouseup", 1, *[c for key in keys for c in ("keyup", key)])
        self.settle(w)

    def lasso(self, w, vertices, *keys):
        """Draws an ellipse around some vertices."""
        pixels = [self.on_screen(w, v) for v in vertices]
        (low, high) = ([f(p[k] for p in pixels) for k in (0, 1)] for f in (min, max))
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        radii = [0.72 * (b - a) + 12 for a, b in zip(low, high)]
        self.stroke(w, [tuple(round(m + r * f(2 * math.pi * k / 24)) for m, r, f in zip(middle, radii, (math.cos, math.sin)))
                        for k in range(25)], *keys)

    def slide_to_flat(self, w):
        x, y, width, height = w.widget(part("detail"))["rectangle"]
        row = round(y + height / 2)
        self.stroke(w, [(round(x + width / 2), row), (round(x + width / 4), row), (round(x - 5), row)])
        self.assertLess(max(abs(z) for _, _, z in w.dump().triples()), 0.01 * self.DEPTH)

    def test_a_dent_becomes_flat_in_two_actions(self):
        with self.start(self.dent, disc=20) as w:
            before = w.dump()
            self.x_click(w, self.MIDDLE)  # 1
            self.slide_to_flat(w)  # 2
            step, = self.steps_of(w)
            self.assertEqual(step["detail"], 0)
            self.assertNotIn("handles", step)
            self.assert_replay_is_the_same(w, self.dent)
            self.undo(w)
            self.assert_same(before, w.dump())
            self.assertEqual(w.widget(part("detail"))["value"], 100)

    def test_a_pipe_is_bent_by_30_degrees_in_six_actions(self):
        around, along = 24, 61
        points = [(k / (along - 1), 0.08 * math.sin(2 * math.pi * j / around), 0.08 * math.cos(2 * math.pi * j / around))
                  for k in range(along) for j in range(around)]
        corner = lambda k, j: k * around + j % around  # noqa: E731
        faces = [f for k in range(along - 1) for j in range(around) for f in (
            (corner(k, j), corner(k + 1, j + 1), corner(k + 1, j)), (corner(k, j), corner(k, j + 1), corner(k + 1, j + 1)))]
        pipe = write_ply(self.folder / "pipe.ply", points, faces)
        with self.start(pipe, disc=20) as w:
            before = w.dump()
            w.x_focus()
            self.x_click(w, corner(57, 0))  # 1
            w.x("click", "--repeat", 12, 4)  # 2: the wheel
            self.settle(w)
            self.x_key(w, "p", "p")  # 3
            self.x_key(w, "r", "z", "3", "0", "Return")  # 4 to 6
            rotation = self.steps_of(w)[0]["handles"][0]["rotation"]
            self.assertEqual((abs(rotation["degrees"]), rotation["axis"]), (30, [0, 0, 1]))
            # The middle of the pipe at the handle goes around the pivot.
            (x, y, z), (u, v, t) = ([sum(c) / around for c in zip(*dump.triples()[corner(57, 0):corner(58, 0)])]
                                    for dump in (before, w.dump()))
            at = rotation["center"]
            turned = math.atan2(v - at[1], u - at[0]) - math.atan2(y - at[1], x - at[0])
            self.assertAlmostEqual(abs(math.degrees(turned)), 30, delta=2)
            self.assertLess(abs(t - z), 0.01)
            self.assertFalse(before.moved(w.dump()) & set(range(12 * around)))
            self.assert_replay_is_the_same(w, pipe)

    def test_a_mouth_is_closed_in_four_actions(self):
        def gap():
            heights = [w.dump().triples()[v][1] for v in self.lips]
            return max(heights) - min(heights)

        with self.start(self.mouth, disc=20) as w:
            before = gap()
            w.x_focus()
            w.x("mousemove", *self.on_screen(w, self.MIDDLE - 20 * self.SIDE))
            self.x_key(w, "b", "b")  # 1: paint the handle
            self.lasso(w, self.lips, "ctrl", "alt")  # 2
            self.x_key(w, "Escape")  # 3
            self.x_key(w, "s", "y", "1", "percent", "Return")  # 4
            self.assertLess(gap(), 0.02 * before, self.message(w))
            self.assert_replay_is_the_same(w, self.mouth)

    def test_a_tower_stops_at_a_wall(self):
        with self.start(self.scene, disc=20) as w:
            w.set(part("contact"), True)
            self.x_click(w, self.MIDDLE)
            self.x_key(w, "t", "x", "0", "period", "4")
            self.settle(w)
            colours = w.grab(self.folder / "screen.ppm").read_bytes()
            self.assertGreater(colours.count(bytes((230, 159, 0))), 60, "no line from the handle to its target")
            self.x_key(w, "Return")
            points = w.dump().triples()
            self.assertLess(max(x for x, _, _ in points[self.MIDDLE - 5 * self.SIDE:self.MIDDLE]), self.WALL)
            self.assertGreater(points[self.MIDDLE][0], 0.55)
            self.assertIn("before its target", self.message(w))
            self.assertIs(self.steps_of(w)[0]["contact"], True)
            self.assert_replay_is_the_same(w, self.scene)


if __name__ == "__main__":
    unittest.main()
