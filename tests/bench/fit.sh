#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures fits of a template to scans whose true correspondence is known, and compares them with MeshMonk 0.3, in
# one run: a Markdown table and all figures as JSON. It is installed from PyPI into a virtual environment outside of the
# repository.
#
# usage: fit.sh [OPTION of fit.py]...   for example --cases head, --no-peers
#        fit.sh --kinds 1            the table of kinds in common/docs/fit.md, with cases of the seed 1
#        fit.sh --picture common/docs/pictures/fit.png   (needs an X server, ImageMagick and python3-vtk9)
# FIT_OUTPUT: folder of fit.md and fit.json; build/fit by default.
# FIT_PYTHON: folder of the virtual environment; ~/.cache/laplacian-edit-fit by default.
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build
output=${FIT_OUTPUT:-$build/fit}
python=${FIT_PYTHON:-$HOME/.cache/laplacian-edit-fit}
meshes=${LAPEDIT_MESHES:-$PWD/../shared/meshes}

if [ ! -x "$python/bin/python" ]; then
  python3 -m venv "$python"
  "$python/bin/pip" --quiet install numpy scipy 'meshmonk==0.3.0'
fi
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build" --target laplacian_edit_program make_mesh >/dev/null
mkdir -p "$output"
exec "$python/bin/python" tests/bench/fit.py --program "$build/common/cli/laplacian-edit" \
  --make-mesh "$build/common/demo/make_mesh" --meshes "$meshes" --output "$output" "$@"
