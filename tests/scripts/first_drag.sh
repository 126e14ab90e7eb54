#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Presses, drags and releases once, with untouched defaults, on nine generated meshes in the real MeshLab window, and makes a
# contact sheet of it, each row before | during | after: build/window/first_drag.png.
#
# usage: first_drag.sh [NAME...]   scenes as in first_drag.py, all by default
# LAPEDIT_STAGE, LAPEDIT_COMMAND: another version's, already made, in place of this one's.
set -eu

command -v montage >/dev/null || { echo "first_drag.sh: please install ImageMagick, for the sheets" >&2; exit 1; }
cd "$(dirname "$0")/../.."
window=$PWD/build/window

if [ -z "${LAPEDIT_STAGE:-}" ]; then
  tests/scripts/stage_window.sh "$window/stage"
  cmake --build build --target laplacian_edit_program >/dev/null
  export LAPEDIT_STAGE="$window/stage" LAPEDIT_COMMAND="$PWD/build/filter_laplacian_edit/laplacian-edit"
fi
mkdir -p "$window/first_drag"
for mesh in head creature hand terrain plate letters; do
  build/common/demo/make_mesh $mesh "$window/first_drag/$mesh.ply"
done
tests/scripts/first_drag.py "$window/first_drag" "$@"
echo "Pictures: $window"
