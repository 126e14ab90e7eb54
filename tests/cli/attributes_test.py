# SPDX-License-Identifier: GPL-3.0-or-later
"""An edit changes coordinates and normals and nothing else that MeshLab saves."""
import random
import unittest

from host import FilterHost, laplacian_edit
from ply import SCALAR, Ply, mesh_files
from shapes import dome, with_seam

# All that the PLY exporter can save: vertex colour, quality, flags (with the selection) and texture coordinates;
# face colour, quality, flags; texture coordinates of the corners.
EVERYTHING = ("vc", "vq", "vf", "vt", "fc", "fq", "ff", "wt")
COORDINATES, NORMALS = {"x", "y", "z"}, {"nx", "ny", "nz"}


class AttributesTest(FilterHost):
    def saved(self, filters, mesh):
        return Ply(self.edited(filters, mesh, save=EVERYTHING)[0]).elements

    def test_all_attributes_at_once(self):
        random.seed(1)
        (points, faces), seam = with_seam(dome(), lambda x, y, z: x > y)
        selected = 32  # the selection's bit in MeshLab's flags
        extra = [*(f"uchar {c}" for c in ("red", "green", "blue", "alpha")), "float quality", "int flags"]

        def row(*corners, texture=()):
            more = [*(random.randrange(256) for _ in range(4)), random.random(), random.choice((0, selected))]
            return "", (*corners, *more, *texture)

        mesh = self.folder / "all.ply"
        mesh.write_bytes(mesh_files.rows_of_ply("ascii", [
            ("vertex", [*(f"{SCALAR} {c}" for c in "xyz"), *extra], [row(*point) for point in points]),
            ("face", ["list uchar int vertex_indices", *extra, "list uchar float texcoord"],
             [row(3, *face, texture=(6, *(random.random() for _ in range(6)))) for face in faces])]))
        before = self.saved([], mesh)
        after = self.saved([laplacian_edit(handle_point=points[220], radius=0.35, translation=(0.1, 0.1, 0.2))], mesh)
        self.assertEqual({e: columns.keys() for e, columns in before.items()}, {e: columns.keys() for e, columns in after.items()})
        for element, columns in before.items():
            for name, values in columns.items():
                if element == "vertex" and name in COORDINATES:
                    self.assertNotEqual(values, after[element][name])
                elif name not in NORMALS:
                    self.assertEqual(values, after[element][name], f"{element} {name}")
        # Vertices at the same place stay there together, each with its own attributes.
        for one, other in seam:
            self.assertEqual(*([after["vertex"][c][v] for c in sorted(COORDINATES)] for v in (one, other)))
        self.assertTrue(any(before["vertex"]["red"][a] != before["vertex"]["red"][b] for a, b in seam))
        # The mesh that was compared has all of it, and not only zeros.
        for element in ("vertex", "face"):
            for name in ("red", "green", "blue", "alpha", "quality", *(["texcoord"] if element == "face" else [])):
                self.assertGreater(len(set(before[element][name])), 100)
            self.assertEqual({flags & selected for flags in before[element]["flags"]}, {0, selected})


if __name__ == "__main__":
    unittest.main()
