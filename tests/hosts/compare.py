#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the coordinates of the same edits made by several builds, or with the stored digests of their coordinates.

usage: compare.py FOLDER FOLDER...    compares each folder with the first one
       compare.py --stored FOLDER     compares a folder with digests.txt
       compare.py --store FOLDER      writes digests.txt

The folders are made by write_results.sh. Every coordinate of every mesh has to be the same to the bit; the program ends
with 1 if one differs. digests.txt has a line for each edit: the first 16 digits of a SHA-256 of the coordinates that were
read, and of those that were written.
"""
import array
import hashlib
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "batch"))

from ply import Ply  # noqa: E402

DIGESTS = pathlib.Path(__file__).resolve().parent / "digests.txt"


def digest(path):
    rows = Ply(path).elements["vertex"]
    return hashlib.sha256(b"".join(array.array("I", rows[axis]).tobytes() for axis in "xyz")).hexdigest()[:16]


def digests_of(folder):
    """By edit: the digests of the poses, the first of which is the mesh as it was read."""
    return {str(report.parent.relative_to(folder)): [digest(pose) for pose in sorted(report.parent.glob("pose-*.ply"))]
            for report in sorted(folder.glob("*/*/report.json"))}


def stored_digests():
    lines = DIGESTS.read_text(encoding="utf-8").splitlines()
    return {name: digests for name, *digests in map(str.split, lines)}


def differences(made, expected, source):
    """@param source  what made the expected digests. @return sentences on what is not the same"""
    failures = []
    for name, digests in made.items():
        if name not in expected:
            failures.append(f"{name} is not among the edits of {source}.")
        elif len(digests) != len(expected[name]):
            failures.append(f"{name} has {len(digests)} meshes, but {len(expected[name])} by {source}.")
        elif digests[0] != expected[name][0]:
            failures.append(f"{name}: the mesh that was read has other coordinates than by {source}.")
        elif digests != expected[name]:
            failures.append(f"{name}: the edit gives other coordinates than by {source}.")
        elif len(set(digests)) == 1:
            failures.append(f"{name}: the edit moves nothing.")
    return failures


def compare(folders):
    """Edits that one folder lacks are a failure. @return sentences on what is not the same"""
    first = digests_of(folders[0])
    failures = [] if first else [f"{folders[0]} has no edits."]
    for folder in folders[1:]:
        made = digests_of(folder)
        failures += [f"{folder} has not the edit {name}." for name in sorted(first.keys() - made.keys())]
        failures += [f"{folder}: {sentence}" for sentence in differences(made, first, folders[0])]
    print(f"{len(first)} edits of {len(folders)} folders compared.")
    return failures


def compare_with_stored(folder):
    """Edits whose mesh this machine lacks are not compared. @return sentences on what is not the same"""
    made, stored = digests_of(folder), stored_digests()
    print(f"{len(made)} of {len(stored)} stored edits compared.")
    return differences(made, stored, f"{DIGESTS.name}, which --store writes") if made else [f"{folder} has no edits."]


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
