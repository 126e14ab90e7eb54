#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Films a drag on all of a mesh of a million vertices in the real MeshLab window, in real time from the press on:
# build/window/million.gif, the one in the documents.
set -eu

cd "$(dirname "$0")/../.."
for tool in ffmpeg convert; do
  command -v "$tool" >/dev/null || { echo "window_film.sh: please install ffmpeg and ImageMagick" >&2; exit 1; }
done
window=$PWD/build/window
tests/scripts/stage_window.sh "$window/stage"
build/common/demo/make_mesh million "$window/million.ply"
LAPEDIT_STAGE=$window/stage tests/scripts/window_film.py "$window/million.ply" "$window/million.gif"
