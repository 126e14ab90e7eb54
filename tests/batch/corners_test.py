# SPDX-License-Identifier: GPL-3.0-or-later
"""Files whose faces name vertices that are not there, through laplacian-edit: readers of MeshLab let them pass."""
import subprocess
import unittest

from host import COMMAND, HostTest, laplacian_edit, without_display
from shapes import dome

UNREADABLE = 3


class CornersTest(HostTest):
    screen = None

    def write_off(self, points, faces):
        path = self.folder / "mesh.off"
        lines = [f"OFF\n{len(points)} {len(faces)} 0", *(" ".join(map(str, p)) for p in points),
                 *(" ".join(map(str, (len(f), *f))) for f in faces)]
        path.write_text("\n".join(lines) + "\n")
        return path

    def test_a_corner_out_of_range_is_reported_with_face_and_vertex(self):
        points, faces = dome()
        script = self.folder / "script.mlx"
        script.write_text(f"<FilterScript>{laplacian_edit(handle_point=points[220], radius=0.3)}</FilterScript>")
        edit = self.folder / "edit.json"
        edit.write_text('{"laplacian_edit": 1, "steps": '
                        '[{"region": {"radius": 0.3}, "handles": [{"vertices": "220", "translation": [0, 0, 0.2]}]}]}')
        for number in (-2000000000, -1, len(points), len(points) + 20, 2000000000):
            for corners in ((0, number, 22), (0, 1, number, 22)):
                if len(corners) > 3 and abs(number) > 1000:
                    continue  # MeshLab's own reader looks at the corners of polygons
                changed = [tuple(f) for f in faces]
                changed[17] = corners
                mesh = self.write_off(points, changed)
                for how in (edit, script):
                    with self.subTest(corners=corners, how=how.suffix):
                        done = subprocess.run([COMMAND, mesh, self.folder / "out.ply", how], timeout=60,
                                              env=without_display(self.environment), stdout=subprocess.PIPE,
                                              stderr=subprocess.PIPE)
                        self.assertEqual(done.returncode, UNREADABLE, done.stderr)
                        errors = done.stderr.decode()
                        if "Assertion" in errors:  # a MeshLab whose reader looks, built with assertions
                            self.assertRegex(errors.splitlines()[-1], "stopped with an error of its own while reading")
                        else:
                            self.assertRegex(errors, rf"\AThe mesh \"[^\n]+\" cannot be read: face 17 names vertex {number}, "
                                             rf"but there are {len(points)} vertices, counted from 0: [^\n]+\.\n\Z")
                        self.assertFalse((self.folder / "out.ply").exists())


if __name__ == "__main__":
    unittest.main()
