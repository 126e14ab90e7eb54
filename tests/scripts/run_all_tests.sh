#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Where this was before: use tests/run.
echo "run_all_tests.sh: this is tests/run --everything now"
exec "$(dirname "$0")/../run" --everything "$@"
