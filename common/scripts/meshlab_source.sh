#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Gets the source of a version of MeshLab, whose headers plugins are built with, from Debian, which has 2020.09, 2022.02 and
# 2025.07. Does nothing if the folder has it already.
#
# usage: meshlab_source.sh VERSION FOLDER     VERSION: such as 2025.07
set -eu

[ $# -eq 2 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
version=$1
[ "$(cat "$2/ML_VERSION" 2>/dev/null)" != "$version" ] || exit 0
rm -rf "$2.part" "$2"
mkdir -p "$2.part"
folder=$(cd "$2.part" && pwd)
case $version in
2020.09) suite=bookworm ;;
2022.02) suite=trixie ;;
2025.07) suite=sid ;;
*) echo "meshlab_source.sh: Debian has no MeshLab $version, only 2020.09, 2022.02 and 2025.07." >&2 && exit 1 ;;
esac
"$(dirname "$0")/debian_download.sh" "$suite" "$folder/tarball" src:meshlab
tar -xf "$folder"/tarball/*.orig.tar.* -C "$folder" --strip-components=1
rm -r "$folder/tarball"
found=$(cat "$folder/ML_VERSION")
[ "$found" = "$version" ] || { echo "meshlab_source.sh: $suite has MeshLab $found now, not $version." >&2; exit 1; }
mv "$folder" "$2"
