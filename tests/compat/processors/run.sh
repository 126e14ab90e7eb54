#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the core for another processor or compiler and runs its tests there; for another processor also the program, and compares
# the coordinates of the recorded edits with those of this build. python.linux-x86_64 compares those of a build with libc++.
#
# usage: run.sh WHAT BUILD RESULTS [LAYER]...
#   WHAT      arm64: under qemu; libc++: clang with libc++
#   BUILD     this machine's build folder, with tests
#   RESULTS   what hosts/write_results.sh made with it
#   LAYER     whose tests run: base, mesh, linear, deform, cells, edit, live, session, json
set -eu

[ $# -ge 3 ] || { sed -n '/^# usage/,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
what=$1
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$2" && pwd)
results=$(cd "$3" && pwd)
shift 3
folder=$build/processors/$what
mkdir -p "$folder/packages"

# Packages of headers alone, apart from this system's own headers.
for name in Eigen3:Eigen3::Eigen:eigen3 nlohmann_json:nlohmann_json::nlohmann_json:nlohmann; do
  package=${name%%:*}
  target=${name#*:}
  target=${target%:*}
  headers=${name##*:}
  mkdir -p "$folder/packages/$package"
  ln -sfn "/usr/include/$headers" "$folder/packages/$package/$headers"
  include=$folder/packages/$package
  [ "$package" != Eigen3 ] || include=$include/eigen3
  printf 'add_library(%s INTERFACE IMPORTED)\ntarget_include_directories(%s INTERFACE "%s")\nset(%s_VERSION 3.9)\n' \
    "$target" "$target" "$include" "$package" >"$folder/packages/$package/${package}Config.cmake"
  printf 'set(PACKAGE_VERSION 3.9)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n' \
    >"$folder/packages/$package/${package}ConfigVersion.cmake"
done

set -- "$@"
layers=$*
emulator=
case $what in
arm64)
  set -- -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ \
    -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc
  emulator='qemu-aarch64-static;-L;/usr/aarch64-linux-gnu'
  ;;
libc++) set -- -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_FLAGS=-stdlib=libc++ ;;
*) echo "run.sh: $what is unknown." >&2 && exit 2 ;;
esac
# Coordinates hardly depend on it, and compiling takes most of the time.
set -- "$@" '-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG'
[ -z "$emulator" ] || set -- "$@" "-DCMAKE_CROSSCOMPILING_EMULATOR=$emulator"
! command -v ccache >/dev/null || set -- "$@" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache
generator=
! command -v ninja >/dev/null || generator=-GNinja

targets=laplacian_edit_program
[ "$what" != libc++ ] || targets= # it cannot read numbers as the program does before version 20
for layer in $layers; do
  targets="$targets ${layer}_tests"
done
if [ -n "$layers" ] && [ ! -d "$folder/gtest/lib" ]; then
  cmake ${generator:+"$generator"} -S /usr/src/googletest -B "$folder/gtest-build" -DBUILD_GMOCK=OFF \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$folder/gtest" "$@" >"$folder/log" 2>&1 &&
    cmake --build "$folder/gtest-build" --target install >>"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
fi
# shellcheck disable=SC2086
cmake ${generator:+"$generator"} -S "$here/../../.." -B "$folder/build" "$@" -DLAPEDIT_BUILD_TESTS=ON \
  -DLAPEDIT_WITH_MESHLAB=OFF -DLAPEDIT_WARNINGS_AS_ERRORS=ON -DCMAKE_DISABLE_FIND_PACKAGE_CHOLMOD=ON \
  -DEigen3_DIR="$folder/packages/Eigen3" -Dnlohmann_json_DIR="$folder/packages/nlohmann_json" \
  -DGTest_ROOT="$folder/gtest" >"$folder/log" 2>&1 &&
  cmake --build "$folder/build" --target $targets >>"$folder/log" 2>&1 || { tail -n 60 "$folder/log" >&2; exit 1; }

excluded='*/*' # suites with parameters
# The demonstration's bodies take a quarter of an hour under an emulator, and are not the core's.
[ "$what" != arm64 ] || excluded="$excluded:Bodies.*"
for layer in $layers; do
  # shellcheck disable=SC2086
  $(echo "$emulator" | tr ';' ' ') "$folder/build/tests/unit/${layer}_tests" --gtest_brief=1 --gtest_filter="-$excluded"
done

[ -n "$emulator" ] || exit 0
rm -rf "$folder/poses"
cd "$results/meshes"
for edit in "$here"/../edits/*/*.json; do
  mesh=$(basename "$(dirname "$edit")")
  [ -e "$mesh.ply" ] || continue
  poses=$folder/poses/$mesh/$(basename "$edit" .json)
  mkdir -p "$poses"
  # shellcheck disable=SC2086
  $(echo "$emulator" | tr ';' ' ') "$folder/build/common/cli/laplacian-edit" --quiet --fractions 0,0.37,1 "$mesh.ply" "$poses/pose.ply" - <"$edit"
done
"$here/../compare.py" "$results" "$folder/poses"
