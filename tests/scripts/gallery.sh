#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Renders edits with each method beside each other into build/gallery, and prints their stretch as a table.
#
# usage: gallery.sh [--columns N] [--height PIXELS] [NAME...]   names of edits as in gallery.py, all by default
#        gallery.sh paper [NAME...]   the figures and the table of common/docs/paper.md, into build/paper; names: figure_1,
#                                     figure_2, figure_4 to figure_8, table_1
#
# The pictures of the limb in common/docs/method.md: gallery.sh --columns 4 --height 300 limb-170; gallery.sh cells --height 300;
# of the operator: gallery.sh --surface --height 300
#
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build
meshes=${LAPEDIT_MESHES:-$PWD/../shared/meshes}

common/scripts/install_dependencies.sh pictures
cmake -S . -B "$build" >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target laplacian_edit_program make_mesh >/dev/null
what=gallery
if [ "${1-}" = paper ]; then
  shift
  what=paper
elif [ "${1-}" = cells ]; then
  shift
  cmake -S . -B "$build" -DLAPEDIT_BUILD_TESTS=ON >/dev/null
  cmake --build "$build" --parallel "$(nproc)" --target cell_colours >/dev/null
  set -- --cell-colours "$build/tests/cell_colours" "$@"
fi
if [ -d "$meshes" ]; then
  set -- --meshes "$meshes" "$@"
fi
exec xvfb-run -a "tests/scripts/$what.py" --command "$build/filter_laplacian_edit/laplacian-edit" \
  --make-mesh "$build/common/demo/make_mesh" --output "$build/$what" "$@"
