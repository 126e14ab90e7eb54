#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Times region and drag against CGAL and CHOLMOD in one run, and prints Markdown tables.
#
# usage: speed.sh [--quick] [SIZE...]   sizes: region vertices. --quick: regions up to 12,774 vertices and few rounds
# Ends with 1 if a result is outside its bound.
set -eu

quick=
if [ "${1:-}" = --quick ]; then
  quick=$1
  shift
fi
cd "$(dirname "$0")/../.."
build=$PWD/build/speed

common/scripts/install_dependencies.sh bench
if [ $# -eq 0 ]; then
  set -- 3395 4685 12774
  [ -n "$quick" ] || set -- "$@" 16792 32280 100000 300000
fi

cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_BUILD_BENCHMARKS=ON \
  -DLAPEDIT_WITH_MESHLAB=OFF >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target speed_bench >/dev/null

# OpenBLAS takes its oldest kernels for a processor that is newer than itself; CHOLMOD gets the best that run here.
if [ -z "${OPENBLAS_CORETYPE:-}" ]; then
  flags=$(grep -m1 '^flags' /proc/cpuinfo || true)
  case $flags in
    *avx512bw*avx512vl*) export OPENBLAS_CORETYPE=SkylakeX ;;
    *" avx2 "*) export OPENBLAS_CORETYPE=Haswell ;;
  esac
fi
commit=$(git rev-parse --short HEAD 2>/dev/null || echo unknown)
[ -z "$(git status --porcelain 2>/dev/null)" ] || commit="$commit, with changes"
echo "Commit $commit, $(sed -n 's/^model name.*: //p' /proc/cpuinfo | sed -n 1p), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg)."
# shellcheck disable=SC2086
exec "$build/tests/bench/speed_bench" $quick "$@"
