# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit changes coordinates and normals of the vertices that an edit moves, and no other byte of a file,
whatever its format. LAPEDIT_READERS is the folder of a virtual environment with the readers to compare with, made if missing."""
import glob
import itertools
import json
import math
import os
import pathlib
import resource
import shutil
import struct
import subprocess
import sys
import time
import unittest

from mesh_bytes import MARK, MeshBytes, fanned
from program import COMMAND, REFUSED, SANITIZED, UNREADABLE, ProgramTest, meshes, ply_text
from x_server import host_environment, start_x_server

PACKAGES = ("trimesh==4.6.8", "tinyobjloader==2.0.0rc13", "numpy", "pillow")
READERS = pathlib.Path(os.environ.get("LAPEDIT_READERS", "readers"))
REAL = ("Laurana50k.ply", "bunny.ply", "texturedknot.ply", "igea.ply", "bumpy_plane.off", "mannequin.off", "octopus.off",
        "bunny10k_textured.obj", "busted.STL")
SIDE = 11
COUNTS = ("char", "uchar", "short", "ushort", "int", "uint")
LETTERS = dict(zip(COUNTS, "bBhHiI"), float="f", double="d")


def setUpModule():
    python = READERS / "bin" / "python"
    if not python.exists():
        made = subprocess.run([sys.executable, "-m", "venv", READERS], check=False).returncode == 0 and subprocess.run(
            [python, "-m", "pip", "install", "-q", "--only-binary", ":all:", *PACKAGES], check=False).returncode == 0
        if not made:
            shutil.rmtree(READERS, ignore_errors=True)
            assert not os.environ.get("CI"), "trimesh and tinyobjloader cannot be installed"
            print("Not compared with trimesh and tinyobjloader, which cannot be installed.")
    sys.path += glob.glob(str(READERS / "lib" / "python3*" / "site-packages"))


def sheet(scale=1.0, offset=(0, 0, 0)):
    """Quads, and in the middle one polygon with seven corners."""
    points = [tuple(scale * c + o for c, o in zip((i / 10, j / 10, 0.2 * math.sin(i / 3) * math.cos(j / 4)), offset))
              for i in range(SIDE) for j in range(SIDE)]
    quads = {(i, j): [SIDE * i + j, SIDE * (i + 1) + j, SIDE * (i + 1) + j + 1, SIDE * i + j + 1]
             for i in range(SIDE - 1) for j in range(SIDE - 1)}
    p, q = ([SIDE * i + j for j in (3, 4, 5, 6)] for i in (5, 6))
    for j in p[:3]:
        del quads[5, j % SIDE]
    return points, [*quads.values(), [p[0], *q, p[2], p[1]], [p[2], q[3], p[3]]]


def triangles(*place):
    points, polygons = sheet(*place)
    return points, [fan for p in polygons for fan in fanned(p)]


def ply(form, scalar="float", count="uchar", index="int", mesh=None, faces_first=False, line="\n"):
    """Further elements, lists and properties before, between and after those that the program reads."""
    points, polygons = mesh or sheet()
    tags = [v % 3 if len(polygons[-2]) > 3 else 2 for v in range(len(points))]  # trimesh reads only equal lists
    order = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[form]
    vertex = (["property uchar red", "property uchar green", "property uchar blue", "property uchar alpha"]
              + [f"property {scalar} {c}" for c in ("x", "nx", "y", "z", "ny", "nz")]
              + ["property double quality", f"property list {count} short tags"])
    face = [f"property list {count} {index} vertex_indices", "property int group"] + [f"property float n{c}" for c in "xyz"]
    vertex_rows = [("BBBB" + 6 * LETTERS[scalar] + "d" + LETTERS[count] + tags[v] * "h",
                    (v % 256, 1, 2, 255, x, 0, y, z, 0, 1, v / 7, tags[v], *range(tags[v]))) for v, (x, y, z) in enumerate(points)]
    face_rows = [(LETTERS[count] + len(p) * LETTERS[index] + "ifff", (len(p), *p, f, 0.5, 0, 0)) for f, p in enumerate(polygons)]
    elements = [("vertex", vertex, vertex_rows), ("face", face, face_rows)][::-1 if faces_first else 1]
    elements.insert(0, ("camera", ["property float view", "property list int float matrix"], [("fifff", (1.5, 3, 1, 0, 0))]))
    elements.append(("edge", ["property int vertex1", "property int vertex2", "property list uchar uchar name"],
                     [("iiBBB", (k, k + 1, 2, 65, 66)) for k in range(5)]))
    header = ["ply", f"format {form} 1.0", "comment made by a test: element vertex 3", "obj_info x 1"]
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *properties]
    data = (line.join([*header, "end_header"]) + line).encode()
    for letters, values in (row for _, _, rows in elements for row in rows):
        data += struct.pack(order + letters, *values) if order else (" ".join(map(repr, values)) + line).encode()
    return data


def strips():
    points, _ = sheet()
    rows = [[v for j in range(SIDE) for v in (SIDE * i + j, SIDE * (i + 1) + j)] for i in range(SIDE - 1)]
    numbers = [v for row in rows for v in (*row, -1)][:-1]
    return (f"ply\nformat binary_little_endian 1.0\nelement vertex {SIDE * SIDE}\nproperty float x\nproperty float y\n"
            "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n").encode() + b"".join(
                struct.pack("<3f", *p) for p in points) + struct.pack(f"<{1 + len(numbers)}i", len(numbers), *numbers)


def obj(corner, weight=lambda v: "", mesh=None, normals=lambda v: f"vn 0 {v % 2} 1\n"):
    """All kinds of lines. @param corner  number of a vertex, counted from 1 -> the word for it"""
    points, polygons = mesh or sheet()
    text = "# made\nmtllib a.mtl\no one\n" + "".join("v %r\t%r  %r" % p + weight(v) + "\n" + normals(v) for v, p in enumerate(points))
    text += "vt 0 0\nvt 1 0.5\ng left\ns 1\n" + "".join(
        f"{'usemtl red' if f == 9 else 'g a b' if f == 20 else ''}\nf " + " ".join(corner(v + 1) for v in p) + "\n"
        for f, p in enumerate(polygons))
    return text + "l 1 2 3\np 4\nvp 0 1\n"


def off(keyword="OFF", more="", mesh=None):
    points, polygons = mesh or sheet()
    return (f"{keyword}\n# counts\n{len(points)} {len(polygons)} 0\n\n" + "".join("%r %r %r" % p + more + " # a\n" for p in points)
            + "".join(" ".join(map(str, (len(p), *p))) + " 255 0 0\n" for p in polygons))


def facets():
    """Zeros of both signs are one place; the last triangle has no area."""
    points, all_of_them = triangles()
    places = [[points[v] for v in triangle] for triangle in all_of_them]
    places[3] = [[-0.0 if c == 0 else c for c in point] for point in places[3]]
    return places + [[points[0], points[0], points[1]]]


def stl_binary(header):
    return header.ljust(80, b" ") + struct.pack("<I", len(facets())) + b"".join(
        struct.pack("<12fH", 0, 0, 1, *itertools.chain(*triangle), 40000 + k) for k, triangle in enumerate(facets()))


def stl_text():
    return "solid a name\n" + "".join(
        "facet normal 0 0 1\n outer loop\n" + "".join("  vertex %r %r %r\n" % tuple(p) for p in triangle)
        + " endloop\nendfacet\n" for triangle in facets()) + "endsolid a name\n"


def generated():
    """Name and bytes of each file."""
    forms = ("ascii", "binary_little_endian", "binary_big_endian")
    for form, scalar in itertools.product(forms, ("float", "double")):
        yield f"{form}_{scalar}.ply", ply(form, scalar, mesh=triangles())
    for number, (count, index) in enumerate(itertools.product(COUNTS, COUNTS)):
        if number % 5 == 0 or count == index:
            yield f"lists_{count}_{index}.ply", ply(forms[number % 3], "float", count, index, faces_first=number % 2 == 1)
    yield "far.ply", ply("binary_little_endian", "double", mesh=triangles(1, (4e6, 5.4e6, 100)))
    yield "lists_returns.PLY", ply("ascii", line="\r\n")
    yield "lists_tabs_no_end.ply", ply("ascii").replace(b" ", b"\t").replace(b"\t", b" ", 40)[:-1]
    yield "lists_strips.ply", strips()

    def all_indices(v):
        return f"{v}/1/{v}"
    texts = {"all": obj(all_indices), "normals": obj(lambda v: f"{v}//{v}", lambda v: " 1.0"),
             "from_the_end": obj(lambda v: f"{v - 122}/-1/{v - 122}"), "plain": obj(str, normals=lambda v: ""),
             "coloured": obj(lambda v: f"{v}/2", lambda v: " 0.5 0.25 1"), "far": obj(str, mesh=sheet(1, (4e6, 5.4e6, 100))),
             "shared": obj(lambda v: f"{v}//{(v + 1) // 2}", normals=lambda v: "vn 0 0 1\n" if v % 2 else ""),
             "continued": obj(all_indices).replace("\t", " \\\n ").replace("/1/60 ", "/1/60 \\\n").replace("/1/50\n", "/1/50 # a\n")}
    for name, text in texts.items():
        yield name + ".obj", text.encode()
    yield "returns.obj", texts["continued"].replace("\n", "\r\n")[:-2].encode()
    for keyword, more in (("OFF", ""), ("NOFF", " 0 0 1"), ("COFF", " 255 0 0 255"), ("STOFF", " 0.5 1"),
                          ("CNOFF", " 0 0.5 0 1 0 0 0.5")):
        yield keyword + ".off", off(keyword, more).encode()
    yield "mark.off", MARK + off(mesh=sheet(1e-9)).replace(" ", "\t").replace("\n", "\r\n")[:-2].encode()
    yield "comments.off", b"# before OFF\n# 1 2 3\n" + off().encode()
    yield "binary.stl", stl_binary(b"header")
    yield "binary_solid.stl", stl_binary(b"solid or not")
    yield "text.stl", stl_text().encode()
    yield "returns.STL", stl_text().upper().replace("E-", "e-").replace("\n", "\r\n").encode()


def sizes(points):
    return [max(c) - min(c) for c in zip(*points)]


class Bytes(ProgramTest):
    def check(self, name, data):
        """@return the edited file, with its numbers"""
        path, out = self.place / name, self.place / ("out" + name[-4:])
        path.write_bytes(data)
        before = MeshBytes(name, data)
        used = sorted({v for p in before.polygons for v in p})
        middle = [(min(c) + max(c)) / 2 for c in zip(*(before.points[v] for v in used))]
        vertex, size = min(used, key=lambda v: math.dist(before.points[v], middle)), math.hypot(*sizes(before.points))
        up = {"vertices": str(vertex), "translation": [0.02 * size, 0, 0.05 * size]}
        edit = self.write_edit({"region": {"radius": 0.2 * size}, "handles": [up]})
        still = self.write_edit({"region": {"radius": 0.2 * size}, "handles": [{"vertices": str(vertex)}]}, name="still.json")
        for arguments in ((edit, "--fraction", "0"), (still,)):
            self.done(path, out, *arguments, "--quiet")
            self.assertTrue(out.read_bytes() == data, f"{arguments}: bytes changed without an edit")
        self.done(path, out, edit, "--quiet", "--report", "report.json")
        after = MeshBytes(name, out.read_bytes())

        # The same mesh without polygons, in the simplest format.
        plain = self.place / "plain.ply"
        plain.write_bytes(ply_text(before.points, before.triangles, "float" if before.is_single else "double"))
        self.done(plain, plain, edit, "--quiet")
        expected = MeshBytes("plain.ply", plain.read_bytes()).points
        self.assertTrue(after.points == expected, "other positions than those of the plain file")
        moved = {v for v, point in enumerate(expected) if list(point) != list(before.points[v])}
        self.assertIn(vertex, moved)
        self.assertLess(len(moved), len(before.points))

        self.assertTrue(after.between() == before.between(), "bytes between the numbers changed")
        shared = self.check_numbers(before, after, moved)
        (output,) = json.loads((self.place / "report.json").read_text())["outputs"]
        self.assertEqual(output["shared_normals"], shared)
        return out, after

    def check_numbers(self, before, after, moved):
        """@return how many normals of moved vertices others use too"""
        shared = 0
        for old, new in zip(before.groups, after.groups):
            kind, number, old_places, old_values = old
            new_values = new[3]
            texts = [[file.data[slice(*place)] for place in places]
                     for file, places in ((before, old_places), (after, new[2]))]
            if kind == "position":
                for k in range(3):  # digits of a number that stays are kept too
                    self.assertEqual(texts[0][k] != texts[1][k], old_values[k] != new_values[k], old)
                continue
            users = {corner[0] for corner in before.users.get(number, ())}
            if kind == "facet normal":
                may_change = any(v in moved for v in before.polygons[number])
            else:
                may_change = bool(users) and users <= moved
                shared += not may_change and not users.isdisjoint(moved)
            normal = after.normal(kind, number)
            if may_change and any(normal):
                self.assertAlmostEqual(math.hypot(*new_values), 1, delta=1e-6)
                self.assertGreater(sum(a * b for a, b in zip(normal, new_values)), 1 - 1e-5, old)
            else:
                self.assertEqual(*texts, old)
        return shared

    def test_generated_files(self):
        shared = 0
        for name, data in generated():
            with self.subTest(name):
                out, after = self.check(name, data)
                self.compare_with_other_readers(name, out, after)
                shared += json.loads((self.place / "report.json").read_text())["outputs"][0]["shared_normals"]
        self.assertGreater(shared, 3)

    @unittest.skipUnless(os.environ.get("LAPEDIT_MESHES"), "needs the real meshes")
    def test_real_files(self):
        for name in REAL:
            with self.subTest(name):
                out, after = self.check(name, (pathlib.Path(os.environ["LAPEDIT_MESHES"]) / name).read_bytes())
                self.compare_with_other_readers(name, out, after)

    def compare_with_other_readers(self, name, path, after):
        try:
            import tinyobjloader
            import trimesh
        except ImportError:
            return
        # Each reader cuts polygons and corners with several texture coordinates in its own way.
        expected = {tuple(after.points[v]) for triangle in after.triangles for v in triangle}
        if name.startswith(("continued", "returns.obj", "lists", "igea")):  # strips, lists of several lengths, lines that go on
            return
        if path.suffix.lower() == ".obj":
            reader = tinyobjloader.ObjReader()
            self.assertTrue(reader.ParseFromFile(str(path)), reader.Error())
            numbers = reader.GetAttrib().vertices
            for read, point in zip(zip(numbers[::3], numbers[1::3], numbers[2::3]), after.points):
                for a, b in zip(read, point):
                    self.assertAlmostEqual(a, b, delta=4e-15 * abs(b))  # its digits are rounded more than once
        if name not in ("mark.off", "comments.off"):
            copy = path.with_name("copy" + path.suffix)
            copy.write_bytes(after.data.replace(b"element edge", b"element line"))  # trimesh reads edges without lists
            mesh = trimesh.load(str(copy), process=False, force="mesh")
            self.assertEqual({tuple(p) for p in mesh.vertices[mesh.faces.ravel()].tolist()}, expected)

    @unittest.skipUnless(shutil.which("meshlabserver") and shutil.which("Xvfb"), "needs meshlabserver")
    def test_meshlab_reads_the_new_positions(self):
        environment = host_environment(start_x_server(self.addCleanup, "640x480"), self.folder)
        compared = 0
        for name, data in (*meshes(), *generated()):
            if not name.startswith(("text", "binary", "ascii")):
                continue
            out, after = self.check(name, data)
            (self.place / "read.ply").unlink(missing_ok=True)
            subprocess.run(["meshlabserver", "-i", out, "-o", self.place / "read.ply"], env=environment, timeout=100, check=False,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            if (self.place / "read.ply").exists():
                read = MeshBytes("read.ply", (self.place / "read.ply").read_bytes())
                expected = [struct.unpack("3f", struct.pack("3f", *point)) for point in after.points]
                with self.subTest(name):
                    self.assertEqual([tuple(p) for p in read.points], expected)
                    compared += 1
        self.assertGreater(compared, 7)


class Damage(ProgramTest):
    def test_no_faces(self):
        for name, data in (("none.ply", ply_text(sheet()[0], [])), ("none.obj", obj(str, mesh=(sheet()[0], [])).encode()),
                           ("none.off", off(mesh=(sheet()[0], [])).encode()), ("none.stl", stl_text()[:13].encode())):
            (self.place / name).write_bytes(data)
            self.refused(REFUSED, "no (vertices|faces)|0 (vertices|faces)", name, "out" + name[-4:], self.edit)
            self.assertIn("faces: 0\n", self.done("--info", name))

    def test_selection_of_meshlab(self):
        points, polygons = sheet()
        text = ply_text(points, polygons).decode().replace("z\n", "z\nproperty int flags\n").replace(
            "vertex_indices\n", "vertex_indices\nproperty int flags\n").splitlines()
        begin = text.index("end_header") + 1
        for vertices, handles in (([60, 61], 2), ([], 4)):  # the corners of the face where no vertex is selected
            rows = [line + (" 32" if row in (*vertices, len(points)) else " 6") for row, line in enumerate(text[begin:])]
            (self.place / "in.ply").write_text("\n".join([*text[:begin], *rows, ""]))
            self.assertIn(f"selected: {len(vertices)} vertices, 2 faces\n", self.done("--info", "in.ply"))
            edit = self.write_edit({"region": {"radius": 0.4}, "handles": [{"selected": True, "translation": [0, 0, 0.1]}]})
            self.done("in.ply", "out.ply", edit, "--report", "report.json")
            (step,) = json.loads((self.place / "report.json").read_text())["outputs"][0]["steps"]
            self.assertEqual(step["handle"], handles)

    def test_truncated_files(self):
        small = ([(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0)], [[0, 1, 2, 3], [0, 1, 2]])
        for name, data, is_text in (("a.ply", ply("binary_little_endian", mesh=small), False),
                                    ("b.ply", ply("binary_big_endian", "double", "ushort", mesh=small), False),
                                    ("c.stl", stl_binary(b"x")[:84 + 150].replace(struct.pack("<I", len(facets())), struct.pack("<I", 3)), False),
                                    ("a.off", off("CNOFF", " 0 0 1 1 0 0 1", small).encode(), True),
                                    ("t.ply", ply("ascii", mesh=small), True),
                                    ("a.obj", obj(lambda v: f"{v}/1/{v}", mesh=small).encode(), True),
                                    ("a.stl", stl_text()[:600].encode(), True)):
            for size in range(0, len(data) - (0 if is_text else 1), 3 if is_text else 1):
                (self.place / name).write_bytes(data[:size])
                code, _, errors = self.run_program("--info", name)
                with self.subTest(name=name, size=size):
                    self.assertIn(code, (0, UNREADABLE) if is_text else (UNREADABLE,))
                    self.assertRegex(errors, r"\A(The mesh .* cannot be read: [^\n]+\.\n)?\Z")
                    self.assertEqual(code == 0, not errors)

    def test_headers_that_lie(self):
        binary, text = ply("binary_little_endian", count="int"), ply("ascii").decode()
        lists = binary.index(b"end_header\n") + 11 + 4  # the camera's list
        for number in (2**31 - 1, 2**31, 2**32 - 1, 2**63, 10**30, -1):
            files = {element + ".ply": binary.replace(b"element %s " % element.encode(), b"element %s %d" % (element.encode(), number))
                     for element in ("vertex", "face", "edge")}
            files["empty.ply"] = b"ply\nformat ascii 1.0\nelement x %d\n" % number + binary[binary.index(b"comment"):]
            if number % 2**32 != 0:
                files["count.stl"] = b"any".ljust(80) + struct.pack("<I", number % 2**32) + bytes(500)
                files["list.ply"] = binary[:lists] + struct.pack("<I", number % 2**32) + binary[lists + 4:]
            files["text.ply"] = text.replace("\n4 0 11 ", f"\n{number} 0 11 ", 1).encode()
            files["vertices.off"] = off().replace("121 ", f"{number} ", 1).encode()
            files["faces.off"] = off().replace("\n121 ", f"\n121 {number}", 1).encode()
            files["corners.off"] = off().replace("\n4 ", f"\n{number} ", 1).encode()
            for name, data in files.items():
                with self.subTest(name, number=number):
                    self.check_refusal(name, data)

    def check_refusal(self, name, data):
        """In one sentence, within a tenth of a second and 50 MB."""
        (self.place / name).write_bytes(data)
        seconds = []
        while not seconds or (min(seconds) > 0.1 and len(seconds) < 5):  # the machine may be busy
            begin = time.monotonic()
            process = subprocess.Popen([COMMAND, "--info", name], cwd=self.place, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            output, errors = process.communicate(timeout=60)
            seconds.append(time.monotonic() - begin)
        self.assertEqual((process.returncode, output), (UNREADABLE, b""), errors)
        self.assertRegex(errors.decode(), r"\AThe mesh .* cannot be read: [^\n]+\.\n\Z")
        if not SANITIZED:
            self.assertLess(min(seconds), 0.1)
            limit = 50 << 20
            limited = subprocess.run([COMMAND, "--info", name], cwd=self.place, check=False, capture_output=True,
                                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            self.assertEqual((limited.returncode, limited.stderr), (UNREADABLE, errors))

    def test_a_corner_out_of_range_is_reported_with_face_and_vertex(self):
        for number in (-2000000000, -1, 121, 2000000000):
            for corners in ([0, number, 22], [0, 1, number, 22]):
                points, polygons = sheet()
                polygons[17] = corners
                for name, data, first in (("a.ply", ply_text(points, polygons), 0),
                                          ("a.off", off(mesh=(points, polygons)).encode(), 0),
                                          ("a.obj", obj(str, mesh=(points, polygons)).encode(), 1)):
                    if number + first < 0 and name == "a.obj":
                        continue  # counts from the end
                    (self.place / name).write_bytes(data)
                    face = r"face 1[78] names (vertex )?" if first == 0 else r"names (vertex )?"
                    self.refused(UNREADABLE, face + str(number + first) + ", but there are 121", name, "out" + name[-4:], self.edit)


if __name__ == "__main__":
    unittest.main()
