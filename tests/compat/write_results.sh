#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the recorded edits, whose coordinates are compared with other builds, with this build's program, in double precision.
#
# usage: write_results.sh PROGRAM GENERATED MESHES OUTPUT
#   PROGRAM    laplacian-edit
#   GENERATED  folder with generated meshes, the same files for all builds
#   MESHES     folder with the real meshes; empty: their edits are skipped
#   OUTPUT     folder to make; an old one is replaced
#
# The edits are edits/<mesh>/<name>.json. OUTPUT/meshes has the meshes as PLY files, OUTPUT/<mesh>/<name> three poses, of the
# fractions 0, 0.37 and 1. A fit takes one of the poses as its scan.
set -eu

[ $# -eq 4 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
program=$(realpath "$1")
here=$(cd "$(dirname "$0")" && pwd)

rm -rf "$4"
python3 "$here/ply_meshes.py" double "$2" "$3" "$4/meshes"
cd "$4/meshes"
count=0
for edit in "$here"/edits/*/*.json; do
  mesh=$(basename "$(dirname "$edit")")
  [ -e "$mesh.ply" ] || continue
  results=../$mesh/$(basename "$edit" .json)
  mkdir -p "$results"
  # Names of scans in the standard input are relative to this folder.
  "$program" --quiet --fractions 0,0.37,1 "$mesh.ply" "$results/pose.ply" - <"$edit"
  count=$((count + 1))
done
echo "$count edits by $("$program" --version): $4"
