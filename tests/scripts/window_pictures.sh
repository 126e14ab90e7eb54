#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the documents' pictures of the real MeshLab window (stills) and the README's animated picture (tour), in
# build/window. The plugins are put, with the driver of the window's tests, into a private copy of MeshLab.
#
# usage: window_pictures.sh [stills|tour]...   both by default
# LAPEDIT_STAGE: another version's copy, already made, in place of this one's.
set -eu

command -v convert >/dev/null || { echo "window_pictures.sh: please install ImageMagick" >&2; exit 1; }
cd "$(dirname "$0")/../.."
build=$PWD/build
if [ -z "${LAPEDIT_STAGE:-}" ]; then
  common/scripts/install_dependencies.sh tests
  cmake -S . -B "$build" -DLAPEDIT_BUILD_TESTS=ON >/dev/null
  cmake --build "$build" --parallel "$(nproc)" --target edit_laplacian_drag filter_laplacian_edit gui_driver make_mesh >/dev/null
  export LAPEDIT_STAGE="$build/window/stage"
  mkdir -p "$build/window"
  common/demo/stage.sh "$LAPEDIT_STAGE" "$build/edit_laplacian_drag/libedit_laplacian_drag.so" \
    "$build/filter_laplacian_edit/libfilter_laplacian_edit.so" "$build/tests/gui/driver/libgui_driver.so" \
    "$(command -v meshlab)" "$(command -v meshlabserver)"
fi
for mesh in head creature hand person; do
  "$build/common/demo/make_mesh" $mesh "$build/window/$mesh.ply"
done
for what in ${*:-stills tour}; do
  "tests/scripts/window_$what.py" "$build/window"
done
