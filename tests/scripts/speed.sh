#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Times region and drag against CGAL, Blender and plain CHOLMOD in one run, and makes a Markdown table of it.
#
# usage: speed.sh [--quick] [OUTPUT]   OUTPUT: build/speed/speed.md by default
# --quick: regions up to 12,774 vertices and few rounds. Ends with 1 when a result is outside its bound.
# SPEED_SIZES, SPEED_SIZES_2: regions' vertices, for order 1 and for order 2. SPEED_SIZES_HAND: those of order 2 for which
# there is no factor, where only first frames are timed. SPEED_BLENDER: the largest region that Blender gets.
set -eu

quick=
if [ "${1:-}" = --quick ]; then
  quick=$1
  shift
fi
here=$PWD
cd "$(dirname "$0")/../.."
build=$PWD/build/speed
case ${1:-} in
  "") output=$build/speed.md ;;
  /*) output=$1 ;;
  *) output=$here/$1 ;;
esac

missing=
for package in g++ cmake make python3 libeigen3-dev nlohmann-json3-dev libsuitesparse-dev libopenblas-dev libbenchmark-dev libcgal-dev \
  blender; do
  # shellcheck disable=SC2016
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
if [ -n "$missing" ]; then
  echo "speed.sh: please install what is missing here: apt install$missing" >&2
  exit 1
fi

sizes="1201 3395 4685 12774"
sizes_2=$sizes
sizes_hand=
blender_largest=${SPEED_BLENDER-100000}
if [ -z "$quick" ]; then
  sizes="$sizes 16792 32280 100000 300000 1000000"
  # From here on a factor of order 2 takes gigabytes, and the system is beyond double precision.
  sizes_2="$sizes_2 16792 32280 100000"
  sizes_hand="300000 1000000"
fi
sizes=${SPEED_SIZES-$sizes}
sizes_2=${SPEED_SIZES_2-$sizes_2}
sizes_hand=${SPEED_SIZES_HAND-$sizes_hand}

cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_BUILD_BENCHMARKS=ON \
  -DLAPEDIT_WITH_MESHLAB=OFF >/dev/null
cmake --build "$build" --parallel "$(nproc)" --target speed_bench >/dev/null
bench=$build/tests/bench/speed_bench
results=$build/results
rm -rf "$results"
mkdir -p "$results"
failed=0

# OpenBLAS takes its oldest kernels for a processor that is newer than itself; CHOLMOD gets the best that run here.
if [ -z "${OPENBLAS_CORETYPE:-}" ]; then
  flags=$(grep -m1 '^flags' /proc/cpuinfo || true)
  case $flags in
    *avx512bw*avx512vl*) export OPENBLAS_CORETYPE=SkylakeX ;;
    *" avx2 "*) export OPENBLAS_CORETYPE=Haswell ;;
  esac
fi

# blender_round VERTICES ROUND
blender_round() {
  [ "$1" -le "$blender_largest" ] || return 0
  # A spinning OpenMP thread would slow it tenfold as soon as something else runs.
  OMP_WAIT_POLICY=passive HOME=$results blender -b --factory-startup -noaudio --python-exit-code 1 \
    --python tests/bench/blender_laplacian.py -- "$results/scene.bin" "$results/blender_$1_$2.json" \
    >"$results/blender.log" 2>&1 </dev/null || { cat "$results/blender.log" >&2; failed=1; }
}

# ours VERTICES ORDER [OPTION]
ours() {
  status=0
  # shellcheck disable=SC2086
  "$bench" --vertices="$1" --order="$2" $quick ${3:-} --benchmark_out="$results/ours_$1_$2.json" \
    >"$results/bench.log" 2>"$results/bench.err" || status=$?
  if [ "$status" -ne 0 ]; then
    echo "$1 vertices, order $2: speed_bench ended with $status" >&2
    sort -u "$results/bench.err" | grep -v WARNING >&2 || true
    failed=1
  fi
  # 1 is a result outside its bound; with anything else the file is not whole.
  [ "$status" -le 1 ] || rm -f "$results/ours_$1_$2.json"
}

for vertices in $sizes; do
  echo "$vertices vertices"
  "$bench" --vertices="$vertices" --export="$results/scene.bin" 2>/dev/null
  blender_round "$vertices" 1
  ours "$vertices" 1
  blender_round "$vertices" 2
  case " $sizes_2 " in
    *" $vertices "*) ours "$vertices" 2 ;;
  esac
done
for vertices in $sizes_hand; do
  echo "$vertices vertices, order 2, first frame"
  ours "$vertices" 2 --hand
done
rm -f "$results/scene.bin"

commit=$(git rev-parse --short HEAD 2>/dev/null || echo unknown)
[ -z "$(git status --porcelain 2>/dev/null)" ] || commit="$commit, with changes"
mkdir -p "$(dirname "$output")"
tests/bench/table.py "$results" "$commit" >"$output"
echo "$output"
[ "$failed" -eq 0 ] || { echo "speed.sh: a result is outside its bound or could not be had, see above" >&2; exit 1; }
