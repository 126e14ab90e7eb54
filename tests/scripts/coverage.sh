#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints how many lines of the shared module were run by the tests since its counts were deleted, and which were not.
#
# usage: coverage.sh FOLDER   a build with LAPEDIT_COVERAGE; ends with 1 at 95 % or less
set -euo pipefail
cd "$(dirname "$0")/../.."
[ $# -eq 1 ] || { sed -n '/^# usage/p' "$0" >&2; exit 2; }
# Threads count without locks, which would make the tests ten times as slow: a count may come out negative.
gcovr --gcov-ignore-parse-errors --root . --filter common/core/ --filter common/session/ --object-directory "$1" --fail-under-line 95 "$1/common"
