#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the files of a release from this project, a clean clone of its tag, and their checksums: the source tarball, a Debian
# package for each supported MeshLab, and the source distribution and wheels of the Python package.
#
# usage: release.sh [FOLDER]     FOLDER: where they go, replaced; by default build/release
#
# It needs Debian 12 and roots of the Debian releases (tests/compat/root.sh; LAPEDIT_HOSTS_DIR as there).
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(realpath -m "${1:-build/release}")
rm -rf "$folder"
mkdir -p "$folder"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

common/scripts/source_tarball.sh "$folder"
for suite in bookworm trixie sid; do
  package=$(tests/compat/build_package.sh "$suite" "$work/$suite")
  mv "$package" "$folder"
done
common/scripts/build_wheels.sh "$work/wheels"
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install -q build twine
"$work/venv/bin/python" -m build --sdist -o "$folder" . >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
mv "$work"/wheels/*.whl "$folder"
"$work/venv/bin/twine" check --strict "$folder"/*.whl "$folder"/*.tar.gz
cd "$folder"
# By kinds, as the file of checksums may be there before the names are expanded.
sha256sum -- *.tar.xz *.tar.gz *.deb *.whl >SHA256SUMS
cat SHA256SUMS
