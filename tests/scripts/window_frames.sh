#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures drags in the real MeshLab window, by the tool's own clock, and prints a Markdown table: milliseconds from the
# press to the first picture that shows a moved surface, while the mouse goes on 60 times a second, and of the frames after it.
#
# usage: window_frames.sh [BEFORE]   BEFORE: another version's folder, built there (build/), to be compared with this one
#        window_frames.sh handles    drags of curves and several handles on a generated sheet
#        window_frames.sh events     milliseconds that the window handles an event, 800,000 vertices and four layers
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project. igea.ply is used.
# WINDOW_ROUNDS: how often each version has its turn, 3 by default.
set -eu

handles=
if [ "${1:-}" = handles ] || [ "${1:-}" = events ]; then
  handles=$1
  shift
fi
before=${1:+$(realpath "$1")}
cd "$(dirname "$0")/../.."
build=$PWD/build
window=$build/window
tests/scripts/stage_window.sh "$window/stage"
if [ "$handles" = events ]; then
  LAPEDIT_STAGE=$window/stage exec tests/scripts/window_events.py
elif [ -n "$handles" ]; then
  LAPEDIT_STAGE=$window/stage exec tests/scripts/window_frames.py handles
fi
set -- "this=$window/stage"
if [ -n "$before" ]; then
  # With this version's driver: it asks the tool for properties only.
  common/demo/stage.sh "$window/before" "$before/build/edit_laplacian_drag/libedit_laplacian_drag.so" \
    "$before/build/filter_laplacian_edit/libfilter_laplacian_edit.so" "$build/tests/gui/driver/libgui_driver.so" \
    "$(command -v meshlab)" "$(command -v meshlabserver)"
  set -- "before=$window/before" "$@"
fi
tests/scripts/window_frames.py "${LAPEDIT_MESHES:-$PWD/../shared/meshes}/igea.ply" "$@"
