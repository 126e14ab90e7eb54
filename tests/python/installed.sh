#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs a wheel of build_wheels.sh in a virtual environment on the system that it is for, and runs the package's tests with
# the program in it.
#
# usage: installed.sh PYTHON WHEELS VENV     VENV: folder to make, replaced
set -euo pipefail

[ $# -eq 3 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$3"
"$1" -m venv "$3"
scripts=$3/bin
[ -d "$scripts" ] || scripts=$3/Scripts
"$scripts/python" -m pip install -q --disable-pip-version-check --only-binary=:all: trimesh
"$scripts/python" -m pip install -q --disable-pip-version-check --no-index --find-links "$2" laplacian-edit
PYTHONDONTWRITEBYTECODE=1 LAPEDIT_COMMAND=$scripts/laplacian-edit "$scripts/python" "$here/package_test.py"
