#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of what the tool shows in the real MeshLab window, one per thing that it is to show: build/window/lines.
#
# usage: window_lines.sh [NAME...]   as in window_lines.py, all by default
# LAPEDIT_STAGE: another version's, already made, in place of this one's.
set -eu

command -v convert >/dev/null || { echo "window_lines.sh: please install ImageMagick" >&2; exit 1; }
cd "$(dirname "$0")/../.."
window=$PWD/build/window
if [ -z "${LAPEDIT_STAGE:-}" ]; then
  tests/scripts/stage_window.sh "$window/stage"
  export LAPEDIT_STAGE="$window/stage"
fi
mkdir -p "$window/lines"
for mesh in head creature hand terrain million; do
  [ -e "$window/lines/$mesh.ply" ] || build/common/demo/make_mesh $mesh "$window/lines/$mesh.ply"
done
tests/scripts/window_lines.py --generated "$window/lines" --output "$window/lines" "$@"
echo "Pictures: $window/lines"
