#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the table of hosts.md that says where plugins, program and core run, from the logs of test runs.

usage: where_it_runs.py LOG...     LOG: what ctest printed, such as build/tests_run.log; the last result of a test counts

A cell is "yes" when all of its tests passed, "no" when one failed, "not run" when one is in no log, and "-" when there is
no such thing.
"""
import pathlib
import re
import sys

COLUMNS = "compiled", "loaded", "tested", "same coordinates"
ROWS = [
    ("MeshLab 2020.09, Debian 12, g++ 12", ["host.filter"], ["gui.keep"], ["host.filter", "gui.keep"],
     ["host.edits_keep_their_coordinates", "host.same_bits"]),
    ("the same on a processor without AVX", ["hosts.here_other_cpu"], ["hosts.here_other_cpu"], ["kernels.linear.plain"], ["hosts.same_coordinates"]),
    ("MeshLab 2022.02, Debian 13, g++ 14", ["hosts.trixie"], ["hosts.trixie"], ["hosts.trixie"], ["hosts.trixie", "hosts.same_coordinates"]),
    ("MeshLab 2025.07, Debian sid, g++ 16", ["hosts.sid"], ["hosts.sid"], ["hosts.sid"], ["hosts.sid", "hosts.same_coordinates"]),
    ("MeshLab 2025.07, double precision", *4 * [["hosts.double"]]),
    ("Debian package, 2020.09", *3 * [["hosts.package_bookworm"]], []),
    ("Debian package, 2022.02", *3 * [["hosts.package_trixie"]], []),
    ("Debian package, 2025.07", *3 * [["hosts.package_sid"]], []),
    ("oldest Python, NumPy 1, PyMeshLab 2022.2", ["python.wheels"], *3 * [["python.oldest"]]),
    ("newest Python, NumPy 2, PyMeshLab 2025.7", ["python.wheels"], *3 * [["python.newest"]]),
    ("core, clang with libc++", ["processors.libc++"], [], ["processors.libc++"], []),
    ("core, arm64 under qemu", ["processors.arm64"], [], ["processors.arm64"], ["processors.arm64"]),
    ("wheel and program, Linux x86_64", *4 * [["python.linux-x86_64"]]),
    ("wheel and program, Windows x64 under wine", *4 * [["python.windows"]]),
    ("wheel and program, Linux aarch64 under qemu", *4 * [["python.linux-aarch64"]]),
    ("wheel and program, macOS", ["python.macos-arm64", "python.macos-x86_64"], [], [], []),
]


def main():
    if len(sys.argv) < 2:
        sys.exit(re.search(r"usage: .*", __doc__)[0])
    passed = {}
    for log in sys.argv[1:]:
        for name, result in re.findall(r"^ *\d+/\d+ Test +#\d+: (\S+) \.*(?: +|\*\*\*)(\w+)", pathlib.Path(log).read_text(encoding="utf-8"), re.M):
            passed[name] = result == "Passed"
    lines = [["", *COLUMNS], ["---"] * 5]
    for name, *cells in ROWS:
        words = [name]
        for tests in cells:
            results = [passed.get(test) for test in tests]
            words.append("-" if not tests else "no" if False in results else "not run" if None in results else "yes")
        lines.append(words)
    print("\n".join(f"| {' | '.join(line)} |" for line in lines))


if __name__ == "__main__":
    main()
