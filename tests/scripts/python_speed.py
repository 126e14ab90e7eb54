#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the times of the Python package with those of the program: least times, and the median of the ratios of rounds in turn.

usage: python_speed.py PROGRAM [ROUNDS]     PROGRAM: laplacian-edit, built as the package; ROUNDS: by default 7

The program's times are `milliseconds.edit` of its report, without reading and writing files; those of the package include
arrays and report.
"""
import concurrent.futures
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

import laplacian_edit

PROGRAM = sys.argv[1]
ROUNDS = int(sys.argv[2]) if len(sys.argv) > 2 else 7


def bumpy_grid(rows, columns):
    y, x = numpy.mgrid[:rows, :columns].astype(float)
    points = numpy.stack([x.ravel(), y.ravel(), (numpy.sin(x * 0.7) * numpy.cos(y * 0.9)).ravel()], axis=1)
    corner = (numpy.arange(rows - 1)[:, None] * columns + numpy.arange(columns - 1)).reshape(-1, 1)
    return points, numpy.concatenate([corner + [0, 1, columns + 1], corner + [0, columns + 1, columns]])


def write_ply(path, points, faces):
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    rows = numpy.zeros(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    path.write_bytes(head.encode() + points.astype("<f8").tobytes() + rows.tobytes())


def program(folder, mesh, step, *options):
    """Returns the milliseconds of an edit."""
    write_ply(folder / "in.ply", *mesh)
    (folder / "edit.json").write_text(json.dumps({"laplacian_edit": 1, "steps": [step]}), encoding="utf-8")
    subprocess.run([PROGRAM, "-q", *options, "--report", folder / "report.json", folder / "in.ply", folder / "out.ply",
                    folder / "edit.json"], check=True)
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))["milliseconds"]["edit"]


def milliseconds(work):
    start = time.perf_counter()
    work()
    return 1000 * (time.perf_counter() - start)


def compare(name, ours, other):
    times = [(ours(), other()) for _ in range(ROUNDS)]
    ratio = statistics.median(a / b for a, b in times)
    print(f"{name}: {min(a for a, _ in times):.1f} ms, compared with {min(b for _, b in times):.1f} ms: {ratio:.2f}", flush=True)


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mesh = bumpy_grid(109, 117)
        count = len(mesh[0])
        step = {"region": {"component": True}, "handles": [
            {"vertices": "0-116"}, {"vertices": f"{count - 117}-{count - 1}", "translation": [0, 5, 40]}]}

        def poses():
            editor = laplacian_edit.Editor(*mesh, step)
            for k in range(100):
                editor.pose(k / 99)

        compare("100 poses of 12,753 vertices, --fractions", lambda: milliseconds(poses),
                lambda: program(folder, mesh, step, "--fractions", "0:1:100"))
        large = bumpy_grid(401, 409)
        count = len(large[0])
        for radius in (40, 400):
            pull = {"region": {"radius": radius}, "handles": [{"vertices": str(count // 2), "translation": [0, 0, 20]}]}
            compare(f"edit() of {count:,} vertices, radius {radius}", lambda p=pull: milliseconds(lambda: laplacian_edit.edit(*large, {"steps": [p]})),
                    lambda p=pull: program(folder, large, p))
        small = bumpy_grid(41, 41)
        pull = {"steps": [{"region": {"radius": 15}, "handles": [{"vertices": 840, "translation": [0, 0, 6]}]}]}

        def edits(threads):
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                list(pool.map(lambda _: laplacian_edit.edit(*small, pull), range(200)))

        compare("200 edits of 1,681 vertices in 1 thread, in 4", lambda: milliseconds(lambda: edits(1)), lambda: milliseconds(lambda: edits(4)))


if __name__ == "__main__":
    main()
