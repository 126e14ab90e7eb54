#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A layer includes its own headers and those of the layers below it, in angle brackets the standard library and Eigen, and
nothing of MeshLab or Qt; no include goes round the include roots, which let nothing else compile."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CORE = ["base", "mesh", "linear", "deform", "cells", "fit", "edit", "session"]
# Each layer and what is below it: what architecture.md promises, not what CMake happens to link.
BELOW = {layer: CORE[:i] for i, layer in enumerate(CORE)}
BELOW["linear"] = ["base"]
BELOW["fit"] = BELOW["cells"]
BELOW["json"] = [*BELOW["session"]]
# Besides the standard library and Eigen.
LIBRARIES = {"base": ["arm_neon.h"], "linear": ["sys/mman.h"], "json": ["nlohmann/json.hpp"]}


def is_allowed(layer, quoted, bracketed):
    if quoted:
        found = re.fullmatch(r"lapedit/([a-z]+)/(\w+\.h)", quoted)
        return found and (found[1] == layer or found[1] in BELOW[layer] and (found[1] != "linear" or found[2] == "linear.h"))
    return re.fullmatch("|".join([r"[a-z_0-9]+", r"Eigen/\w+", *LIBRARIES.get(layer, ())]), bracketed)


def main():
    read, failures = 0, []
    for top in ("common", "filter_laplacian_edit", "edit_laplacian_drag"):
        for path in sorted([*(ROOT / top).rglob("*.h"), *(ROOT / top).rglob("*.cpp")]):
            layer = path.parent.name if path.parent.parent == ROOT / "common/core" or path.parent == ROOT / "common/session" else None
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                if found := re.match(r'\s*#\s*include\s*(?:"(.*)"|<(.*)>)', line):
                    read += 1
                    name = found[1] or found[2]
                    if ".." in name.split("/") or name.startswith("/") or layer and not is_allowed(layer, found[1], found[2]):
                        failures.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    print(f"{read} includes", *failures, sep="\n")
    sys.exit(bool(failures) or read < 1000)


if __name__ == "__main__":
    main()
