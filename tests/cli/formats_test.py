# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit changes coordinates and normals of the vertices that an edit moves, and no other byte of a file,
whatever its format."""
import contextlib
import json
import math
import os
import pathlib
import resource
import shutil
import struct
import subprocess
import threading
import unittest

from program import COMMAND, DOME, REFUSED, SANITIZED, UNREADABLE, MeshBytes, ProgramTest, files
from x_server import host_environment, start_x_server

REAL = ("texturedknot.ply", "mannequin.off", "bunny10k_textured.obj", "busted.STL")


class Bytes(ProgramTest):
    def check(self, name, data):
        """@return the edited file, and its numbers"""
        path, out = self.work / name, self.work / ("out_" + name)
        path.write_bytes(data)
        before = MeshBytes(name, data)
        used = sorted({v for polygon in before.polygons for v in polygon})
        box = [(min(c), max(c)) for c in zip(*(before.points[v] for v in used))]
        size, middle = math.dist(*zip(*box)), [sum(ends) / 2 for ends in box]
        vertex = min(used, key=lambda v: math.dist(before.points[v], middle))
        edits = [self.write_edit({"region": {"radius": 0.2 * size}, "handles": [{"vertices": str(vertex), **motion}]}, name=file)
                 for motion, file in (({"translation": [0.02 * size, 0, 0.05 * size]}, "edit.json"), ({}, "still.json"))]
        for arguments in ((edits[0], "--fraction", "0"), (edits[1],)):
            self.done(path, out, *arguments, "--quiet")
            self.assertTrue(out.read_bytes() == data, "bytes changed without an edit")
        self.done(path, out, edits[0], "--quiet", "--report", "report.json")
        after = MeshBytes(name, out.read_bytes())
        after.users = before.users  # quads of OFF may get other diagonals with the new positions

        # The same mesh without polygons, in the simplest format.
        plain = self.work / "simple.ply"
        plain.write_bytes(files.ply_plain((before.points, before.triangles), "float" if before.is_single else "double"))
        self.done(plain, plain, edits[0], "--quiet")
        expected = MeshBytes("simple.ply", plain.read_bytes()).points
        self.assertTrue(after.points == expected, "other positions than those of the simple file")
        moved = {v for v, point in enumerate(expected) if point != before.points[v]}
        self.assertIn(vertex, moved)
        self.assertLess(len(moved), len(before.points))

        self.assertTrue(after.between() == before.between(), "bytes between the numbers changed")
        shared = self.check_numbers(before, after, moved)
        (output,) = json.loads((self.work / "report.json").read_text())["outputs"]
        self.assertEqual(output["shared_normals"], shared)
        self.assertEqual(shared > 0, name == "shared_normals.obj")
        return out, after

    def check_numbers(self, before, after, moved):
        """@return the number of normals that moved vertices and others use"""
        shared = 0
        for old, new in zip(before.groups, after.groups):
            kind, number, _, old_values = old
            old_texts, new_texts = before.texts(old), after.texts(new)
            if kind == "position":  # digits of a number that stays are kept too
                self.assertEqual([a != b for a, b in zip(old_texts, new_texts)], [a != b for a, b in zip(old_values, new[3])], old)
                continue
            if kind == "facet normal":
                may_change = not moved.isdisjoint(before.polygons[number])
            else:
                users = {corner[0] for corner in before.users.get(number, ())}
                may_change = bool(users) and users <= moved
                shared += not may_change and not users.isdisjoint(moved)
            normal = after.normal(kind, number)
            if may_change and any(normal):
                self.assertAlmostEqual(math.hypot(*new[3]), 1, delta=1e-6)
                self.assertLess(math.dist(new[3], normal), 1e-5, old)
            else:
                self.assertEqual(old_texts, new_texts, old)
        return shared

    def test_generated_files(self):
        """MeshLab 2020.09, where it is there, reads the new positions from the files that it knows."""
        server, compared = shutil.which("meshlabserver") and shutil.which("Xvfb"), set()
        environment = server and host_environment(start_x_server(self.addCleanup, "640x480"), self.folder)
        for name, data in (*files.plain_files(DOME), ("text_quads.off", files.off(files.sheet())), *files.all_files()):
            with self.subTest(name):
                out, after = self.check(name, data)
                read = self.work / "read.ply"
                read.unlink(missing_ok=True)
                if server and name.startswith(("text", "binary", "ascii")):
                    subprocess.run(["meshlabserver", "-i", out, "-o", read], env=environment, timeout=100, check=False, capture_output=True)
                if read.exists():
                    there = MeshBytes("read.ply", read.read_bytes())
                    self.assertTrue(name.endswith(".stl") or there.triangles == after.triangles, "other diagonals")
                    self.assertTrue([tuple(p) for p in there.points] ==
                                    [struct.unpack("3f", struct.pack("3f", *point)) for point in after.points])
                    compared.add(name)
        if server:
            self.assertLessEqual({"text.ply", "binary.ply", "text.off", "text_quads.off", "binary.stl", "text.stl", "ascii_float.ply"}, compared)

    @unittest.skipUnless(os.environ.get("LAPEDIT_MESHES"), "needs the real meshes")
    def test_real_files(self):
        for name in REAL:
            with self.subTest(name):
                self.check(name, (pathlib.Path(os.environ["LAPEDIT_MESHES"]) / name).read_bytes())


class OtherSystem(ProgramTest):
    @unittest.skipUnless("LAPEDIT_OTHER_COMMAND" in os.environ, "needs the program of another system")
    def test_the_same_numbers_between_the_same_bytes(self):
        edit = self.write_edit({"region": {"component": True}, "handles": [
            {"vertices": "0-10"}, {"vertices": "58-62", "rotation": {"axis": [1, 2, 3], "degrees": 40}}]})
        for name, data in files.all_files():
            with self.subTest(name):
                # Names that differ in case are one name on Windows.
                path, out = self.work / ("in" + name[-4:]), self.work / ("out" + name[-4:].lower())
                path.write_bytes(data)
                outputs = []
                for command in (COMMAND, os.environ["LAPEDIT_OTHER_COMMAND"]):
                    subprocess.run([command, "-q", path.name, out.name, edit], cwd=self.work, check=True)
                    outputs.append(MeshBytes(name, out.read_bytes()))
                here, there = outputs
                self.assertTrue(data != here.data and here.between() == there.between())
                size = max(abs(c) for point in here.points for c in point)
                for (kind, _, _, expected), (_, _, _, found) in zip(here.groups, there.groups):
                    allowed = (size if kind == "position" else 1) * (1e-6 if here.is_single else 1e-9)
                    self.assertLess(math.dist(expected, found), allowed)


class Damage(ProgramTest):
    def test_no_faces(self):
        mesh = files.sheet()[0], []
        for name, data in (("a.ply", files.ply_plain(mesh)), ("a.obj", files.obj(mesh)), ("a.off", files.off(mesh)),
                           ("a.stl", b"solid a\nendsolid\n")):
            (self.work / name).write_bytes(data)
            self.refused(REFUSED, "no (vertices|faces)|0 (vertices|faces)", name, "out" + name[-4:], "-",
                         given=b'{"laplacian_edit": 1, "steps": [{"region": {"component": true}, "handles": [{"vertices": "0"}]}]}')
            self.assertIn("faces: 0\n", self.done("--info", name))

    def test_selection_of_meshlab(self):
        begin, rows = files.ply_plain(files.sheet()).decode().replace("z\n", "z\nproperty int flags\n").replace(
            "indices\n", "indices\nproperty int flags\n").split("end_header\n")
        for vertices, handles in (([60, 61], 2), ([], 4)):  # the corners of the face where no vertex is selected
            lines = [line + (" 32" if row in (*vertices, 121) else " 6") for row, line in enumerate(rows.splitlines())]
            (self.work / "in.ply").write_text("\n".join([begin + "end_header", *lines, ""]))
            self.assertIn(f"selected: {len(vertices)} vertices, 2 faces\n", self.done("--info", "in.ply"))
            edit = self.write_edit({"region": {"radius": 0.4}, "handles": [{"selected": True, "translation": [0, 0, 0.1]}]})
            self.done("in.ply", "out.ply", edit, "--report", "report.json")
            (step,) = json.loads((self.work / "report.json").read_text())["outputs"][0]["steps"]
            self.assertEqual(step["handle"], handles)

    def test_off_that_is_not_read_line_by_line(self):
        whole = files.off(([(x, y, 0) for x in range(4) for y in range(4)], [[0, 1, 5, 4]] * 3), more=" 9 9 9")
        for sentence, data in ((r"a (whole )?number is missing|more than the vertices", whole[:-10]),
                               (r"more than the vertices", whole.replace(b"\n16 3", b"\n32 2")),
                               (r"fourth coordinate .* is not 1: divide", whole.replace(b"OFF", b"4OFF")),
                               (r"NCOFF does not tell", whole.replace(b"OFF", b"NCOFF")),
                               *((r"header is not that of an OFF file", whole.replace(b"OFF", word)) for word in (b"nOFF", b"CCOFF", b"4nOFF"))):
            (self.work / "a.off").write_bytes(data)
            self.refused(UNREADABLE, sentence, "--info", "a.off")

    def test_truncated_files(self):
        small = ([(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0)], [[0, 1, 2, 3], [0, 1, 2]])
        for name, data, is_text in (("a.ply", files.ply("binary_little_endian", small), False), ("a.stl", files.stl_binary(small), False),
                                    ("b.ply", files.ply("binary_big_endian", small, "double", "ushort"), False),
                                    ("a.off", files.off(small, "CNOFF", " 0 0 1 1 0 0 1"), True), ("t.ply", files.ply("ascii", small), True),
                                    ("a.obj", files.obj(small, lambda v: f"{v}/1/{v}"), True), ("t.stl", files.stl_text(small), True)):
            for size in range(0, len(data), 17 if is_text else 5):  # fuzzers read all others
                (self.work / name).write_bytes(data[:size])
                code, _, errors = self.run_program("--info", name)
                with self.subTest(name=name, size=size):
                    self.assertIn(code, (0, UNREADABLE) if is_text else (UNREADABLE,))
                    self.assertRegex(errors, r"\A\Z" if code == 0 else r"\AThe mesh .* cannot be read: [^\n]+\.\n\Z")

    def test_headers_that_lie(self):
        mesh = files.sheet()
        binary, off = files.ply("binary_little_endian", mesh, count="int"), files.off(mesh)
        camera = binary.index(b"end_header\n") + 11 + 4  # its list
        self.check_refusal("texture.ply", b"ply\nformat ascii 1.0\ncomment TextureFile")
        self.check_refusal("format.ply", files.ply("ascii", mesh).replace(b"format ascii 1.0\n", b"", 1))
        for name, other in (("real", b"uchar float vertex_indices"), ("name", b"uchar int corners")):
            self.check_refusal(name + ".ply", files.ply_plain(mesh).replace(b"uchar int vertex_indices", other, 1))
            self.refused(UNREADABLE, "no list vertex_indices of whole numbers", "--info", name + ".ply")
        for number in (2**31 - 1, 2**31, 2**32 - 1, 2**63, 10**30, -1):
            text, low = b"%d" % number, struct.pack("<I", number % 2**32)
            lies = {e + ".ply": binary.replace(b"element " + e.encode(), b"element " + e.encode() + b" " + text)
                    for e in ("vertex", "face", "edge")}
            lies["empty.ply"] = binary.replace(b"comment made", b"element x %s\ncomment made" % text)[:-1]
            lies["text.ply"] = files.ply("ascii", mesh).replace(b"\n4 0 11 ", b"\n%s 0 11 " % text, 1)
            lies["vertices.off"], lies["faces.off"] = (off.replace(*words, 1) for words in (
                (b"121 ", text + b" "), (b"\n121 ", b"\n121 " + text)))
            lies["corners.off"] = off.replace(b"\n4 0 ", b"\n%s 0 " % text, 1)
            if number % 2**32 != 0:
                lies["count.stl"] = b"any".ljust(80) + low + bytes(500)
                lies["list.ply"] = binary[:camera] + low + binary[camera + 4:]
            for name, data in lies.items():
                with self.subTest(name, number=number):
                    self.check_refusal(name, data)

    def test_more_than_the_header_counts(self):
        """The faces that are not counted would stay where they are."""
        for name, data in files.plain_files(DOME):
            counts = {"ply": (b"face 800", b"face 799"), "off": (b"441 800", b"441 799"), "stl": (struct.pack("<I", 801), struct.pack("<I", 799))}
            if name[-3:] in counts and name != "text.stl":
                self.check_refusal(name, data.replace(*counts[name[-3:]], 1))
                (self.work / name).write_bytes(data + (bytes(100) if name.startswith("binary") else b"\r\n \n"))
                self.assertIn("faces: 800\n", self.done("--info", name))

    def test_a_polygon_of_more_corners_than_vertices(self):
        for name, write in (("a.obj", files.obj), ("a.off", files.off), ("a.ply", lambda m: files.ply("binary_big_endian", m, count="int"))):
            self.check_refusal(name, write((files.sheet()[0], [100000 * [0, 1, 12]])), math.inf)

    @unittest.skipIf(SANITIZED, "takes longer")
    def test_work_is_linear(self):
        """The limits stop quadratic work, which would take minutes."""
        sheet = files.sheet()
        begin, end = files.ply_plain(sheet).split(b"end_header\n")
        nan = struct.pack("<12fH", *12 * [math.nan], 0)
        for name, data in (("nan.stl", b"x".ljust(80) + struct.pack("<I", 100000) + 100000 * nan),
                           ("elements.ply", begin + b"".join(b"element e%d 0\n" % k for k in range(100000)) + b"end_header\n" + end),
                           ("properties.ply", begin + b"element e 0\n" + b"".join(b"property int p%d\n" % k for k in range(100000))
                            + b"end_header\n" + end)):
            (self.work / name).write_bytes(data)
            self.done("--info", name, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (10, 10)))
        edit = '{"laplacian_edit": 1, "steps": [' + ",".join(300000 * ["{}"]) + "]}"
        self.refused(REFUSED, "the key is missing", "elements.ply", "out.ply", "-", given=edit.encode(),
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (10, 10)))

    def test_binary_stl_that_begins_with_solid(self):
        data = files.stl_binary(DOME, b"solid or not")
        for end in (b"", b"\n", bytes(100)):
            (self.work / "a.stl").write_bytes(data + end)
            self.assertIn("vertices: 441 ", self.done("--info", "a.stl"))
        (self.work / "a.stl").write_bytes(data[:-1])
        self.refused(UNREADABLE, "bytes, but an STL file of 801 triangles", "--info", "a.stl")

    def test_text_stl_with_end_in_a_word_of_its_own(self):
        for old, new in ((b"endloop", b"end loop"), (b"endfacet", b"END FACET"), (b"endsolid", b"end solid")):
            data = files.stl_text(DOME).replace(old, new)
            (self.work / "a.stl").write_bytes(data)
            self.assertIn("vertices: 441 ", self.done("--info", "a.stl"))
            self.done("a.stl", "out.stl", self.edit, "--fraction", "0", "-q")
            self.assertEqual((self.work / "out.stl").read_bytes(), data)

    def test_words_are_cut_between_letters(self):
        (self.work / "a.obj").write_text("v 0 0 x" + 100 * "\u00e4" + "\n", encoding="utf-8")
        self.refused(UNREADABLE, '"x' + 59 * "\u00e4" + r'\.\.\." is no number', "--info", "a.obj")

    def check_refusal(self, name, data=None, most=0.1):
        """In one sentence, within so many seconds of processor time, which other programs hardly change, and 50 MB."""
        if data is not None:
            (self.work / name).write_bytes(data)

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
            if not SANITIZED:
                resource.setrlimit(resource.RLIMIT_AS, (50 << 20, 50 << 20))

        def used():
            usage = resource.getrusage(resource.RUSAGE_CHILDREN)
            return usage.ru_utime + usage.ru_stime

        begin = used()
        done = subprocess.run([COMMAND, "--info", name], cwd=self.work, check=False, capture_output=True, preexec_fn=limit)
        self.assertLess(used() - begin, 1 if SANITIZED else most)
        self.assertEqual((done.returncode, done.stdout), (UNREADABLE, b""), done.stderr)
        self.assertRegex(done.stderr.decode(), r"\AThe mesh .* cannot be read: [^\n]+\.\n\Z")

    def test_a_corner_out_of_range_is_reported_with_face_and_vertex(self):
        for number in (-2000000000, -1, 121, 2000000000):
            for corners in ([0, number, 22], [0, 1, number, 22]):
                points, polygons = files.sheet()
                polygons[17] = corners
                for name, write, first in (("a.ply", files.ply_plain, 0), ("a.off", files.off, 0), ("a.obj", files.obj, 1)):
                    if number >= 0 or name != "a.obj":  # which counts from the end
                        (self.work / name).write_bytes(write((points, polygons)))
                        self.refused(UNREADABLE, rf"face {17 + first} names vertex {number + first}, but there are 121", name,
                                     "out" + name[-4:], self.edit)


if __name__ == "__main__":
    unittest.main()
