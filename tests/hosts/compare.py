#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the same edits made by several builds, or with the stored digests of their coordinates.

usage: compare.py FOLDER FOLDER...    compares each folder with the first one and prints a Markdown table
       compare.py --stored FOLDER     compares a folder with digests.txt
       compare.py --store FOLDER      writes digests.txt

The folders are made by write_results.sh. Every coordinate of every mesh has to be the same to the bit; the program ends
with 1 if one differs. digests.txt has a line for each edit: the first 16 digits of a SHA-256 of the coordinates that were
read, and of those that were written.
"""
import array
import hashlib
import json
import math
import pathlib
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "batch"))

from ply import Ply  # noqa: E402

DIGESTS = pathlib.Path(__file__).resolve().parent / "digests.txt"


class Failed(Exception):
    """What is wrong, in a sentence."""


class Pose:
    def __init__(self, path):
        mesh = Ply(path)
        rows = mesh.elements["vertex"]
        self.bits = [array.array("I", rows[axis]) for axis in "xyz"]
        self.faces = mesh.faces()

    def __len__(self):
        return len(self.bits[0])

    def digest(self):
        return hashlib.sha256(b"".join(axis.tobytes() for axis in self.bits)).hexdigest()[:16]

    def coordinate(self, axis, vertex):
        return struct.unpack("<f", struct.pack("<I", self.bits[axis][vertex]))[0]

    def differing(self, other):
        """Pairs (axis, vertex) whose bits differ."""
        return [(axis, v) for axis in range(3) if self.bits[axis] != other.bits[axis]
                for v, (a, b) in enumerate(zip(self.bits[axis], other.bits[axis])) if a != b]


def rank(bits):
    """Neighbouring floats have neighbouring ranks; both zeros have the same."""
    return bits if bits < 0x80000000 else 0x80000000 - bits


class Edit:
    """The poses of one edit by one build."""

    def __init__(self, folder):
        files = sorted(folder.glob("pose-*.ply"))
        if len(files) < 2:
            raise Failed(f"{folder} has {len(files)} meshes.")
        self.before, *self.after = [Pose(path) for path in files]
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        self.steps = report["outputs"][-1]["steps"]
        self.region = max(step["handle"] + step["free"] + step["anchors"] for step in self.steps)

    def moved(self):
        return {v for pose in self.after for _, v in pose.differing(self.before)}

    def size(self, vertices):
        """Diagonal of the box of some vertices, before and after."""
        poses = [self.before, *self.after]
        ends = [[pose.coordinate(axis, v) for pose in poses for v in vertices] for axis in range(3)]
        return math.dist([min(e) for e in ends], [max(e) for e in ends])


class Comparison:
    def __init__(self, first, second, name):
        for which, a, b in [("meshes read", first.before, second.before),
                            *[("meshes written", a, b) for a, b in zip(first.after, second.after)]]:
            if len(first.after) != len(second.after) or len(a) != len(b) or a.faces != b.faces:
                raise Failed(f"{name}: the {which} have other vertices or faces.")
        moved = first.moved()
        if not moved:
            raise Failed(f"{name}: the edit moves nothing.")
        if first.before.differing(second.before):
            raise Failed(f"{name}: the meshes read have other coordinates.")
        self.moved, self.compared, self.differing, self.ulp, largest = len(moved), 0, 0, 0, 0.0
        for a, b in zip(first.after, second.after):
            self.compared += 3 * len(a)
            for axis, v in a.differing(b):
                self.differing += 1
                self.ulp = max(self.ulp, abs(rank(a.bits[axis][v]) - rank(b.bits[axis][v])))
                largest = max(largest, abs(a.coordinate(axis, v) - b.coordinate(axis, v)))
        self.relative = largest / first.size(moved)

    def __str__(self):
        return f"{self.differing:,} ({self.ulp:,} ULP, {self.relative:.1e})" if self.differing else "0"


def edits_in(folder):
    return sorted(str(path.parent.relative_to(folder)) for path in folder.glob("*/*/report.json"))


def compare(folders):
    """Prints the table. @return sentences on what is not the same"""
    names = edits_in(folders[0])
    failures = [f"{folder} has not the edits of {folders[0]}." for folder in folders
                if not names or edits_in(folder) != names]
    if failures:
        return failures

    others = [folder.name for folder in folders[1:]]
    print(f"{len(names)} edits; {', '.join(others)} compared with {folders[0].name}. Where coordinates differ: how many, the "
          "largest difference in units in the last place (ULP), and over the diagonal of the moved vertices.\n")
    print("| edit | vertices in the region | moved | coordinates |", " | ".join(others), "|")
    print("|---|---:|---:|---:|" + "---:|" * len(others))
    totals = [0, 0]
    for name in names:
        try:
            first = Edit(folders[0] / name)
            results = [Comparison(first, Edit(folder / name), f"{name} on {other}")
                       for folder, other in zip(folders[1:], others)]
        except Failed as failure:
            failures.append(str(failure))
            continue
        print(f"| {name} | {first.region:,} | {results[0].moved:,} | {results[0].compared:,} |",
              " | ".join(map(str, results)), "|", flush=True)
        for result, other in zip(results, others):
            totals[0] += result.compared
            totals[1] += result.differing
            if result.differing:
                failures.append(f"{name} on {other}: {result}.")
    print(f"\n{totals[0]:,} coordinates compared, {totals[1]:,} differ.")
    return failures


def digests_of(folder):
    """By edit: the digests of the poses, the first of which is the mesh as it was read."""
    edits = {name: Edit(folder / name) for name in edits_in(folder)}
    return {name: [pose.digest() for pose in (edit.before, *edit.after)] for name, edit in edits.items()}


def stored_digests():
    lines = DIGESTS.read_text(encoding="utf-8").splitlines()
    return {name: digests for name, *digests in map(str.split, lines)}


def compare_with_stored(folder):
    """@return sentences on what is not the same. An edit whose mesh this machine lacks is not compared."""
    stored, failures = stored_digests(), []
    made = digests_of(folder)
    for name, digests in made.items():
        if name not in stored:
            failures.append(f"{name} has no stored digests: write them with --store.")
        elif digests[0] != stored[name][0]:
            failures.append(f"{name}: the mesh has other coordinates than when the digests were stored.")
        elif digests != stored[name]:
            failures.append(f"{name}: the edit gives other coordinates than when the digests were stored.")
    print(f"{len(made)} of {len(stored)} stored edits compared.")
    return failures if made else [f"{folder} has no edits."]


def main():
    arguments = sys.argv[1:]
    if len(arguments) != 2 and (len(arguments) < 2 or arguments[0].startswith("--")):
        sys.exit("\n".join(__doc__.splitlines()[2:5]))
    if arguments[0] == "--store":
        DIGESTS.write_text("".join(f"{name} {' '.join(digests)}\n"
                                   for name, digests in digests_of(pathlib.Path(arguments[1])).items()))
        return
    if arguments[0] == "--stored":
        failures = compare_with_stored(pathlib.Path(arguments[1]))
    else:
        failures = compare([pathlib.Path(argument) for argument in arguments])
    if failures:
        print("\nNot the same:", *failures, sep="\n  ")
        sys.exit(1)


if __name__ == "__main__":
    main()
