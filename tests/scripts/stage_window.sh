#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the plugins and puts them, with the driver of the window's tests, into a private copy of MeshLab.
#
# usage: stage_window.sh STAGE
set -eu

stage=$1
cd "$(dirname "$0")/../.."
build=$PWD/build

common/scripts/install_dependencies.sh tests
cmake -S . -B "$build" -DLAPEDIT_BUILD_TESTS=ON >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target edit_laplacian_drag filter_laplacian_edit gui_driver make_mesh >/dev/null
mkdir -p "$(dirname "$stage")"
common/demo/stage.sh "$stage" "$build/edit_laplacian_drag/libedit_laplacian_drag.so" \
  "$build/filter_laplacian_edit/libfilter_laplacian_edit.so" "$build/tests/gui/driver/libgui_driver.so" \
  "$(command -v meshlab)" "$(command -v meshlabserver)"
