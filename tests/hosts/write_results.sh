#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the recorded edits, whose coordinates are compared with other builds and with MeshLab, with this build's program.
#
# usage: write_results.sh PROGRAM GENERATED MESHES OUTPUT SCALAR
#   PROGRAM    laplacian-edit
#   GENERATED  folder with generated meshes, the same files for all builds
#   MESHES     folder with the real meshes; empty: their edits are skipped
#   OUTPUT     folder to make; an old one is replaced
#   SCALAR     float or double: the precision of the meshes
#
# The edits are edits/<mesh>/<name>.json. OUTPUT/meshes has the meshes as PLY files, OUTPUT/<mesh>/<name> three poses, of the
# fractions 0, 0.37 and 1, and a report.
set -eu

[ $# -eq 5 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
program=$1
output=$4
here=$(dirname "$0")

rm -rf "$output"
python3 "$here/ply_meshes.py" "$5" "$2" "$3" "$output/meshes"
count=0
for edit in "$here"/edits/*/*.json; do
  mesh=$(basename "$(dirname "$edit")")
  [ -e "$output/meshes/$mesh.ply" ] || continue
  results=$output/$mesh/$(basename "$edit" .json)
  mkdir -p "$results"
  "$program" --quiet --fractions 0,0.37,1 --report "$results/report.json" "$output/meshes/$mesh.ply" "$results/pose.ply" "$edit"
  count=$((count + 1))
done
echo "$count edits by $("$program" --version): $output"
