# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes PLY, OBJ, OFF and STL in all forms that the program reads, for tests/cli/ and tests/fuzz/. A mesh is a list of
points and a list of polygons."""
import itertools
import math
import struct

SIDE = 11
FORMS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
COUNTS = ("char", "uchar", "short", "ushort", "int", "uint")
LETTERS = dict(zip(COUNTS, "bBhHiI"), float="f", double="d")
MARK = b"\xef\xbb\xbf"


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


def fanned(polygon):
    return [[polygon[0], polygon[k], polygon[k + 1]] for k in range(1, len(polygon) - 1)]


def triangulated(mesh):
    return mesh[0], [triangle for polygon in mesh[1] for triangle in fanned(polygon)]


def rows_of_ply(form, elements, line="\n"):
    """@param elements  name, properties and rows: (letters of struct, values)"""
    header = ["ply", f"format {form} 1.0", "comment made by a test: element vertex 3", "obj_info x 1"]
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *(f"property {p}" for p in properties)]
    return (line.join([*header, "end_header"]) + line).encode() + b"".join(
        struct.pack(FORMS[form] + letters, *values) if FORMS[form] else (" ".join(map(repr, values)) + line).encode()
        for _, _, rows in elements for letters, values in rows)


def ply_plain(mesh, scalar="float", form="ascii"):
    return rows_of_ply(form, [
        ("vertex", [f"{scalar} {c}" for c in "xyz"], [(3 * LETTERS[scalar], p) for p in mesh[0]]),
        ("face", ["list uchar int vertex_indices"], [(f"B{len(f)}i", (len(f), *f)) for f in mesh[1]])])


def ply(form, mesh, scalar="float", count="uchar", index="int", faces_first=False, line="\n"):
    """With further elements, lists and properties before, between and after those that the program reads."""
    points, polygons = mesh
    tags = [v % 3 for v in range(len(points))]
    elements = [
        ("vertex", [f"uchar {c}" for c in ("red", "green", "blue", "alpha")] + [f"{scalar} {c}" for c in (
            "x", "nx", "y", "z", "ny", "nz")] + ["double quality", "int flags", f"list {count} short tags"], [
                ("BBBB" + 6 * LETTERS[scalar] + "di" + LETTERS[count] + tags[v] * "h",
                 (v % 256, 1, 2, 255, x, 0, y, z, 0, 1, v / 7, 32 * (v == 1), tags[v], *range(tags[v])))
                for v, (x, y, z) in enumerate(points)]),
        ("face", [f"list {count} {index} vertex_indices", "int group", "float nx", "float ny", "float nz"], [
            (LETTERS[count] + len(p) * LETTERS[index] + "ifff", (len(p), *p, f, 0.5, 0, 0)) for f, p in enumerate(polygons)])]
    camera = ("camera", ["float view", "list int float matrix"], [("fifff", (1.5, 3, 1, 0, 0))])
    edge = ("edge", ["int vertex1", "int vertex2", "list uchar uchar name"], [("iiBBB", (k, k + 1, 2, 65, 66)) for k in range(3)])
    return rows_of_ply(form, [camera, *elements[::-1 if faces_first else 1], edge], line)


def strips(form):
    rows = [[v for j in range(SIDE) for v in (SIDE * i + j, SIDE * (i + 1) + j)] for i in range(SIDE - 1)]
    numbers = [v for row in rows for v in (*row, -1)][:-1]
    return rows_of_ply(form, [
        ("tristrips", ["list int int vertex_indices"], [(f"{1 + len(numbers)}i", (len(numbers), *numbers))]),
        ("vertex", ["float x", "float y", "float z"], [("3f", p) for p in sheet()[0]]),
        ("face", ["list uchar int vertex_index", "float nx", "float ny", "float nz"], [("B3i3f", (3, 0, 12, 1, 0.5, 0, 0))])])


def obj(mesh, corner=str, weight="", normals=lambda v: "", more=True):
    """@param corner  number of a vertex, counted from 1 -> the word for it in a face"""
    lines = ["# made\nmtllib a.mtl\no one"] * more
    lines += ["v %r\t%r  %r" % tuple(p) + weight + normals(v) for v, p in enumerate(mesh[0])] + ["vt 0 0\nvt 1 0.5\ng left\ns 1"] * more
    lines += ["usemtl red\n" * (f == 9 and more) + "f " + " ".join(corner(v + 1) for v in p) for f, p in enumerate(mesh[1])]
    return ("\n".join(lines) + "\nl 1 2 3\np 4\nvp 0 1" * more + "\n").encode()


def off(mesh, keyword="OFF", more="", end="\n", colour=""):
    counts = f"{keyword}\n{len(mesh[0])} {len(mesh[1])} 0\n"
    return (counts + "".join("%r %r %r" % tuple(p) + more + end for p in mesh[0])
            + "".join(" ".join(map(str, (len(p), *p))) + colour + "\n" for p in mesh[1])).encode()


def facets(mesh):
    """Zeros of both signs are one position; the last triangle has no area."""
    corners = [[mesh[0][v] for v in triangle] for triangle in triangulated(mesh)[1]]
    corners[1] = [[-0.0 if c == 0 else c for c in point] for point in corners[1]]
    return corners + [[mesh[0][0], mesh[0][0], mesh[0][1]]]


def stl_binary(mesh, header=b"any"):
    return header.ljust(80, b" ") + struct.pack("<I", len(facets(mesh))) + b"".join(
        struct.pack("<12fH", 0, 0, 1, *itertools.chain(*triangle), 40000 + k) for k, triangle in enumerate(facets(mesh)))


def stl_text(mesh):
    return ("solid a name\n" + "".join("facet normal 0 0 1\n outer loop\n" + "".join("  vertex %r %r %r\n" % tuple(p) for p in triangle)
                                       + " endloop\nendfacet\n" for triangle in facets(mesh)) + "endsolid a name\n").encode()


def plain_files(mesh):
    """Names and bytes of files without anything special; mesh: triangles, in single precision."""
    yield "text.ply", ply_plain(mesh)
    yield "binary.ply", ply_plain(mesh, form="binary_little_endian")
    yield "text.off", off(mesh)
    yield "text.obj", obj(mesh, more=False)
    yield "binary.stl", stl_binary(mesh)
    yield "text.stl", stl_text(mesh)


def all_files():
    """Names and bytes; those that begin with "special" are more than other readers read."""
    mesh, far = sheet(), (4e6, 5.4e6, 100)
    for form, scalar in itertools.product(FORMS, ("float", "double")):
        yield f"{form}_{scalar}.ply", ply(form, triangulated(mesh), scalar)
    for number, (count, index) in enumerate(itertools.product(COUNTS, COUNTS)):
        if number % 5 == 0 or count == index:
            yield f"special_{count}_{index}.ply", ply(list(FORMS)[number % 3], mesh, "float", count, index, number % 2 == 1)
    yield "far.ply", ply("binary_little_endian", triangulated(sheet(1, far)), "double")
    yield "special_returns.PLY", ply("ascii", mesh, line="\r\n")
    yield "special_tabs_no_end.ply", ply("ascii", mesh).replace(b" ", b"\t").replace(b"\t", b" ", 40)[:-1]
    yield "special_strips.ply", strips("binary_big_endian")

    def normals(v):
        return f"\nvn 0 {v % 2} 1"

    def corner(v):
        return f"{v}/1/{v}"
    yield "plain.obj", obj(mesh)
    yield "all.obj", obj(mesh, corner, normals=normals)
    yield "weights.obj", obj(mesh, lambda v: f"{v}//{v}", " 1.0", normals)
    yield "coloured.obj", obj(mesh, lambda v: f"{v}/2", " 0.5 0.25 1")
    yield "from_the_end.obj", obj(mesh, lambda v: f"{v - 122}/-1/{v - 122}", normals=normals)
    yield "shared_normals.obj", obj(mesh, lambda v: f"{v}//{(v + 1) // 2}", normals=lambda v: "\nvn 0 0 1" if v % 2 else "")
    yield "far.obj", obj(sheet(1, far))
    special = obj(mesh, corner, normals=normals).replace(b"\t", b" \\\n ").replace(b"/1/60 ", b"/1/60 \\\n")
    yield "special_lines.obj", special.replace(b"/1/50\n", b"/1/50 # a\n")
    yield "special_returns.obj", special.replace(b"\n", b"\r\n")[:-2]
    for keyword, more in (("OFF", ""), ("NOFF", " 0 0 1"), ("COFF", " 255 0 0 255"), ("STOFF", " 0.5 1"), ("CNOFF", " 0 0.5 0 1 0 0 1"),
                          ("special_NCOFF", " 0 0.6 0.8 1 0 0 1"), ("special_ncoff", " 9 0 0 255 0 0.6 0.8"), ("special_4OFF", " 1"),
                          ("special_ST4NOFF", " 1 0 0.6 0.8 0.5 0.25")):
        yield keyword + ".off", off(mesh, keyword.upper().split("_")[-1], more, colour=" 255 0 0")
    for count in 1, 3, 4, 6:  # numbers that the header does not name
        yield f"special_{count}_more.off", off(mesh, more=count * " 1", colour=" 255 0 0")
    rows = off(mesh).split(b"\n")
    yield "special_many_in_a_line.off", b"\n".join([rows[0] + rows[1], b" ".join(rows[2:40]), *rows[40:80], b" ".join(rows[80:123]), *rows[123:]])
    yield "special_mark.off", MARK + off(sheet(1e-9)).replace(b" ", b"\t").replace(b"\n", b"\r\n")[:-2]
    for number, head in enumerate((b"# before OFF\n# 1 2 3\nOFF\n", b"OFF # by 4 2 0\n\n#\n")):
        yield f"special_comments_{number}.off", head + off(mesh, end=" # a\n\n").replace(b"OFF\n", b"").replace(b" 0\n", b" 0# 1 2 3\n# 4\n", 1)
    yield "binary.stl", stl_binary(mesh)
    yield "binary_solid.stl", stl_binary(mesh, b"solid or not")
    yield "text.stl", stl_text(mesh)
    yield "returns.STL", stl_text(mesh).upper().replace(b"\n", b"\r\n")
