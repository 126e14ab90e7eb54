#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# One edit of all of a mesh of 1,008,200 vertices, and of one of 3,001,250, by laplacian-edit: prints rows of the table in
# common/docs/performance.md. One end of the plane is held, the other is lifted and turned. 10 GB of memory.
#
# usage: whole_mesh.sh [million|three_million]...   both by default
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build
place=$build/whole
[ $# -gt 0 ] || set -- million three_million

cmake -S . -B "$build" >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target laplacian_edit_program make_mesh >/dev/null
mkdir -p "$place"
for name in "$@"; do
  case $name in
  million) across=710 along=1420 ;;
  three_million) across=1225 along=2450 ;;
  esac
  end=$((across * along - 1))
  "$build/common/demo/make_mesh" "$name" "$place/$name.ply"
  cat >"$place/$name.json" <<EOF
{"laplacian_edit": 1, "steps": [{"region": {"component": true}, "handles": [
  {"vertices": "0-$((10 * across - 1))"},
  {"vertices": "$((end - 10 * across + 1))-$end", "translation": [0, 0, 1],
   "rotation": {"axis": [0, 1, 0], "degrees": -30}}]}]}
EOF
  python3 - "$build/filter_laplacian_edit/laplacian-edit" "$place/$name" <<'EOF'
import json
import resource
import subprocess
import sys
program, mesh = sys.argv[1:]
subprocess.run([program, "--quiet", "--report", f"{mesh}.report.json", f"{mesh}.ply", f"{mesh}.edited.ply", f"{mesh}.json"],
               check=True)
report = json.load(open(f"{mesh}.report.json"))
memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
times = report["milliseconds"]
print(f"| {report['mesh']['vertices']:,} | {times['read'] / 1e3:.1f} | {times['edit'] / 1e3:.1f} | {times['write'] / 1e3:.1f} "
      f"| {sum(times.values()) / 1e3:.1f} | {memory / 1e9:.1f} |")
EOF
done
