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
    if not files:
        raise Unlike("is missing")
    mesh, *poses = map(coordinates, files)
    if any(len(pose) != len(mesh) for pose in poses):
        raise Unlike("has poses with another number of vertices than the mesh")
    if not all(map(math.isfinite, itertools.chain(mesh, *poses))):
        raise Unlike("has a coordinate that is not finite")
    if min((largest_difference(mesh, pose) for pose in poses), default=0) < LEAST_MOTION * size_of(mesh):
        raise Unlike("moves nothing, or too little to be compared")
    return mesh, poses


def stored_form(mesh, poses):
    moved = [k for k, (here, there) in enumerate(zip(mesh, poses[-1])) if here != there]
    chosen = {"moved": len(moved), "vertices": [moved[len(moved) * part // 6] // 3 for part in (1, 3, 5)]}
    return {"mesh": digest(mesh), **chosen, "poses": [numbers_of(mesh, pose, **chosen) for pose in poses]}


def difference(mesh, poses, expected):
    """@param expected  in its stored form, or with all coordinates in place of numbers. @return over the size"""
    if digest(mesh) != expected["mesh"]:
        raise Unlike("begins with a mesh of other coordinates")
    if len(poses) != len(expected["poses"]):
        raise Unlike(f"has {len(poses)} poses in place of {len(expected['poses'])}")
    if "moved" in expected:
        poses = [numbers_of(mesh, pose, expected["moved"], expected["vertices"]) for pose in poses]
    return max(map(largest_difference, poses, expected["poses"])) / size_of(mesh)


def compare(folders, stored=None):
    """Prints what is not the same. @param stored  by edit; None: the first folder is compared with the others
    @return whether all is the same"""
    failures, largest = [], {}  # the latter by tolerance: difference, and where
    edits = [edits_of(folder) for folder in folders]
    names = sorted(set().union(*edits))
    for name in names:
        expected = (stored or {}).get(name)
        for folder, files in zip(folders, edits):
            try:
                mesh, poses = read(files.get(name))
                if expected:
                    allowed, found = tolerance(name), difference(mesh, poses, expected)
                    largest[allowed] = max(largest.get(allowed, (0, "")), (found, f"{folder}: {name}"))
                    if found > allowed:
                        raise Unlike(f"has coordinates that differ by {found:.2g} of the size, where {allowed:g} are allowed")
                elif stored is None:
                    expected = {"mesh": digest(mesh), "poses": poses}
                else:
                    raise Unlike(f"is not in {STORED.name}, which --store writes")
            except Unlike as problem:
                failures.append(f"{folder}: {name} {problem}.")
    if not names:
        failures.append("There are no edits.")
    print(f"{len(names)} edits of {len(folders)} folders compared" + (f" with {len(stored)} stored ones." if stored else "."))
    for allowed, (found, where) in sorted(largest.items()):
        print(f"Largest difference over the size: {found:.2g}, allowed {allowed:g} ({where})")
    if failures:
        print("\nNot the same:", *failures, sep="\n  ")
    return not failures


def main():
    arguments = sys.argv[1:]
    if len(arguments) != 2 and (len(arguments) < 2 or arguments[0].startswith("--")):
        sys.exit("\n".join(__doc__.splitlines()[2:5]))
    folders = [pathlib.Path(argument) for argument in arguments if not argument.startswith("--")]
    if arguments[0] == "--store":
        lines = [f"{json.dumps(name)}: {json.dumps(stored_form(*read(files)))}" for name, files in edits_of(folders[0]).items()]
        STORED.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    elif not compare(folders, json.loads(STORED.read_text(encoding="utf-8")) if arguments[0] == "--stored" else None):
        sys.exit(1)


if __name__ == "__main__":
    main()
