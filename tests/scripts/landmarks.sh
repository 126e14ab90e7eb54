#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Fits 300 landmarks on generated heads whose true warp is known, by the program, CGAL's ARAP and SciPy's thin-plate spline in
# one run, and prints a Markdown table of errors, residuals and times.
#
# usage: landmarks.sh [LANDMARKS]   300 by default
# PYTHON: an interpreter with NumPy and SciPy; python3 by default (Debian: python3-scipy)
set -eu

cd "$(dirname "$0")/../.."
build=$PWD/build/landmarks
python=${PYTHON:-python3}
if ! "$python" -c 'import numpy, scipy' 2>/dev/null; then
  echo "landmarks.sh: please install python3-scipy, or set PYTHON to an interpreter with NumPy and SciPy" >&2
  exit 1
fi
if [ ! -f /usr/include/CGAL/version.h ]; then
  echo "landmarks.sh: please install libcgal-dev, libsuitesparse-dev and libopenblas-dev" >&2
  exit 1
fi
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_BUILD_BENCHMARKS=ON >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target landmark_peer laplacian_edit_program make_mesh >/dev/null
exec "$python" tests/bench/landmark_bench.py "$build" "${1:-300}"
