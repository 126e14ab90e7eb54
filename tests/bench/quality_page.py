#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of common/docs/peers.md from quality.json of tests/bench/quality.sh: the default against as-rigid-as-possible
deformation by class, evenness, the shape of each edit, how often each peer does better, how far handles miss, and the
project's targets, of which missed ones are bold.

usage: quality_page.py quality.json
"""
import json
import statistics
import sys

OURS = "default"
PEERS = ("ARAP", "ARAP100", "SR-ARAP", "Smooth-ARAP", "libigl", "biharmonic", "Blender")
METHODS = ("paper", OURS, *PEERS)
FIGURES = {
    "RMS stretch": lambda f: f["rms"],
    "largest stretch": lambda f: f["largest"],
    "flipped": lambda f: f["flipped"],
    "new pairs": lambda f: f["pairs"],
    "volume": lambda f: None if f["volume"] is None else abs(f["volume"]),
    "handle": lambda f: f["behind"],
    "preparing": lambda f: f["prepare_ms"],
    "settled": lambda f: None if f["prepare_ms"] is None else f["prepare_ms"] + f["solve_ms"],
    "frame": lambda f: f["frame_ms"],
}
TURNED = "group turned by at most 90", "group turned by more", "several groups, components", "elbows"
# What, of which edits, over which peer; the figure; mean, median, largest of the edits' ratios, or sum: of the sums; bound.
TARGETS = (
    ("movement of what is far", "all", "ARAP100", lambda f: f["far"] + 0.01, max, 1.5),
    ("RMS stretch", "coarse meshes", "ARAP", lambda f: f["rms"], statistics.mean, 1),
    ("RMS stretch", "half fine meshes", "ARAP", lambda f: f["rms"], statistics.mean, 1.1),
    ("stretch by area", "all", "ARAP", lambda f: f["area_rms"], statistics.mean, 1.05),
    ("tilt of details", "all", "ARAP", lambda f: f["tilt"], statistics.mean, 0.6),
    ("RMS stretch", "all", "ARAP", lambda f: f["rms"], statistics.mean, 0.97),
    ("RMS stretch", "all", "ARAP100", lambda f: f["rms"], statistics.mean, 1.25),
    ("RMS stretch", "turned groups", "ARAP", lambda f: f["rms"], statistics.mean, 1.05),
    ("RMS stretch", "turned groups", "ARAP100", lambda f: f["rms"], statistics.mean, 1.4),
    ("RMS stretch", "elbows", "ARAP", lambda f: f["rms"], statistics.mean, 1.3),
    ("RMS stretch", "elbows", "ARAP100", lambda f: f["rms"], statistics.mean, 1.7),
    ("flipped triangles", "elbows", "ARAP", lambda f: f["flipped"], sum, 0),
    ("largest stretch", "all", "ARAP", lambda f: f["largest"], sum, 0.8),
    ("flipped triangles", "all", "ARAP100", lambda f: f["flipped"], sum, 0.999),
    ("new pairs", "all", "ARAP", lambda f: f["pairs"], sum, 0.25),
    ("change of volume", "all", "ARAP", FIGURES["volume"], sum, 1),
    ("solving", "all", "ARAP", lambda f: f["solve_ms"], sum, 0.5),
    ("solving", "all", "ARAP", lambda f: f["solve_ms"], statistics.median, 0.5),
    ("frame", "all", "ARAP", lambda f: f["frame_ms"], sum, 0.125),
    ("frame", "all", "ARAP", lambda f: f["frame_ms"], statistics.median, 0.125))


def has_result(figures):
    return bool(figures) and "rms" in figures


def cell(figures):
    if not has_result(figures):
        return "-"
    return "{:.0f}/{:.0f}/{}/{}".format(100 * figures["rms"], 100 * figures["largest"], figures["flipped"],
                                        figures["pairs"])


def table(head, rows):
    print("|" + "|".join(head) + "|\n|---|" + "--:|" * (len(head) - 1))
    for row in rows:
        print("|" + "|".join(map(str, row)) + "|")
    print()


def counts(edits, peer):
    """Of the edits that both have made: in how many the peer's figure is better than ours, and than which ours is."""
    for value in FIGURES.values():
        pairs = [(value(edit[OURS]), value(edit[peer])) for edit in edits if has_result(edit.get(peer))]
        pairs = [(ours, theirs) for ours, theirs in pairs if ours is not None and theirs is not None]
        yield (f"{sum(theirs < ours for ours, theirs in pairs)}:{sum(ours < theirs for ours, theirs in pairs)}"
               if pairs else "-")


def handles(edits, method):
    """How far the handle is from its target, in per cent of its displacement: median and largest."""
    found = [100 * edit[method]["behind"] for edit in edits if has_result(edit.get(method))]
    return f"{statistics.median(found):.2g}", f"{max(found):.2g}"


def against_arap(edits):
    """By class of edits: means of the ratios of RMS stretch, ratio of the mean largest stretches, sums of folds."""
    for name in [*dict.fromkeys(edit["class"] for edit in edits), "all"]:
        those = [edit for edit in edits if name in (edit["class"], "all")]
        over = [statistics.mean(edit[OURS]["rms"] / edit[peer]["rms"] for edit in those) for peer in ("ARAP", "ARAP100")]
        largest = [sum(edit[method]["largest"] for edit in those) for method in (OURS, "ARAP")]
        sums = [", ".join(str(sum(edit[method][figure] for edit in those)) for method in (OURS, "ARAP", "ARAP100"))
                for figure in ("flipped", "pairs")]
        yield (name, len(those), *(f"{ratio:.2f}" for ratio in over), f"{largest[0] / largest[1]:.2f}", *sums)


def evenness(edits, method):
    """Means over the edits of stretch by area, shear, the worst 1 % of the area, tilt and far movement; then those of
    single edits: how uneven the bar's twist is, and how asymmetric the plane's S."""
    figures = [edit[method] for edit in edits.values()]
    means = [100 * statistics.mean(one[key] for one in figures) for key in ("area_rms", "shear", "worst", "far")]
    return (*(f"{mean:.1f}" for mean in means), f"{statistics.mean(one['tilt'] for one in figures):.1f}",
            *(f"{100 * edits[edit][method][key]:.0f}" if edit in edits else "-"
              for edit, key in (("survey_bar", "twist"), ("survey_plane", "asymmetry"))))


def targets(edits):
    for what, group, peer, value, of, bound in TARGETS:
        those = [edit for edit in edits if group in (edit["class"], "all") or group == "turned groups" and edit["class"] in TURNED]
        pairs = [(value(edit[OURS]), value(edit[peer])) for edit in those if has_result(edit.get(peer))]
        pairs = [(ours, theirs) for ours, theirs in pairs if None not in (ours, theirs)]
        if pairs:
            ours, theirs = zip(*pairs)
            ratio = (sum(ours) and sum(ours) / sum(theirs)) if of is sum else of(a / b for a, b in pairs)
            yield f"{what}, {group}, over {peer}", of.__name__, f"{ratio:.3g}" if ratio <= bound else f"**{ratio:.3g}**", bound


def print_tables(edits):
    present = [method for method in METHODS if any(method in edit for edit in edits.values())]
    if {OURS, "ARAP", "ARAP100"} - set(present):
        print("The tables need the methods default, ARAP and ARAP100.")
        return
    table(("edits", "", "RMS over ARAP's", "over ARAP100's", "largest over ARAP's", "flipped: default, ARAP, ARAP100",
           "new pairs"), against_arap(list(edits.values())))
    everywhere = [method for method in METHODS if all(has_result(edit.get(method)) for edit in edits.values())]
    table(("mean, %", "stretch by area", "shear", "worst 1 %", "far movement", "tilt, degrees", "uneven twist", "asymmetry"),
          [(method, *evenness(edits, method)) for method in everywhere])
    table(("edit", "vertices", *present),
          [(name, edit["vertices"], *(cell(edit.get(method)) for method in present)) for name, edit in edits.items()])
    table(("peer better:default better", *FIGURES),
          [(peer, *counts(list(edits.values()), peer)) for peer in present if peer in PEERS])
    table(("handle from its target, % of its displacement", "median", "largest"),
          [(method, *handles(list(edits.values()), method)) for method in present])
    table(("the default over ARAP", "ratios or sums", "measured", "target"), targets(list(edits.values())))


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as figures:
        print_tables(json.load(figures))
