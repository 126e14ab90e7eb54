#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the plugin, edits a mesh with it in the real meshlabserver, and renders the mesh before and after.
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build
demo=$build/demo
scripts=$PWD/tests/scripts

"$scripts/install_dependencies.sh"
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi

echo "Building in $build"
mkdir -p "$demo/home"
{
  cmake -S . -B "$build" &&
    cmake --build "$build" --parallel "$(nproc)" --target filter_laplacian_edit make_mesh
} >"$demo/build.log" 2>&1 || { cat "$demo/build.log" >&2; exit 1; }

# A private copy of MeshLab with our plugin; the installed one is not touched.
tests/host/stage.sh "$demo/stage" "$build/filter_laplacian_edit/libfilter_laplacian_edit.so" "$(command -v meshlabserver)"
"$build/tests/demo/make_mesh" letters "$demo/before.ply"

# edit <name of an .mlx> <result>
edit() {
  rm -f "$2"
  if ! HOME=$demo/home XDG_RUNTIME_DIR=$demo/home xvfb-run -a "$demo/stage/bin/meshlabserver" \
    -i "$demo/before.ply" -o "$2" -s "tests/demo/$1.mlx" >"$demo/$1.log" 2>&1 || [ ! -f "$2" ]; then
    cat "$demo/$1.log" >&2
    exit 1
  fi
  echo
  echo "$1.mlx:"
  # meshlabserver prints the report twice: the second one is ours.
  sed -n '/^LOG: 2 /,/^Milliseconds: /{s/^LOG: 2 //;p}' "$demo/$1.log"
}
edit laplacian_edit "$demo/after.ply"
edit laplacian_edit_replay "$demo/after_replay.ply"

# render <after> <picture>
render() {
  xvfb-run -a "$scripts/render.py" "$2" --toward 0.15 -0.75 0.7 --height 340 \
    --panel "$demo/before.ply" before --panel "$1" after
}
render "$demo/after.ply" "$demo/before_after.png"
render "$demo/after_replay.ply" "$demo/before_after_replay.png"

echo
echo "Mesh before:                     $demo/before.ply"
echo "after Laplacian Edit:            $demo/after.ply"
echo "  picture before and after:      $demo/before_after.png"
echo "after Laplacian Edit Replay:     $demo/after_replay.ply"
echo "  picture before and after:      $demo/before_after_replay.png"
echo "The scripts that were run:       $PWD/tests/demo/*.mlx"
