#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures frames of a drag in the real MeshLab window, by the tool's own clock, and prints a Markdown table.
#
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project. igea.ply is used.
set -eu

cd "$(dirname "$0")/../.."
window=$PWD/build/window
tests/scripts/stage_window.sh "$window/stage"
LAPEDIT_STAGE=$window/stage tests/scripts/window_frames.py "${LAPEDIT_MESHES:-$PWD/../shared/meshes}/igea.ply"
