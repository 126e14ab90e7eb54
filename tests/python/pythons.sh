#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the oldest and the newest Python of this machine that the package supports and that can make virtual environments,
# one a line: those in PATH, and those of pyenv.
set -eu

{
  for minor in 8 9 10 11 12 13 14 15; do
    command -v "python3.$minor" || true
  done
  ! command -v pyenv >/dev/null || find "$(pyenv root)/versions" -maxdepth 3 -path '*/bin/python3'
} | while read -r python; do
  "$python" -c 'import ensurepip, sys; print("%d %s" % (sys.version_info[1], sys.executable))' 2>/dev/null || true
done | awk '$1 >= 8' | sort -n -u -k 1,1 | cut -d ' ' -f 2 | sed -n '1p; $p' | uniq
