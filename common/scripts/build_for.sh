#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds plugins and program for a MeshLab that no distribution installed, such as an official build, with the headers of its
# version.
#
# usage: build_for.sh FOLDER [CMAKE_OPTION]...     FOLDER: the unpacked MeshLab; of an AppImage what
#                                                  `MeshLab.AppImage --appimage-extract` makes, squashfs-root
#
# It builds in build-for-VERSION, and prints the command that installs them for this user.
set -eu

[ $# -ge 1 ] || { sed -n '/^# usage/,/^#$/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
root=$(cd "$1" && pwd)
shift
library=$(find "$root" -name libmeshlab-common.so -print -quit)
[ -n "$library" ] || { echo "build_for.sh: there is no libmeshlab-common.so in $root: unpack MeshLab there first." >&2; exit 1; }
# In double precision the version ends with d.
version=$(grep -aoE '(^|[^0-9])20[0-9]{2}\.[0-9]{2}d?H?' "$library" | grep -aoE '20[0-9]{2}\.[0-9]{2}' | sort -u)
case $version in
'' | *[!0-9.]*) echo "build_for.sh: $library does not tell its version." >&2; exit 1 ;;
esac
cd "$(dirname "$0")/../.."
build=build-for-$version
common/scripts/meshlab_source.sh "$version" "$build/meshlab-source"
cmake -S . -B "$build" -DCMAKE_UNITY_BUILD=ON -DMeshLab_LIBRARY="$library" -DMESHLAB_SOURCE_DIR="$PWD/$build/meshlab-source" "$@"
cmake --build "$build" --parallel "$(nproc)" --target filter_laplacian_edit edit_laplacian_drag laplacian_edit_program
echo
echo "Built for MeshLab $version. To install plugins and program for yourself:"
echo "    cmake --build $build --target install-user"
