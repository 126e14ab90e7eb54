#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Drags in the real MeshLab window and keeps screenshots of region, drag and result, and an animated picture, in
# build/window.
#
# usage: window_pictures.sh [NAME...]   scenes as in window_pictures.py, all by default
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
set -eu

command -v convert >/dev/null || { echo "window_pictures.sh: please install ImageMagick, for the animation" >&2; exit 1; }
cd "$(dirname "$0")/../.."
window=$PWD/build/window
meshes=${LAPEDIT_MESHES:-$PWD/../shared/meshes}

tests/scripts/stage_window.sh "$window/stage"
build/common/demo/make_mesh arm "$window/limb.ply"
if [ -d "$meshes" ]; then
  set -- --meshes "$meshes" "$@"
fi
LAPEDIT_STAGE=$window/stage tests/scripts/window_pictures.py --limb "$window/limb.ply" --output "$window" "$@"
echo "Pictures: $window"
