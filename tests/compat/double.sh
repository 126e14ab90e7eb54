#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds sid's MeshLab with coordinates in double precision, as PyMeshLab has it, as far as filters need it; builds this
# project against that, with warnings as errors; and runs the tests of bridge and filters with it.
#
# usage: double.sh
#
# LAPEDIT_MESHES, LAPEDIT_HOSTS_DIR: as for check.sh. MeshLab's build is kept in the root, in /double.
set -euo pipefail

# shellcheck source-path=SCRIPTDIR
. "$(dirname "$(realpath "$0")")/build_root.sh" sid
add_meshlab_source

echo "== double: MeshLab"
# shellcheck disable=SC2016
"${root_sh[@]}" run "$root" "${options[@]}" -- sh -euc '
  mkdir -p /double
  cd /double
  # Those that the tests use.
  plugins="io_base filter_func filter_layer filter_select"
  /src/tests/compat/configure_meshlab.sh /meshlab /meshlab build -DMESHLAB_BUILD_WITH_DOUBLE_SCALAR=ON -DMESHLAB_BUILD_ONLY_LIBRARIES=ON \
    "-DMESHLAB_PLUGINS=$(printf "meshlabplugins/%s;" $plugins)" >configure.log 2>&1 || { cat configure.log; exit 1; }
  ninja -C build meshlab-common $plugins >build.log 2>&1 ||
    { grep -A 12 FAILED build.log || tail -n 40 build.log; exit 1; }
  grep "MeshLab version" configure.log'

echo "== double: build"
# shellcheck disable=SC2016
"${root_sh[@]}" run "$root" "${options[@]}" -- sh -euc '
  mkdir -p /double/ours
  cd /double/ours
  library=$(find /double/build -name libmeshlab-common.so)
  cmake -G Ninja -S /src -B . -DLAPEDIT_BUILD_TESTS=ON -DLAPEDIT_WARNINGS_AS_ERRORS=ON \
    -DLAPEDIT_MESHES="$LAPEDIT_MESHES" -DMESHLAB_SOURCE_DIR=/meshlab -DMeshLab_LIBRARY="$library" -DMeshLab_SCALAR=double \
    >configure.log 2>&1 || { cat configure.log; exit 1; }
  # Nothing of the installed MeshLab, which has single precision, may be in it. The plugin takes what its host has loaded.
  targets="filter_laplacian_edit edit_laplacian_drag laplacian_edit_program run_filters bridge_tests hosts_meshes"
  ninja $targets >build.log 2>&1 || { grep -A 12 FAILED build.log || tail -n 40 build.log; exit 1; }
  tail -n 1 build.log
  if ldd tests/compat/run_filters tests/unit/bridge_tests | grep meshlab-common | grep -vF "$library"; then
    echo "The library in single precision is used."
    exit 1
  fi'

echo "== double: tests"
status=0
# shellcheck disable=SC2016
"${root_sh[@]}" run "$root" "${options[@]}" -- sh -euc '
  ctest --test-dir /double/ours --output-on-failure --no-tests=error --parallel "$(nproc)" \
    --tests-regex "^(host\.|MeshBridge|PoseWriter)"' || status=$?
[ "$status" -eq 0 ] || echo "double: failed, see above" >&2
exit "$status"
