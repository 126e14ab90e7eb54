#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs all tests: the core's and random events in the window under sanitizers, then everything, optimised.
#
# LAPEDIT_TEST_HOSTS: OFF leaves out the MeshLabs of other Debian releases, which take root's rights, 10 GB and half of
#   the time.
# LAPEDIT_MESHES: folder of the real meshes; by default ../shared/meshes beside this project, if it is there.
# CI: when set, missing meshes are a failure.
set -eu

cd "$(dirname "$0")/../.."
jobs=$(nproc)

tests/scripts/install_dependencies.sh
if [ -z "${LAPEDIT_MESHES:-}" ] && [ -d ../shared/meshes ]; then
  LAPEDIT_MESHES=$(cd ../shared/meshes && pwd)
  export LAPEDIT_MESHES
fi
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi

echo "== Core, and random events in the window, under AddressSanitizer and UndefinedBehaviorSanitizer"
env -u LAPEDIT_MESHES cmake --preset dev -B build-sanitized
cmake --build build-sanitized --parallel "$jobs"
ctest --test-dir build-sanitized --label-regex core --output-on-failure --parallel "$jobs"
ctest --test-dir build-sanitized --tests-regex '^(gui\.stage|gui\.random|MeshBridge|PoseWriter)' --output-on-failure

echo "== Everything, optimised"
cmake -S . -B build -DLAPEDIT_TEST_HOSTS="${LAPEDIT_TEST_HOSTS:-ON}"
cmake --build build --parallel "$jobs"
ctest --test-dir build --output-on-failure --parallel "$jobs"
