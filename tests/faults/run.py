#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts each fault of faults.txt into a copy of the sources, runs the tests of its layer, and prints which test catches it.

usage: run.py [--folder FOLDER] [--tests COMMIT] [LAYER]...     all layers by default; FOLDER: build-faults by default

All faults are compiled into one build, and the environment variable LAPEDIT_FAULT chooses one. A layer's test programs are run
until one fails. --tests takes the tests of another commit, to compare. Faults that no test catches are no failure of this script.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = pathlib.Path(__file__).with_name("faults.txt")
# In this order: test programs, and tests of ctest.
TESTS = {"base": ["base_tests", "deform_tests", "fit_tests"], "mesh": ["mesh_tests", "edit_tests", "session_tests", "command.landmarks", "command.edits"],
         "linear": ["linear_tests", "deform_tests"], "deform": ["deform_tests", "edit_tests", "command.edits"], "cells": ["cells_tests", "edit_tests", "command.edits"],
         "fit": ["fit_tests", "edit_tests", "command.fit", "command.fits"], "edit": ["edit_tests", "json_tests", "command.program", "command.edits", "command.landmarks", "command.fits"],
         "session": ["session_tests"], "json": ["json_tests", "command.landmarks", "command.program"],
         "host": ["bridge_tests", "host.*"], "filter": ["host.*"], "program": ["command.(program|formats|fit)"],
         "tool": ["gui.*"], "python": ["python.(wheels|newest)"]}
TARGETS = {"host": ["all"], "filter": ["all"], "tool": ["all"], "python": ["laplacian_edit_program", "make_mesh"]}
HEADER = """#pragma once
#include <cstdlib>
inline bool lapedit_fault(int number) {
  static const char* const chosen = std::getenv("LAPEDIT_FAULT");
  return chosen != nullptr && std::atoi(chosen) == number;
}
"""


def read_faults():
    for number, line in enumerate(LIST.read_text(encoding="utf-8").splitlines(), 1):
        layer, file, *texts = (part.strip().replace("\0", "|") for part in line.replace("\\|", "\0").split(" | "))
        yield number, layer, file, *texts


def copy(folder, tests):
    """The sources that the working tree has, with the tests of a commit in their place."""
    folder.mkdir(parents=True, exist_ok=True)
    listed = subprocess.check_output(["git", "ls-files", "-z", "-co", "--exclude-standard"], cwd=ROOT).decode().split("\0")
    if tests:
        shutil.rmtree(folder / "tests", ignore_errors=True)
        subprocess.run(f"git archive {tests} tests | tar -x -C '{folder}'", shell=True, check=True, cwd=ROOT)
    for name in listed:
        source, target = ROOT / name, folder / name
        if source.is_file() and not (tests and name.startswith("tests/")):
            target.parent.mkdir(parents=True, exist_ok=True)
            if not target.exists() or target.read_bytes() != source.read_bytes():
                shutil.copyfile(source, target)
                shutil.copymode(source, target)


def insert(folder, faults):
    texts = {}
    for number, _, file, old, new in faults:
        text = texts.get(file) or (ROOT / file).read_text(encoding="utf-8")
        assert old in text, (number, file, old)
        tail = "||" if old.endswith("||") else ""
        old_value, new_value = old.removesuffix("||").strip(), new.removesuffix("||").strip()
        chosen = f"(lapedit_fault({number}) ? ({new_value}) : ({old_value})) {tail}"
        if file.endswith(".py"):
            chosen = f"({new} if __import__('os').environ.get('LAPEDIT_FAULT') == '{number}' else {old})"
        texts[file] = text.replace(old, chosen, 1)
    (folder / "fault.h").write_text(HEADER, encoding="utf-8")
    for file, text in texts.items():
        text = text if file.endswith(".py") else f'#include "{folder}/fault.h"\n{text}'
        if (folder / file).read_text(encoding="utf-8") != text:
            (folder / file).write_text(text, encoding="utf-8")


def fails(folder, test, number):
    """Whether a test program, or one of the tests of ctest, fails with a fault (0: without), or takes ten minutes."""
    program = folder / "build/tests/unit" / test
    command = ([program, "--gtest_fail_fast", "--gtest_brief=1"] if test.endswith("_tests") else
               ["ctest", "--test-dir", folder / "build", "--stop-on-failure", "--no-tests=error", "-R", f"^{test}$"])
    try:
        done = subprocess.run(command, env={**os.environ, "LAPEDIT_FAULT": str(number)}, check=False, timeout=600,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except subprocess.TimeoutExpired:
        return "takes ten minutes"
    lines = done.stdout.decode(errors="replace").splitlines()
    found = [line for line in lines if "FAILED  ]" in line or "***Failed" in line or "***Timeout" in line or line.startswith("FAIL:")]
    return (found or lines or ["fails"])[0].strip()[:90] if done.returncode else ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "build-faults")
    parser.add_argument("--tests")
    parser.add_argument("layers", nargs="*")
    given = parser.parse_args()
    folder, faults = given.folder.resolve(), list(read_faults())
    layers = given.layers or list(TESTS)
    copy(folder, given.tests)
    insert(folder, faults)
    targets = sorted({t for layer in layers for t in TARGETS.get(layer, ["laplacian_edit_program"])} |
                     {t for layer in layers for t in TESTS[layer] if t.endswith("_tests")})
    build = ["common/scripts/configure.sh", "build", "-DLAPEDIT_BUILD_TESTS=ON", "-DLAPEDIT_TEST_HOSTS=OFF"]
    for command in build, ["cmake", "--build", "build", "--parallel", str(os.cpu_count()), "--target", *targets]:
        subprocess.run(command, cwd=folder, check=True, stdout=sys.stderr)
    for test in sorted({test for layer in layers for test in TESTS[layer]}):
        if problem := fails(folder, test, 0):
            sys.exit(f"{test} fails without a fault: {problem}")
    for number, layer, file, _, new in (fault for fault in faults if fault[1] in layers):
        start = time.monotonic()
        caught = next(((test, text) for test in TESTS[layer] if (text := fails(folder, test, number))), ("", "NOT CAUGHT"))
        print(f"{number:2} {layer:8} {pathlib.Path(file).name:28} {new[:24]:24} {time.monotonic() - start:4.0f} s  {caught[0]:20} {caught[1]}",
              flush=True)


if __name__ == "__main__":
    main()
