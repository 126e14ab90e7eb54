#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the seeds of tests/fuzz/corpus/ anew. What a fuzzer found, files found_*, stays."""
import json
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import mesh_files as files  # noqa: E402

WORDS = {"laplacian": ["umbrella", "cotangent", "mean_value", "surface"],
         "method": ["default", "paper", "linear"]}


def write(target, name, content):
    folder = HERE / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def step(**keys):
    return {"region": {"radius": 1.5}, "handles": [{"vertices": "1", "translation": [0, 0, 1]}], **keys}


def edit(*steps, **keys):
    return {"laplacian_edit": 1, **keys, "steps": list(steps)}


def edits():
    """Each kind of region, handle and setting."""
    yield "radius", edit(step())
    yield "mesh", edit(step(), mesh={"vertices": 42, "faces": 80, "connectivity": "0123456789abcdef"})
    yield "vertices", edit(step(region={"vertices": "0-3, 5,7 - 9", "padding": 0.2}))
    yield "component", edit(step(region={"component": True, "connect": 0.5}))
    yield "anchors", edit(step(region={"vertices": "0-3", "padding": 0.2, "anchors": {
        "vertices": "2,3", "weights": [1, 0.5], "depths": [0, 1], "reach": 2.5}}))
    yield "rotation", edit(step(handles=[
        {"vertices": "1-3", "weights": [1, 0.5, 0.000001], "scale": 1.5,
         "rotation": {"axis": [1, 2, 3], "degrees": -30, "center": [0, 0.5, 1e-3]}}]))
    yield "matrix", edit(step(handles=[{"vertices": "1", "matrix": [1, 0, 0, 1, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]))
    yield "targets", edit(step(handles=[{"vertices": "3,1", "weights": [1, 0.5], "targets": [[0, 0.5, 1e-3], [1, 2, 3]]}]))
    move = {"translation": [0, 0, 1]}
    yield "points", edit(step(region={"within": {"point": [0, 0, 1], "radius": 1.5}}, handles=[
        {"points": [[0, 0, 1], [1, 0, 0]], "targets": [[0, 0, 2], [2, 0, 0]], "weights": [1, 0.1]}]))
    yield "within", edit(step(handles=[{"within": {"point": [0, 0, 1], "radius": 0.5}, **move}]))
    yield "selected", edit(step(region={"selected": True}, handles=[{"selected": True, **move}]))
    yield "landmarks", edit(step(handles=[{"landmarks": {"from": "from.csv", "to": "to.csv"}}]))
    yield "positions", edit(step(), mesh={"positions": {"vertices": "1", "points": [[0, 0, 1]]}})
    yield "rough", edit(step(method="paper", rough="falloff", normal_radius=0.5))
    yield "mirror", edit(step(mirror={"point": [0, 0, 0], "normal": [1, 0, 0]}))
    yield "numbers", edit(step(handle_weight=1e-6, anchor_weight=1e6, membrane=0, normal_radius=1.7976931348623157e308,
                               iterations=100, order=3))
    yield "steps", edit(step(), step(region={"component": True}), step())
    for key, words in WORDS.items():
        for word in words:
            yield f"{key}_{word}", edit(step(**{key: word}))


def bad_texts():
    good = json.dumps(edit(step()))
    yield "empty", ""
    yield "cut", good[:60]
    yield "mark", b"\xef\xbb\xbf" + good.encode()
    yield "deep", "[" * 1100
    yield "twice", good.replace('"radius": 1.5', '"radius": 1, "radius": 2')
    yield "unknown", good.replace("radius", "radios")
    yield "large_number", good.replace("1.5", "1e999")
    yield "escape", good.replace('"1"', '"\\u0031\\ud83d\\ude00"')
    yield "bytes", good.encode().replace(b'"1"', b'"\xff\xfe"')
    yield "range", good.replace('"1"', '"2147483647,3-1"')


SMALL = [(0, 0, 0), (1, 0, 0), (1, 1, 0.25), (0, 1, 0), (0.5, 0.5, -1e-3)], [(0, 1, 2, 3), (0, 1, 4)]


def plys():
    for form in files.FORMS:
        yield form, files.ply(form, SMALL)
        yield form + "_double", files.ply(form, SMALL, "double", "int", "ushort")
    text = files.ply("ascii", SMALL)
    yield "strips", text.replace(b"end_header", b"element tristrips 1\nproperty list int int vertex_indices\nend_header"
                                 ) + b"6 0 1 2 -1 3 4\n"
    yield "returns", text.replace(b"\n", b"\r\n")
    yield "no_end", text[:-1]
    binary = files.ply("binary_little_endian", SMALL)
    yield "cut", binary[:-5]
    yield "large_count", binary.replace(b"vertex 5", b"vertex 2147483647")


def objs():
    yield "plain", files.obj(SMALL)
    yield "all", files.obj(SMALL, lambda v: f"{v}/1/{v}", " 1", lambda v: f"\nvn 0 {v % 2} 1").replace(b" 2/", b" \\\n2/")
    yield "returns", files.obj(SMALL, lambda v: f"{v - 6}//1", normals=lambda v: "\nvn 0 0 1").replace(b"\n", b"\r\n")[:-2]
    yield "bad", "v 0 0 0\nf 1 2 0\n"
    yield "not_finite", "v nan 0 inf\nv 1 0 0\nv 1 1 -nan\nv 0 -0 1e999\nf 1 2 3\nf 2 3 4\n"


def offs():
    for keyword, more in (("OFF", ""), ("NOFF", " 0 0 1"), ("COFF", " 255 0 0 255"), ("STOFF", " 0.5 0.5"),
                          ("STCNOFF", " 0 0 1 1 0 0 0.5 0.5"), ("NCOFF", " 9 0 0 255 0 0 1"), ("4OFF", " 1")):
        yield keyword.lower(), files.off(SMALL, keyword, more)
    yield "glued_comments", files.off(SMALL, "OFF#a b", end="#c d\n")
    yield "comments", b"# a\n" + files.off(SMALL, "OFF # b", end=" # c\n\n")[:-1]
    yield "one_line", "OFF 3 1 3 0 0 0 1 0 0 0 1 0 3 0 1 2"
    yield "binary", "OFF BINARY\n\0\0\0\1"
    yield "large_count", "OFF\n2147483648 1 0\n0 0 0\n"


def stls():
    yield "binary", files.stl_binary(SMALL)
    yield "binary_solid", files.stl_binary(SMALL, b"solid")
    text = files.stl_text(SMALL)
    yield "text", text
    yield "text_returns", text.upper().replace(b"\n", b"\r\n")
    yield "cut", text[:120]


def landmarks():
    yield "picked", ('<!DOCTYPE PickedPoints>\n<PickedPoints>\n <!-- <point> -->\n'
                     ' <point x="0.25" y=\'-1\' z="1e-3" active="1" name="nose &amp; tip"/>\n</PickedPoints>\n')
    yield "table", 'nose,0.25,-1,0.001\n"chin, left",1,2,3\n'
    yield "header", "# a\nx;y;z;label\n0.25;-1;0.001;nose\n"
    yield "slicer_table", "label,r,a,s,defined\nnose,0.25,-1,0.001,1\nnot placed,,,,0\n"
    yield "tabs", "label\tl\tp\ts\nnose\t0.25\t-1\t0.001\n"
    yield "utf_16", "nose,1,2,3\n".encode("utf-16")
    yield "fiducials", ("# CoordinateSystem = LPS\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc\n"
                        "1,0.25,-1,0.001,0,0,0,1,1,1,0,nose,\n")
    yield "markups", json.dumps({"markups": [{"coordinateSystem": "LPS", "controlPoints": [
        {"label": "nose", "position": [0.25, -1, 1e-3], "positionStatus": "defined"}]}]})
    for name, text in (("nan", "nose,nan,1,2\n"), ("twice", "a,1,2,3\na,1,2,3\n"), ("cut", '<PickedPoints><point x="1')):
        yield "bad_" + name, text


LISTS = ["0", "1,2,3", "0-999", " 5 - 7 ,\t9", "", ",", "1,", "3-1", "1000", "-1", "+1", "1 2", "2147483648", "1--2",
         "0-999,0", "00007", "1e3", "\x00"]
RANDOM = 24  # inputs of the targets that take choices


def main():
    for target, seeds in (("ply", plys()), ("obj", objs()), ("off", offs()), ("stl", stls())):
        for name, content in seeds:
            write(target, name, content)
    for name, text in landmarks():
        write("landmarks", name, text)
    for number, text in enumerate(LISTS):
        write("vertex_list", f"list_{number:02}", text)
    dice = random.Random(15)
    for target in ("edit", "session"):
        for number in range(RANDOM):
            write(target, f"random_{number:02}", dice.randbytes(dice.choice([40, 80, 160])))
    for number in range(RANDOM):  # longer: what says where stands behind the edit
        write("edit", f"long_{number:02}", dice.randbytes(400))
    write("edit", "many_groups", bytes([63]) * 400)
    for name, value in edits():
        write("json", name, json.dumps(value))
    for name, text in bad_texts():
        write("json", "bad_" + name, text)


if __name__ == "__main__":
    main()
