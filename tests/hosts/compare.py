#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the coordinates of the same edits made by several builds, or with stored ones.

usage: compare.py FOLDER FOLDER...    compares each folder with the first one
       compare.py --stored FOLDER     compares a folder with stored.json
       compare.py --store FOLDER      writes stored.json

The folders are made by write_results.sh, in double precision. The mesh that was read has to be the same to the bit; poses
may differ by 1e-9 of its size (diagonal of the bounding box), those of edits with the name "fit" by 1e-5. The largest
difference is printed, and the program ends with 1 if one is too large.

stored.json has for each edit a digest of the mesh that was read, and for each pose some vertices that moved and a sum of all
displacements, with random signs and weights of 0.5 to 1.5, over the root of the number of coordinates that moved. It may
differ like a coordinate, so if 10,000 coordinates moved, an error of 2e-7 of the size is noticed at any of them.
"""
import array
import functools
import hashlib
import itertools
import json
import math
import operator
import pathlib
import random
import re
import sys

STORED = pathlib.Path(__file__).resolve().parent / "stored.json"
# Over the size. Poses that hardly move agree whatever the solver does.
LEAST_MOTION = 1e-3


def tolerance(name):
    return 1e-5 if name.endswith("/fit") else 1e-9


def coordinates(path):
    """x, y, z of the first vertex, of the second and so on. Single precision would hide differences."""
    header, _, data = path.read_bytes().partition(b"end_header\n")
    form = re.match(rb"ply\nformat binary_little_endian 1.0\n(?:comment.*\n|obj_info.*\n)*element vertex (\d+)\n"
                    rb"property double x\nproperty double y\nproperty double z\nelement", header)
    if not form:
        sys.exit(f"{path} has other properties than double x, y and z, or another format.")
    return array.array("d", data[:24 * int(form[1])])


def digest(mesh):
    return hashlib.sha256(mesh.tobytes()).hexdigest()[:16]


def size_of(mesh):
    return math.dist(*([pick(mesh[axis::3]) for axis in range(3)] for pick in (min, max)))


def largest_difference(one, other):
    return max(map(abs, map(operator.sub, one, other)))


def numbers_of(mesh, pose, moved, vertices):
    """What is stored of a pose: the sum over the root of `moved`, and the coordinates of the vertices."""
    uniform = random.Random(1).random
    total = math.fsum(math.copysign(uniform() + 0.5, uniform() - 0.5) * (there - here) for here, there in zip(mesh, pose))
    return [total / math.sqrt(moved), *(c for v in vertices for c in pose[3 * v:3 * v + 3])]


def difference_to_numbers(mesh, numbers, moved, vertices, pose):
    return largest_difference(numbers_of(mesh, pose, moved, vertices), numbers)


def edits_of(folder):
    """By edit: the files of its poses, the first of which is the mesh that was read."""
    edits = {}
    for pose in sorted(folder.glob("*/*/pose-*.ply")):
        edits.setdefault(pose.parent.relative_to(folder).as_posix(), []).append(pose)
    return edits


class Unlike(Exception):
    """What is wrong with an edit, as the end of a sentence."""


def read(files):
    """@return mesh and poses, which can be compared with others"""
    mesh, *poses = map(coordinates, files)
    if any(len(pose) != len(mesh) for pose in poses):
        raise Unlike("has poses with another number of vertices than the mesh")
    if not all(map(math.isfinite, itertools.chain(mesh, *poses))):
        raise Unlike("has a coordinate that is not finite")
    if min((largest_difference(mesh, pose) for pose in poses), default=0) < LEAST_MOTION * size_of(mesh):
        raise Unlike("moves nothing, or too little to be compared")
    return mesh, poses


class Comparison:
    def __init__(self):
        self.failures = []
        self.largest = {}  # by tolerance: difference over the size, and where

    def compare(self, name, folder, mesh, poses, expected_mesh, differences):
        """@param expected_mesh  digest
        @param differences       by pose: returns its difference to the expected one"""
        if digest(mesh) != expected_mesh:
            raise Unlike("begins with a mesh of other coordinates")
        if len(poses) != len(differences):
            raise Unlike(f"has {len(poses)} poses in place of {len(differences)}")
        difference = max(of(pose) for of, pose in zip(differences, poses)) / size_of(mesh)
        allowed = tolerance(name)
        self.largest[allowed] = max(self.largest.get(allowed, (0, "")), (difference, f"{folder}: {name}"))
        if difference > allowed:
            raise Unlike(f"has coordinates that differ by {difference:.2g} of the size, where {allowed:g} are allowed")

    def end(self, what):
        """Prints the result. @return whether all is the same"""
        print(f"{what} compared.")
        for allowed, (difference, where) in sorted(self.largest.items()):
            print(f"Largest difference over the size: {difference:.2g}, allowed {allowed:g} ({where})")
        if self.failures:
            print("\nNot the same:", *self.failures, sep="\n  ")
        return not self.failures


def compare(folders):
    comparison = Comparison()
    edits = [edits_of(folder) for folder in folders]
    names = sorted(set().union(*edits))
    for name in names:
        expected = None
        for folder, files in zip(folders, edits):
            try:
                if name not in files:
                    raise Unlike("is missing")
                mesh, poses = read(files[name])
                if expected:
                    comparison.compare(name, folder, mesh, poses, *expected)
                else:
                    expected = digest(mesh), [functools.partial(largest_difference, pose) for pose in poses]
            except Unlike as problem:
                comparison.failures.append(f"{folder}: {name} {problem}.")
    if not names:
        comparison.failures.append("There are no edits.")
    return comparison.end(f"{len(names)} edits of {len(folders)} folders")


def store(folder):
    lines = []
    for name, files in edits_of(folder).items():
        mesh, poses = read(files)
        moved = [k for k, (here, there) in enumerate(zip(mesh, poses[-1])) if here != there]
        vertices = [moved[len(moved) * part // 6] // 3 for part in (1, 3, 5)]
        numbers = [numbers_of(mesh, pose, len(moved), vertices) for pose in poses]
        stored = {"mesh": digest(mesh), "moved": len(moved), "vertices": vertices, "poses": numbers}
        lines.append(f"{json.dumps(name)}: {json.dumps(stored)}")
    STORED.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def compare_with_stored(folder):
    """Edits whose mesh this machine lacks are not compared."""
    comparison = Comparison()
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    edits = edits_of(folder)
    for name, files in edits.items():
        try:
            if name not in stored:
                raise Unlike(f"is not in {STORED.name}, which --store writes")
            mesh, poses = read(files)
            edit = stored[name]
            comparison.compare(name, folder, mesh, poses, edit["mesh"], [
                functools.partial(difference_to_numbers, mesh, numbers, edit["moved"], edit["vertices"]) for numbers in edit["poses"]])
        except Unlike as problem:
            comparison.failures.append(f"{folder}: {name} {problem}.")
    if not edits:
        comparison.failures.append(f"{folder} has no edits.")
    return comparison.end(f"{len(edits)} of {len(stored)} stored edits")


def main():
    arguments = sys.argv[1:]
    if len(arguments) != 2 and (len(arguments) < 2 or arguments[0].startswith("--")):
        sys.exit("\n".join(__doc__.splitlines()[2:5]))
    folders = [pathlib.Path(argument) for argument in arguments if not argument.startswith("--")]
    if arguments[0] == "--store":
        store(*folders)
    elif not (compare_with_stored(*folders) if arguments[0] == "--stored" else compare(folders)):
        sys.exit(1)


if __name__ == "__main__":
    main()
