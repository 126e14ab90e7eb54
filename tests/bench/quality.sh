#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures the shape of edits and compares it with CGAL's ARAP and SR-ARAP, Blender and libigl, in one run: a Markdown table,
# all figures as JSON, and one picture for each edit with the methods side by side.
#
# usage: quality.sh [OPTION of quality.py]...   for example --edits limb_90,bunny_group, or
#                                               --ours 'NAME={"laplacian": "cotangent", "iterations": 3}'
# QUALITY_OUTPUT: folder of quality.md, quality.json and the pictures; build/quality/result by default.
# LIBIGL_INCLUDE_DIR: folder of libigl's headers. Debian has no package of it, but MeshLab's source in Debian 13 carries
# it, and that is fetched where this is not set.
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build/quality
output=${QUALITY_OUTPUT:-$build/result}
meshes=${LAPEDIT_MESHES:-$PWD/../shared/meshes}
libigl=${LIBIGL_INCLUDE_DIR:-$build/libigl}

common/scripts/install_dependencies.sh bench
if [ ! -f "$meshes/mannequin.off" ]; then
  echo "quality.sh: LAPEDIT_MESHES does not name the real meshes, so their edits are left out." >&2
  meshes=
fi
if command -v blender >/dev/null; then
  set -- --blender "$@"
else
  echo "quality.sh: Blender is not installed and is left out." >&2
fi

fetch_libigl() {
  mkdir -p "$libigl"
  common/scripts/debian_download.sh trixie "$build/meshlab" src:meshlab &&
    tar -xf "$build"/meshlab/*.orig.tar.* -C "$libigl" --strip-components=5 --wildcards '*/src/external/libigl-*/include/igl'
}
if [ ! -f "$libigl/igl/arap.h" ] && { [ -n "${LIBIGL_INCLUDE_DIR:-}" ] || ! fetch_libigl; }; then
  echo "quality.sh: libigl's headers are not in $libigl, so it is left out." >&2
  libigl=
fi
[ -z "$libigl" ] || set -- --libigl "$@"

cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_BUILD_BENCHMARKS=ON \
  -DLIBIGL_INCLUDE_DIR="$libigl" >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target quality_bench make_mesh >/dev/null
rm -rf "$output"
mkdir -p "$output"

commit=$(git rev-parse --short HEAD 2>/dev/null || echo unknown)
[ -z "$(git status --porcelain 2>/dev/null)" ] || commit="$commit, with changes"
{
  echo "Commit $commit, $(c++ --version | sed -n 1p), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | sed -n 1p), $(nproc) cores."
  echo
  python3 tests/bench/quality.py --program "$build/tests/bench/quality_bench" --make-mesh "$build/common/demo/make_mesh" \
    ${meshes:+--meshes "$meshes"} --json "$output/quality.json" --pictures "$output" "$@"
} >"$output/quality.md"
echo "$output/quality.md"
