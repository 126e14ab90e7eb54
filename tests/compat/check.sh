#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds both plugins, the program and their tests in another Debian release, with warnings as errors, and runs them with its
# MeshLab.
#
# usage: check.sh SUITE [RESULTS GENERATED]
#   SUITE      bookworm, trixie, sid
#   RESULTS    where write_results.sh puts what it makes on this host, after the tests
#   GENERATED  its folder of generated meshes
#
# LAPEDIT_MESHES: folder of the real meshes; without it their tests are left out.
# LAPEDIT_TEST_CORE: OFF leaves out what is the same on every host: the tests of core, program, documents and layers.
# LAPEDIT_HOSTS_DIR: as for root.sh. The build is kept in the root, in /build, and the compiler's cache beside it.
set -euo pipefail

[ $# -eq 1 ] || [ $# -eq 3 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
suite=$1
# shellcheck source-path=SCRIPTDIR
. "$(dirname "$(realpath "$0")")/build_root.sh" "$suite"
if [ $# -eq 3 ]; then
  mkdir -p "$2"
  rm -rf "${2:?}/$suite"
  options+=(--bind "$2=/results" --bind-ro "$3=/generated")
fi
# Of the random events a part, as they take minutes; all of them are for the sanitizers.
options+=(--env "LAPEDIT_TEST_CORE=${LAPEDIT_TEST_CORE:-ON}" --env "LAPEDIT_RANDOM_EVENTS=${LAPEDIT_RANDOM_EVENTS:-2000}")

echo "== $suite: build"
# shellcheck disable=SC2016
"${root_sh[@]}" run "$root" "${options[@]}" -- sh -euc '
  mkdir -p /build
  cmake -G Ninja -S /src -B /build -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_WARNINGS_AS_ERRORS=ON -DCMAKE_UNITY_BUILD=ON \
    -DLAPEDIT_TEST_CORE="$LAPEDIT_TEST_CORE" -DLAPEDIT_MESHES="$LAPEDIT_MESHES" >/build/configure.log 2>&1 || { cat /build/configure.log; exit 1; }
  grep -E "MeshLab|GNU" /build/configure.log || true
  ninja -C /build >/build/build.log 2>&1 || { grep -A 12 FAILED /build/build.log || tail -n 40 /build/build.log; exit 1; }
  tail -n 1 /build/build.log'

echo "== $suite: tests"
status=0
# shellcheck disable=SC2016
"${root_sh[@]}" run "$root" "${options[@]}" -- sh -euc '
  others="python|processors"
  [ "$LAPEDIT_TEST_CORE" = ON ] || others="$others|command"
  # Those of the window wait half of the time.
  ctest --test-dir /build --output-on-failure --no-tests=error --exclude-regex "^($others)\\." --parallel "$(($(nproc) * 3 / 2))"' || status=$?

if [ $# -eq 3 ]; then
  echo "== $suite: results"
  # shellcheck disable=SC2016
  "${root_sh[@]}" run "$root" "${options[@]}" -- sh -euc '
    /src/tests/compat/write_results.sh /build/common/cli/laplacian-edit /generated "$LAPEDIT_MESHES" \
      "/results/$0"' "$suite" || status=$?
fi
[ "$status" -eq 0 ] || echo "$suite: failed, see above" >&2
exit "$status"
