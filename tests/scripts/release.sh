#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the files of a release from this project, a clean clone of its tag, and their checksums: the source tarball, a Debian
# package for each supported MeshLab, and the wheel for PyMeshLab.
#
# usage: release.sh [FOLDER]     FOLDER: where they go, replaced; by default build/release
#
# It needs Debian 12 and roots of the Debian releases (tests/hosts/root.sh; LAPEDIT_HOSTS_DIR as there).
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(realpath -m "${1:-build/release}")
rm -rf "$folder"
mkdir -p "$folder"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

common/scripts/source_tarball.sh "$folder"
for suite in bookworm trixie sid; do
  package=$(tests/hosts/build_package.sh "$suite" "$work/$suite")
  mv "$package" "$folder"
done
wheel=$(filter_laplacian_edit/python/make_wheel.sh "$work/wheel")
mv "$wheel" "$folder"
cd "$folder"
# By kinds, as the file of checksums may be there before the names are expanded.
sha256sum -- *.tar.xz *.deb *.whl >SHA256SUMS
cat SHA256SUMS
