#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes meshlab-laplacian-edit-<version>.tar.xz from this project, a clone or an unpacked tarball, and prints its path. The
# same files give the same bytes. From a clone it takes the files that git tracks, else all but builds.
#
# usage: source_tarball.sh [FOLDER]     FOLDER: where it goes; by default build
set -eu
folder=${1:-$(dirname "$0")/../../build}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cd "$(dirname "$0")/../.."

version=$(sed -n 's/^project(laplacian_edit VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
date=$(sed -n 's/^date-released: //p' CITATION.cff)
name=meshlab-laplacian-edit-$version
tarball=$folder/$name.tar.xz
trap 'rm -f "$tarball.part" "$tarball.files"' EXIT
if [ -e .git ] && git -c core.quotePath=off ls-files >"$tarball.files" 2>/dev/null; then
  :
else
  find . \( -path ./.git -o -path ./.cache -o -path './build*' -o -name __pycache__ \) -prune -o \
    \( -type f -o -type l \) ! -name '*.user' -printf '%P\n' >"$tarball.files"
fi
# One thread, as the number of threads changes the bytes.
LC_ALL=C sort "$tarball.files" |
  XZ_OPT='-6 --threads=1' TZ=UTC LC_ALL=C tar --create --xz --file "$tarball.part" --format=gnu --no-recursion \
    --mtime="$date 00:00:00" --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX --transform="s,^,$name/,SH" \
    --files-from=-
mv "$tarball.part" "$tarball"
echo "$tarball"
