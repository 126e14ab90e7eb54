#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fails where a class or a function of the shipped code has grown beyond what a reader keeps in mind.

usage: sizes.py CTAGS SOURCE_FOLDER
"""
import collections
import pathlib
import subprocess
import sys

MOST_FIELDS = 20
MOST_LINES = 100
SHIPPED = ("common", "filter_laplacian_edit", "edit_laplacian_drag")


def tags(ctags, root):
    """(kind, file, name, scope, first line, last line) of all functions and fields."""
    files = sorted(str(path.relative_to(root)) for folder in SHIPPED for suffix in ("*.h", "*.cpp")
                   for path in (root / folder).rglob(suffix))
    text = subprocess.run([ctags, "-f", "-", "--output-format=u-ctags", "--language-force=C++", "--kinds-C++=fm",
                           "--fields=+neK", *files], cwd=root, check=True, capture_output=True, text=True).stdout
    for line in text.splitlines():
        if line.startswith("!"):
            continue
        name, file, _, kind, *rest = line.split("\t")
        fields = dict(entry.split(":", 1) for entry in rest if ":" in entry)
        first = int(fields["line"])
        scope = fields.get("class") or fields.get("struct") or fields.get("union") or ""
        yield kind, file, name, scope, first, int(fields.get("end", first))


def main():
    ctags, root = sys.argv[1], pathlib.Path(sys.argv[2])
    counts = collections.Counter()
    lengths = []
    for kind, file, name, scope, first, last in tags(ctags, root):
        if kind in ("m", "member"):
            counts[(file, scope)] += 1
        else:
            lengths.append((last - first + 1, file, name))
    if not counts or not lengths:
        sys.exit("sizes.py: nothing was found: is this Universal Ctags, and are the folders there?")
    (largest_file, largest), fields = counts.most_common(1)[0]
    lines, longest_file, longest = max(lengths)
    print(f"{len(counts)} classes, the largest {largest} in {largest_file} with {fields} fields; "
          f"{len(lengths)} functions, the longest {longest}() in {longest_file} with {lines} lines")
    bad = [f"{file}: {scope} has {count} fields, more than {MOST_FIELDS}" for (file, scope), count in counts.items()
           if count > MOST_FIELDS]
    bad += [f"{file}: {name}() has {length} lines, more than {MOST_LINES}" for length, file, name in lengths
            if length > MOST_LINES]
    if bad:
        sys.exit("\n".join(sorted(bad)))


if __name__ == "__main__":
    main()
