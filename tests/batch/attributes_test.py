# SPDX-License-Identifier: GPL-3.0-or-later
"""An edit changes coordinates and normals and nothing else that MeshLab saves."""
import random
import unittest

from host import FilterHost, laplacian_edit
from ply import Ply, write_ply
from shapes import dome

# All that the PLY exporter can save: vertex colour, quality, flags (with the selection) and texture coordinates;
# face colour, quality, flags; texture coordinates of the corners.
EVERYTHING = ("vc", "vq", "vf", "vt", "fc", "fq", "ff", "wt")
COORDINATES, NORMALS = {"x", "y", "z"}, {"nx", "ny", "nz"}


class AttributesTest(FilterHost):
    def check(self, mesh, edit, expected):
        """@param expected  properties, element by element, that the file must have besides the coordinates"""
        before = Ply(self.edited([], mesh, save=EVERYTHING)[0]).elements
        after = Ply(self.edited([edit], mesh, save=EVERYTHING)[0]).elements
        self.assertEqual(before.keys(), after.keys())
        for element, columns in before.items():
            self.assertLessEqual(expected.get(element, set()), columns.keys())
            self.assertEqual(columns.keys(), after[element].keys())
            for name, values in columns.items():
                if element == "vertex" and name in COORDINATES:
                    self.assertNotEqual(values, after[element][name])
                elif name not in NORMALS:
                    self.assertEqual(values, after[element][name], f"{element} {name}")
        return before

    def test_all_attributes_at_once(self):
        random.seed(1)
        points, faces = dome()
        selected = 32  # the selection's bit in MeshLab's flags
        header = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue", "alpha"))
        header += "property float quality\nproperty int flags\n"

        def row():
            colour = " ".join(str(random.randrange(256)) for _ in range(4))
            return f"{colour} {random.random()} {random.choice((0, selected))}"

        mesh = write_ply(
            self.folder / "all.ply", points, faces, header, [row() for _ in points],
            header + "property list uchar float texcoord\n",
            [f"{row()} 6 " + " ".join(str(random.random()) for _ in range(6)) for _ in faces])
        colours = {"red", "green", "blue", "alpha"}
        before = self.check(
            mesh, laplacian_edit(handle_point=points[220], radius=0.35, translation=(0.1, 0.1, 0.2)),
            {"vertex": colours | {"quality", "flags"}, "face": colours | {"quality", "flags", "texcoord"}})
        # The mesh that was compared has all of it, and not only zeros.
        for name in ("vertex red", "vertex quality", "face green", "face quality", "face texcoord"):
            self.assertGreater(len(set(before[name.split()[0]][name.split()[1]])), 100)
        for element in ("vertex", "face"):
            self.assertEqual({flags & selected for flags in before[element]["flags"]}, {0, selected})


if __name__ == "__main__":
    unittest.main()
