#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the figures and the table of the paper's evaluation anew, into build/paper: those of common/docs/paper.md.
#
# usage: paper.sh [NAME...]   figure_1, figure_2, figure_4 to figure_8, table_1; all by default
#
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build
meshes=${LAPEDIT_MESHES:-$PWD/../shared/meshes}

common/scripts/install_dependencies.sh pictures
cmake -S . -B "$build" >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target laplacian_edit_program make_mesh >/dev/null
if [ -d "$meshes" ]; then
  set -- --meshes "$meshes" "$@"
fi
exec xvfb-run -a tests/scripts/paper.py --command "$build/filter_laplacian_edit/laplacian-edit" \
  --make-mesh "$build/common/demo/make_mesh" --output "$build/paper" "$@"
