#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the pictures of hover, gizmo, handle groups and three tasks in the real MeshLab window, in build/window/stills.
#
# LAPEDIT_STAGE: another version's, already made, in place of this one's.
set -eu

command -v convert >/dev/null || { echo "window_stills.sh: please install ImageMagick" >&2; exit 1; }
cd "$(dirname "$0")/../.."
window=$PWD/build/window
if [ -z "${LAPEDIT_STAGE:-}" ]; then
  tests/scripts/stage_window.sh "$window/stage"
  export LAPEDIT_STAGE="$window/stage"
fi
mkdir -p "$window/stills"
for mesh in head creature hand person; do
  [ -e "$window/stills/$mesh.ply" ] || build/common/demo/make_mesh $mesh "$window/stills/$mesh.ply"
done
tests/scripts/window_stills.py "$window/stills"
echo "Pictures: $window/stills"
