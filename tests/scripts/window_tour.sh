#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the README's animated picture in the real MeshLab window: an arm raised about its shoulder, a nose pulled, undo,
# saved and replayed: build/window/tour.gif.
set -eu

cd "$(dirname "$0")/../.."
command -v convert >/dev/null || { echo "window_tour.sh: please install ImageMagick" >&2; exit 1; }
window=$PWD/build/window
if [ -z "${LAPEDIT_STAGE:-}" ]; then
  tests/scripts/stage_window.sh "$window/stage"
  export LAPEDIT_STAGE="$window/stage"
fi
build/common/demo/make_mesh person "$window/person.ply"
tests/scripts/window_tour.py "$window/person.ply" "$window/tour.gif"
echo "Picture: $window/tour.gif"
