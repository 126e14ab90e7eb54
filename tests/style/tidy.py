#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs clang-tidy over the source files of the project; over benchmarks and fuzzers if CMAKE_OPTIONs turn them on.

usage: tidy.py RUN_CLANG_TIDY FOLDER all|changed [CMAKE_OPTION]...

FOLDER gets the commands that compile each file by itself, which a build of several files in one does not have. "changed":
the files that differ from where this branch left origin/main, or from the last commit's parent where that is not known,
and for a changed header one file that includes it. More than MOST files are not checked then: checking all takes an hour.
"""
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST = 12
SHIPPED = ("common", "filter_laplacian_edit", "edit_laplacian_drag")
CHECKED = *SHIPPED, "tests"


def git(*words):
    done = subprocess.run(["git", *words], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8",
                          check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def changed(sources):
    """Those of the sources that show what has changed."""
    head = git("rev-parse", "HEAD")
    base = git("merge-base", "HEAD", "origin/main")
    if base in ("", head):
        base = git("rev-parse", "HEAD^")
    if not base:
        print("There is no commit to compare with.")
        return []
    names = [ROOT / name for name in git("diff", "--name-only", "--diff-filter=d", base).splitlines()]
    texts = {}
    found = [path for path in names if path in sources]
    for header in names:
        if header.relative_to(ROOT).parts[0] in SHIPPED and header.suffix == ".h" and header.with_suffix(".cpp") not in found:
            texts = texts or {path: path.read_text(encoding="utf-8") for path in sorted(sources)}
            including = [path for path in texts if re.search(rf'#include "([^"]*/)?{re.escape(header.name)}"', texts[path])]
            own = header.with_suffix(".cpp")
            if including and not set(including) & set(found):
                found.append(own if own in including else including[0])
    print(f"{len(found)} files since {base[:9]}")
    for path in found[MOST:]:
        print(f"not checked: {path.relative_to(ROOT)}")
    return found[:MOST]


def main():
    if len(sys.argv) < 4 or sys.argv[3] not in ("all", "changed"):
        sys.exit(re.search(r"usage: .*", __doc__)[0])
    tidy, folder, which, *options = sys.argv[1:]
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-DLAPEDIT_BUILD_TESTS=ON", "-DCMAKE_UNITY_BUILD=OFF", *options], check=True,
                   stdout=subprocess.DEVNULL)
    entries = json.loads((pathlib.Path(folder) / "compile_commands.json").read_text(encoding="utf-8"))
    sources = {path for path in {pathlib.Path(entry["file"]) for entry in entries}
               if ROOT in path.parents and path.relative_to(ROOT).parts[0] in CHECKED}
    files = sorted(sources) if which == "all" else changed(sources)
    if files:
        patterns = [f"^{re.escape(str(path))}$" for path in files]
        sys.exit(subprocess.run([tidy, "-quiet", "-p", folder, *patterns], check=False).returncode)


if __name__ == "__main__":
    main()
