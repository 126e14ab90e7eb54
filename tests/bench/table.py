#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a Markdown table of what speed_bench and blender_laplacian.py wrote.

usage: table.py FOLDER COMMIT > speed.md
FOLDER holds ours_<vertices>_<order>.json and blender_<vertices>_<round>.json.
"""
import collections
import json
import math
import pathlib
import platform
import statistics
import sys

# Targets of the project: ratio -> smallest region it holds for, and the largest ratio allowed. Ratios are ours over the
# peer's; CHOLMOD's time on two threads is the better one of one and two.
TARGETS = {
    "frame / Blender update": [(4685, 1 / 10), (12774, 1 / 20), (32280, 1 / 25)],
    "frame / CGAL iteration": [(100000, 1 / 8)],
    "first frame / CHOLMOD analyse + factor": [(32280, 1 / 8), (100000, 1 / 12), (300000, 1 / 20)],
    "first frame / drag frame": [(0, 1)],
    "solve / reading the factor twice": [(32280, 3)],
    "region ready / CHOLMOD analyse + factor": [(0, 1), (12000, 0.8)],
    "region ready / CGAL preprocess": [(0, 1)],
    "second handle / region ready": [(0, 1 / 12)],
    "second disc / region ready": [(0, 1 / 2)],
    "memory / CHOLMOD's factor": [(0, 1.4)],
}
ON_TWO_THREADS = {"first frame / CHOLMOD analyse + factor", "region ready / CHOLMOD analyse + factor"}


class Results:
    """What was measured: of each row (name, order, threads) and size the median, minimum, error, counters."""

    def __init__(self, folder):
        self.cells = collections.defaultdict(dict)  # (name, order, threads) -> size -> dict
        self.refusals = collections.defaultdict(set)  # reason -> rows
        self.context, self.blender = {}, ""
        files = sorted(folder.glob("ours_*.json"))
        if not files:
            sys.exit(f"table.py: there are no results in {folder}")
        for path in files:
            self.read_ours(json.loads(path.read_text(encoding="utf-8")))
        rounds = collections.defaultdict(list)
        for path in sorted(folder.glob("blender_*.json")):
            run = json.loads(path.read_text(encoding="utf-8"))
            rounds[run["vertices"]].append(run)
            self.blender = run["version"]
        for size, runs in rounds.items():
            self.add_blender(size, runs)
        self.sizes = sorted({size for row in self.cells.values() for size in row})

    def read_ours(self, data):
        self.context = data["context"]
        for run in data["benchmarks"]:
            parts = run["name" if run.get("error_occurred") else "run_name"].split("/")
            values = dict(part.split(":") for part in parts[2:] if ":" in part)
            size, order, threads = int(values["n"]), int(values["order"]), int(values["threads"])
            name = "/".join(parts[:2])
            cell = self.cells[name, order, threads].setdefault(size, {})
            if run.get("error_occurred"):
                cell["refused"] = run["error_message"]
                self.refusals[run["error_message"]].add((name, order))
            elif run.get("aggregate_name") in ("median", "min"):
                cell[run["aggregate_name"]] = run["real_time"]
                if run["time_unit"] != "ms":
                    sys.exit("table.py: the times are not in milliseconds")
            elif run.get("aggregate_name") == "max":
                for key in ("error", "bound", "bytes", "nonzeros", "cells", "largest"):
                    if key in run:
                        cell[key] = run[key]

    def add_blender(self, size, runs):
        updates = [ms for run in runs for ms in run["update_ms"]]
        binds = [run["bind_ms"] for run in runs]
        error = {"error": max(run["error"] for run in runs), "bound": runs[0]["bound"]}
        self.cells["blender/update", 1, 0][size] = {
            "median": statistics.median(updates), "min": min(updates), **error}
        self.cells["blender/bind", 1, 0][size] = {"median": statistics.median(binds), "min": min(binds), **error}
        base = [run["base_ms"] for run in runs]
        self.cells["blender/base", 1, 0][size] = {"median": statistics.median(base), "min": min(base), **error}

    def cell(self, name, order, threads, size):
        return self.cells.get((name, order, threads), {}).get(size, {})

    def get(self, name, order, threads, size, key="median"):
        return self.cell(name, order, threads, size).get(key)


def number(value):
    """Three digits, thousands separated."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{digits}f}" if digits < 5 else f"{value:.1e}"


def growth(points):
    """Least-squares slope of log value over log size."""
    points = [(math.log(size), math.log(value)) for size, value in points if value and value > 0]
    if len(points) < 3:
        return "-"
    mean_x = statistics.mean(x for x, _ in points)
    mean_y = statistics.mean(y for _, y in points)
    return f"{sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x)**2 for x, _ in points):.2f}"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---" + "|---:" * (len(head) - 1) + "|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def threads_text(threads):
    return {0: "", 1: ", 1 thread", 2: ", 2 threads"}[threads]


TIMES = [
    ("ours: first frame", "ours/hand", (1, 2)),
    ("ours: frame of the cells", "ours/hand_frame", (1, 2)),
    ("ours: region ready", "ours/ready", (1, 2)),
    ("ours: second handle in the same region", "ours/second_handle", (1, 2)),
    ("ours: a disc as the second handle", "ours/second_disc", (1, 2)),
    ("ours: drag frame", "ours/frame", (1, 2)),
    ("ours: the same pose by the plain path", "ours/exact", (1, 2)),
    ("ours: solve alone", "ours/solve", (1, 2)),
    ("ours: the same in single precision, not refined", "ours/solve_single", (1, 2)),
    ("CHOLMOD: analyse + factor", "cholmod/ready", (1, 2)),
    ("CHOLMOD: solve", "cholmod/solve", (1, 2)),
    ("bound: our factor read twice", "bound/read", (1, 2)),
    ("CGAL SR-ARAP: preprocess", "cgal/ready", (1,)),
    ("CGAL SR-ARAP: one iteration", "cgal/frame", (1,)),
    ("Blender: bind", "blender/bind", (0,)),
    ("Blender: update, less its base cost", "blender/update", (0,)),
    ("Blender: that base cost", "blender/base", (0,)),
]


def times(results, order):
    rows = []
    for label, name, all_threads in TIMES:
        for threads in all_threads:
            if (name, order, threads) not in results.cells:
                continue
            row = [label + threads_text(threads)]
            for size in results.sizes:
                cell = results.cell(name, order, threads, size)
                row.append(f"{number(cell['median'])} ({number(cell['min'])})" if "median" in cell else
                           "n/a" if "refused" in cell else "-")
            row.append(growth([(size, results.get(name, order, threads, size)) for size in results.sizes]))
            rows.append(row)
            if name == "ours/frame":
                frames = [results.get(name, order, threads, size) for size in results.sizes]
                rows.append(["ours: frames per second" + threads_text(threads)] +
                            [number(1000 / ms) if ms else "-" for ms in frames] + [""])
    for label, name, key, unit in (("ours: memory, MB", "ours/ready", "bytes", 1e6),
                                   ("ours: factor, MB", "ours/ready", "nonzeros", 1e6 / 8),
                                   ("CHOLMOD: factor, MB", "cholmod/ready", "nonzeros", 1e6 / 8),
                                   ("ours: cells", "ours/hand", "cells", 1)):
        values = [results.get(name, order, 1, size, key) for size in results.sizes]
        rows.append([label] + [number(value / unit) if value else "-" for value in values] +
                    [growth(zip(results.sizes, values))])
    return rows


def ratios(results, order):
    """@return rows, and how many cells miss their target"""
    def over(a, b):
        return a / b if a and b else None

    rows, missed = [], 0
    for label, targets in TARGETS.items():
        for threads in (1, 2):
            values = []
            for size in results.sizes:
                def ours(name, t=threads, n=size):
                    return results.get("ours/" + name, order, t, n)

                def cholmod(n=size, most=threads):
                    times = [results.get("cholmod/ready", order, t, n) for t in range(1, most + 1)]
                    return min(filter(None, times), default=None)
                value = {
                    "frame / Blender update": lambda: over(ours("frame"), results.get("blender/update", order, 0, size)),
                    "frame / CGAL iteration": lambda: over(ours("frame"), results.get("cgal/frame", order, 1, size)),
                    "solve / reading the factor twice":
                        lambda: over(ours("solve"), results.get("bound/read", order, threads, size)),
                    "region ready / CHOLMOD analyse + factor":
                        lambda: over(ours("ready"), cholmod()),
                    "region ready / CGAL preprocess":
                        lambda: over(ours("ready"), results.get("cgal/ready", order, 1, size)),
                    "first frame / CHOLMOD analyse + factor":
                        lambda: over(ours("hand"), cholmod()),
                    "first frame / drag frame": lambda: over(ours("hand_frame"), ours("frame")),
                    "second handle / region ready": lambda: over(ours("second_handle"), ours("ready")),
                    "second disc / region ready": lambda: over(ours("second_disc"), ours("ready")),
                    "memory / CHOLMOD's factor":
                        lambda: over(results.get("ours/ready", order, threads, size, "bytes"),
                                     8 * (results.get("cholmod/ready", order, threads, size, "nonzeros") or 0)),
                }[label]()
                values.append(value)
            if not any(values):
                continue
            row = [label + threads_text(threads)]
            judged = order == 1 and (threads == 2 or label not in ON_TWO_THREADS)
            for size, value in zip(results.sizes, values):
                target = next((limit for least, limit in reversed(targets) if size >= least), None)
                miss = judged and value is not None and target is not None and value > target
                missed += miss
                text = "-" if value is None else f"1/{number(1 / value)}" if value < 0.5 else number(value)
                row.append(f"**{text}**" if miss else text)
            row.append("; ".join((f"1/{round(1 / limit)}" if limit <= 0.5 else f"{limit:g}") +
                                 (f" from {least:,}" if least else "") for least, limit in targets) if judged else "")
            rows.append(row)
    return rows, missed


def coarse(results, order):
    """The frames of the cells against the full poses, per cent of the handle's way; those beyond their bound bold."""
    rows = []
    for label, key in (("RMS", "error"), ("largest", "largest")):
        cells = [results.cell("ours/hand_frame", order, 1, size) for size in results.sizes]
        texts = ["-" if "error" not in cell else number(100 * cell[key]) for cell in cells]
        rows.append([label] + [f"**{text}**" if key == "error" and "error" in cell and not cell["error"] <= cell["bound"]
                               else text for text, cell in zip(texts, cells)])
    return rows


def errors(results, order):
    rows = []
    for label, name, all_threads in TIMES:
        for threads in all_threads:
            cells = [results.cell(name, order, threads, size) for size in results.sizes]
            if name == "blender/base" or not any("error" in cell for cell in cells):
                continue
            rows.append([label + threads_text(threads)] +
                        [f"{cell['error']:.0e} ({cell['bound']:.0e})" if "error" in cell else "-" for cell in cells])
    return rows


def cpu_name():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor()


def main():
    results = Results(pathlib.Path(sys.argv[1]))
    context = results.context
    load = " ".join(number(value) for value in context.get("load_avg", []))
    print("# Speed\n")
    print(f"- machine: {cpu_name()}, {context['num_cpus']} cores, {platform.system()} {platform.release()}, "
          f"load at the last run's start {load}")
    print(f"- commit: {sys.argv[2]}; {context['date']}")
    print(f"- compiler: {context['compiler']}, flags `{context['flags'].strip()}`")
    print(f"- Eigen {context['Eigen']}, CHOLMOD {context['CHOLMOD']}, {context['BLAS']}, CGAL {context['CGAL']}"
          f"{', Blender ' + results.blender if results.blender else ''}\n")
    print("First frame: from the handle picked to a frame of the cells, before the region is ready; these frames are"
          " approximate. Region ready: to the first corrected frame. Irregular discs with detail; columns are region vertices. Milliseconds, median (minimum); the repetitions of all"
          " rows of a size and order are shuffled, Blender runs before and between them, and every frame has another target."
          " Growth is the exponent of n. CHOLMOD runs without its own OpenMP loops, which slow it down; ours with whatever"
          " a host has. Threads of a row are also those of BLAS.\n")
    sizes = [f"{size:,}" for size in results.sizes]
    for order in sorted({order for _, order, _ in results.cells}):
        print(f"## Order {order}\n")
        print(table(["ms", *sizes, "growth"], times(results, order)))
        rows, missed = ratios(results, order)
        print("Ratios of medians" + (f"; {missed} of them, in bold, miss their targets" if missed else "") + ":\n")
        print(table(["ratio", *sizes, "target" if order == 1 else ""], rows))
        print("Distance of the cells' frames from the plain path, per cent of the handle's displacement; RMS over the region at most 1:\n")
        print(table(["coarse against full", *sizes], coarse(results, order)))
        print("Largest error (bound). Frames of the cells: RMS, over the handle's displacement; first frame: of the handle alone. Poses: against the plain path, over the radius; the plain path and the solves:"
              " against an iteratively refined solution, over its largest entry; CGAL: constrained vertices against their"
              " places; Blender: the handle's distance from its target, over its displacement (soft constraints).\n")
        print(table(["error", *sizes], errors(results, order)))
    if results.refusals:
        print("Not measured (n/a):\n")
        for reason, places in results.refusals.items():
            print(f"- {reason}: {'; '.join(f'{name}, order {order}' for name, order in sorted(places))}")


main()
