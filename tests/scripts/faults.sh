#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Kills the program, fills its disk and lets calls of the system fail, at random places, and looks whether an output is lost.
#
# usage: tests/scripts/faults.sh [RUNS [SEED [BUILD]]]   500 runs, seed 28 and build/ unless given
#
# It needs strace, and ends with 1 when something was found.
set -euo pipefail
cd "$(dirname "$0")/../.."
export LAPEDIT_FAULTS=${1:-500} LAPEDIT_FAULTS_SEED=${2:-28}
command -v strace >/dev/null || { echo "faults.sh: please install strace" >&2; exit 1; }
exec ctest --test-dir "${3:-build}" --verbose --no-tests=error --timeout 7200 --tests-regex '^command\.faults$'
