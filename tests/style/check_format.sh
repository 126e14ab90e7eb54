#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: check_format.sh CLANG_FORMAT SOURCE_FOLDER
# Fails, naming the places, when a source file is not as .clang-format wants it.
set -eu
cd "$2"
find . -name 'build*' -prune -o -name '.?*' -prune -o \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 "$1" --dry-run -Werror
