#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the package's wheel in a fresh virtual environment with libraries from PyPI, and tests them together.
#
# usage: run.sh oldest|newest WHEELS PROGRAM     WHEELS: folder of make_wheels.sh; PROGRAM: laplacian-edit
# The oldest Python has NumPy 1 and PyMeshLab 2022.2, the newest has NumPy 2, PyMeshLab 2025.7 and PyVista. Where the
# oldest is too new for NumPy 1 the script ends with 77.
set -eu

[ $# -eq 3 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
case $1 in
oldest) python=$(head -n 1 "$2/pythons") packages="numpy<2 pymeshlab==2022.2.*" tests="package pymeshlab" ;;
newest) python=$(tail -n 1 "$2/pythons") packages="numpy>=2 pymeshlab==2025.7.* pyvista imageio ipctk==1.6.0" tests="package pymeshlab page contact" ;;
*) sed -n 's/^# usage: //p' "$0" >&2 && exit 2 ;;
esac
if [ "$1" = oldest ] && "$python" -c 'import sys; sys.exit(sys.version_info < (3, 12))'; then
  echo "SKIPPED: NumPy 1 and PyMeshLab 2022.2 are for Python up to 3.11, and the oldest here is $python."
  exit 77
fi
venv=$(mktemp -d)
trap 'rm -rf "$venv"' EXIT
"$python" -m venv "$venv"
# shellcheck disable=SC2086
"$venv/bin/pip" install -q --disable-pip-version-check trimesh $packages 2>"$venv/log" || { cat "$venv/log" >&2; exit 1; }
"$venv/bin/pip" install -q --disable-pip-version-check --no-index --no-deps --find-links "$2/dist" laplacian-edit 2>"$venv/log" ||
  { cat "$venv/log" >&2; exit 1; }
"$venv/bin/python" -c 'import sys, numpy; print("Python", sys.version.split()[0], "NumPy", numpy.__version__)'
for test in $tests; do
  PYTHONDONTWRITEBYTECODE=1 LAPEDIT_COMMAND=$3 LAPEDIT_MAKE_MESH=$(dirname "$3")/../demo/make_mesh "$venv/bin/python" "$here/${test}_test.py"
done
if [ "$1" = newest ]; then
  PYTHONDONTWRITEBYTECODE=1 LAPEDIT_COMMAND=$3 LAPEDIT_MAKE_MESH=$(dirname "$3")/../demo/make_mesh \
    "$venv/bin/python" "$here/../documents/cookbook_test.py" --python
fi
