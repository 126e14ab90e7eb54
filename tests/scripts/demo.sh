#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Where this was before: use common/demo/run.
echo "demo.sh: this is common/demo/run now"
exec "$(dirname "$0")/../../common/demo/run" "$@"
