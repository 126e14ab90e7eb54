#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures the shape of edits beside CGAL's ARAP and SR-ARAP and Blender in one run: a Markdown table with the bars that
# we set ourselves, all figures as JSON, and one picture for each edit with the methods side by side.
#
# usage: quality.sh [OPTION of quality_bench]...   for example --quick, --edits limb_90,bunny_group, or
#                                                  --ours NAME=laplacian=cotangent,iterations=3
# QUALITY_OUTPUT: folder of quality.md, quality.json and the pictures; build/quality/result by default.
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build/quality
output=${QUALITY_OUTPUT:-$build/result}
meshes=${LAPEDIT_MESHES:-$PWD/../shared/meshes}

missing=
for package in g++ cmake libeigen3-dev nlohmann-json3-dev libsuitesparse-dev libopenblas-dev libbenchmark-dev libcgal-dev; do
  # shellcheck disable=SC2016
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
if [ -n "$missing" ]; then
  echo "quality.sh: please install what is missing here: apt install$missing" >&2
  exit 1
fi
if [ ! -f "$meshes/mannequin.off" ]; then
  echo "quality.sh: LAPEDIT_MESHES does not name the real meshes, so their edits are left out." >&2
  meshes=
fi
if command -v blender >/dev/null; then
  set -- --blender "$@"
else
  echo "quality.sh: Blender is not installed and is left out." >&2
fi

cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_BUILD_BENCHMARKS=ON \
  -DLAPEDIT_MESHES="$meshes" >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target quality_bench >/dev/null
rm -rf "$output"
mkdir -p "$output/meshes"

commit=$(git rev-parse --short HEAD 2>/dev/null || echo unknown)
[ -z "$(git status --porcelain 2>/dev/null)" ] || commit="$commit, with changes"
{
  echo "Commit $commit, $(c++ --version | sed -n 1p), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | sed -n 1p), $(nproc) cores."
  echo
  "$build/tests/bench/quality_bench" --json "$output/quality.json" --out "$output/meshes" "$@"
} >"$output/quality.md"
echo "$output/quality.md"

if command -v xvfb-run >/dev/null && /usr/bin/python3 -c 'import vtkmodules' 2>/dev/null; then
  xvfb-run -a tests/bench/quality_pictures.py "$output/meshes" --json "$output/quality.json" --output "$output"
else
  echo "quality.sh: no pictures without the packages xvfb and python3-vtk9." >&2
fi
