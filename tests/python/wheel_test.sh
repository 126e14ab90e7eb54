#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the wheel and a PyMeshLab from PyPI in a fresh virtual environment, and tests them together.
#
# usage: wheel_test.sh WHEEL PYMESHLAB PROGRAM MESHES     WHEEL: folder of make_wheel.sh; PROGRAM: laplacian-edit;
#                                                         MESHES: folder of the real meshes, may be empty
set -eu

[ $# -eq 4 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
venv=$(mktemp -d)
trap 'rm -rf "$venv"' EXIT
python3 -m venv "$venv"
numpy=numpy
case $2 in 2022.*) numpy='numpy<2' ;; esac # as README.md says
"$venv/bin/pip" install -q --find-links "$1/downloads" "$1"/dist/*.whl "pymeshlab==$2.*" "$numpy" 2>"$venv/log" ||
  { cat "$venv/log" >&2; exit 1; }
du -sm "$venv" | sed 's/\t.*/ MB installed/'
PYTHONDONTWRITEBYTECODE=1 LAPEDIT_PYMESHLAB=$2 LAPEDIT_COMMAND=$3 LAPEDIT_MESHES=$4 "$venv/bin/python" "$here/wheel_test.py" -v
