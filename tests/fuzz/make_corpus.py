#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the seeds of tests/fuzz/corpus/ anew. What a fuzzer found, files found_*, stays."""
import json
import pathlib
import random

HERE = pathlib.Path(__file__).resolve().parent
WORDS = {"laplacian": ["umbrella", "cotangent", "mean_value"],
         "detail_rotation": ["none", "smooth_normals", "smooth_surface", "local_global"],
         "turning": ["vertex", "edge"], "rough": ["unrotated", "falloff"]}


def write(target, name, content):
    folder = HERE / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def step(**keys):
    return {"region": {"radius": 1.5}, "handles": [{"vertices": "1", "translation": [0, 0, 1]}], **keys}


def edit(*steps, version=2, **keys):
    return {"laplacian_edit": version, **keys, "steps": list(steps)}


def edits():
    """Each kind of region, handle and setting."""
    yield "radius", edit(step())
    yield "version_1", edit(step(), version=1)
    yield "mesh", edit(step(), mesh={"vertices": 42, "faces": 80, "connectivity": "0123456789abcdef"})
    yield "vertices", edit(step(region={"vertices": "0-3, 5,7 - 9", "padding": 0.2}))
    yield "component", edit(step(region={"component": True, "connect": 0.5}))
    yield "anchors", edit(step(region={"vertices": "0-3", "padding": 0.2, "anchors": {
        "vertices": "2,3", "weights": [1, 0.5], "depths": [0, 1], "reach": 2.5}}))
    yield "rotation", edit(step(handles=[
        {"vertices": "1-3", "weights": [1, 0.5, 0.000001], "scale": 1.5,
         "rotation": {"axis": [1, 2, 3], "degrees": -30, "center": [0, 0.5, 1e-3]}}]))
    yield "matrix", edit(step(handles=[{"vertices": "1", "matrix": [1, 0, 0, 1, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]))
    yield "mirror", edit(step(mirror={"point": [0, 0, 0], "normal": [1, 0, 0]}))
    yield "numbers", edit(step(handle_weight=1e-6, anchor_weight=1e6, membrane=0, normal_radius=1.7976931348623157e308,
                               iterations=100, order=3, rules=1))
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


def main():
    for name, value in edits():
        write("json", name, json.dumps(value))
    for name, text in bad_texts():
        write("json", "bad_" + name, text)


if __name__ == "__main__":
    main()
