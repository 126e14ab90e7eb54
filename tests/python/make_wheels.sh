#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the wheels for the oldest and the newest Python of this machine, for tests: with the system's headers, and one build
# of the core for both, with the optimisation of the program, since other fused operations would give other last bits.
#
# usage: make_wheels.sh FOLDER     FOLDER: for environments, build and wheels, which go to FOLDER/dist
set -eu

[ $# -eq 1 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
rm -rf "$folder/dist"
"$here/pythons.sh" >"$folder/pythons"
[ -s "$folder/pythons" ] || { echo "make_wheels.sh: there is no Python 3.8 or later that makes virtual environments." >&2; exit 1; }
! command -v ccache >/dev/null || export CMAKE_CXX_COMPILER_LAUNCHER=ccache
CMAKE_GENERATOR=Ninja
export CMAKE_GENERATOR PIP_DISABLE_PIP_VERSION_CHECK=1
while read -r python; do
  venv=$folder/tools-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  {
    [ -d "$venv" ] || { "$python" -m venv "$venv" && "$venv/bin/pip" install -q 'pip>=23.1' 'scikit-build-core>=0.10' \
      "nanobind>=2.2; python_version >= '3.9'" "nanobind==2.4.*; python_version < '3.9'"; }
    "$venv/bin/pip" wheel -v --no-deps --no-build-isolation -w "$folder/dist" -C build-dir="$folder/build" \
      -C cmake.define.LAPEDIT_WARNINGS_AS_ERRORS="${CI:+ON}" "$here/../.."
  } >"$folder/log" 2>&1 </dev/null || { cat "$folder/log" >&2; exit 1; }
done <"$folder/pythons"
ls "$folder/dist"
