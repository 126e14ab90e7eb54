#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the edits that are compared across hosts, with this host's laplacian-edit.
#
# usage: write_results.sh PROGRAM GENERATED MESHES OUTPUT
#   PROGRAM    laplacian-edit
#   GENERATED  folder with generated meshes, the same files for all hosts
#   MESHES     folder with the real meshes; empty: their edits are left out
#   OUTPUT     folder to make; an old one is replaced
#
# The edits are edits/<mesh>/<name>.json. Each gives three meshes, of fractions 0 (what the host reads), 0.37 and 1, and a
# report.
set -eu

[ $# -eq 4 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
program=$1
generated=$2
meshes=$3
output=$4
edits=$(dirname "$0")/edits

rm -rf "$output"
count=0
for edit in "$edits"/*/*.json; do
  mesh=$(basename "$(dirname "$edit")")
  if [ -e "$generated/$mesh" ]; then
    path=$generated/$mesh
  elif [ -n "$meshes" ]; then
    path=$meshes/$mesh
  else
    continue
  fi
  results=$output/$mesh/$(basename "$edit" .json)
  mkdir -p "$results"
  "$program" --quiet --fractions 0,0.37,1 --report "$results/report.json" "$path" "$results/pose.ply" "$edit"
  count=$((count + 1))
done
echo "$count edits by $("$program" --version): $output"
