#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of common/docs/quality.md from quality.json of tests/scripts/quality.sh.

usage: quality_page.py quality.json
"""
import json
import sys

METHODS = ("paper", "before", "default", "ARAP", "SR-ARAP", "Blender")


def cell(figures):
    if not figures or "rms" not in figures:
        return "-"
    return "{:.0f} / {:.0f} / {} / {}".format(100 * figures["rms"], 100 * figures["largest"], figures["flipped"],
                                              figures["pairs"])


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        edits = json.load(file)
    edits = {name: edit for name, edit in edits.items() if isinstance(edit, dict) and "vertices" in edit}
    print("| edit | vertices | " + " | ".join(METHODS) + " |")
    print("|---|--:|" + "--:|" * len(METHODS))
    for name, edit in edits.items():
        print(f"| {name} | {edit['vertices']} | " + " | ".join(cell(edit.get(method)) for method in METHODS) + " |")


main()
