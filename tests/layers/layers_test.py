#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles includes as a layer's own files are compiled: of the layers below it all headers, of any other none.

usage: layers_test.py BUILD LAYER   with the commands in BUILD/compile_commands.json
       layers_test.py BUILD paths   the text of all includes: none goes round the layers
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

COMMON = pathlib.Path(__file__).resolve().parents[2] / "common"
CORE = ["base", "mesh", "linear", "deform", "cells", "fit", "edit", "live", "session"]
# Each layer and what is below it: what architecture.md promises, not what CMake happens to link.
BELOW = {layer: CORE[:i] for i, layer in enumerate(CORE)}
BELOW["linear"] = ["base"]
BELOW["fit"] = BELOW["cells"]
BELOW["json"] = BELOW["host"] = BELOW["live"]
# One header each of Qt, OpenGL for Qt, vcglib and all MeshLabs.
HOSTS_OWN = ["QtCore/QString", "QString", "QGLWidget", "vcg/complex/complex.h", "common/ml_document/mesh_model.h",
             "common/interfaces.h", "common/meshmodel.h", "common/plugins/interfaces/filter_plugin.h"]
# In angle brackets the core has the standard library and Eigen; besides, the layer that needs it:
LIBRARIES = {"base": ["arm_neon.h"], "linear": ["sys/mman.h"], "json": ["nlohmann/json.hpp"]}


def folder(layer):
    return COMMON / ("lapedit_host" if layer == "host" else f"lapedit/{layer}")


def headers(layer):
    """As they are included; of the host not the adapters, whose folders are include roots."""
    prefix = "lapedit_host" if layer == "host" else f"lapedit/{layer}"
    return [f"{prefix}/{path.name}" for path in sorted(folder(layer).glob("*.h"))]


def public_headers(layer):
    """Those that other layers can include."""
    return ["lapedit/linear/linear.h"] if layer == "linear" else headers(layer)


def compile_command(build, layer):
    """The command of one of the layer's files, or of several in one, without the file and what is written."""
    for entry in json.loads((build / "compile_commands.json").read_text()):
        command = shlex.split(entry["command"])
        output = command.index("-o")
        if f"/lapedit_{layer}.dir/" in command[output + 1]:
            command = command[:output]
            # Only single files have this option, and several in one file have not.
            return [*(word for word in command if not word.endswith("ccache")), "-Wno-psabi"], entry["directory"]
    sys.exit(f"{build}/compile_commands.json has no file of {layer}")


def main():
    build, layer = pathlib.Path(sys.argv[1]), sys.argv[2]
    failures = check_paths() if layer == "paths" else check_layer(build, layer)
    print("\n".join(failures))
    sys.exit(bool(failures))


def check_layer(build, layer):
    command, directory = compile_command(build, layer)

    def errors(source):
        """What the compiler says to this source; empty: it compiles."""
        done = subprocess.run([*command, "-fsyntax-only", "-x", "c++", "-"], cwd=directory, input=source, text=True,
                              env=dict(os.environ, LC_ALL="C"), stderr=subprocess.PIPE, check=False)
        return done.stderr if done.returncode else ""

    mine = headers(layer) + [header for name in BELOW[layer] for header in public_headers(name)]
    message = errors("".join(f'#include "{header}"\n' for header in mine))
    failures = [f"{layer} cannot include what it may:\n{message}"] if message else []
    forbidden = [header for name in BELOW for header in headers(name) if header not in mine]
    if layer != "host":
        forbidden += HOSTS_OWN
    message = errors("".join(f'#if __has_include("{header}")\n#error {header}\n#endif\n' for header in forbidden))
    if message:
        found = [header for header in forbidden if re.search(rf"#error {re.escape(header)}$", message, re.M)]
        failures.append(f"{layer} can include these, and must not: {', '.join(found) or message}")
    print(f"{layer}: {len(mine)} headers can be included, {len(forbidden)} cannot be")
    return failures


def check_paths():
    """Includes that the compiler finds without asking the include roots, or on every machine."""
    failures = []
    root = COMMON.parent
    for top in ("common", "filter_laplacian_edit", "edit_laplacian_drag"):
        for path in sorted([*(root / top).rglob("*.h"), *(root / top).rglob("*.cpp")]):
            layer = path.parent.name if path.parent.parent.name == "lapedit" else None
            allowed = "|".join([r"[a-z_0-9]+", r"(unsupported/)?Eigen/\w+", *LIBRARIES.get(layer, ())])
            for number, line in enumerate(path.read_text().split("\n"), 1):
                match = re.match(r'\s*#\s*include\s*(?:"(.*)"|<(.*)>)', line)
                if not match:
                    continue
                quoted, bracketed = match.groups()
                name = quoted or bracketed
                wrong = ".." in name.split("/") or name.startswith("/")
                if layer and quoted:
                    wrong = wrong or not re.fullmatch(r"lapedit/[a-z]+/\w+\.h", quoted)
                elif layer:
                    wrong = wrong or not re.fullmatch(allowed, bracketed)
                if wrong:
                    failures.append(f"{path.relative_to(root)}:{number}: {line.strip()}")
    return failures


if __name__ == "__main__":
    main()
