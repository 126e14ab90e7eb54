#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the Debian source package, and from it the package for the installed MeshLab, and prints the last one's path. The
# source package is common/packaging/debian, this project, and MeshLab's headers, which its packages do not contain.
#
# usage: debian_package.sh [FOLDER [MESHLAB]]     FOLDER: where they go; by default build
#                                                 MESHLAB: only the source package, for a version such as 2025.07
set -eu

here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "${1:-$here/../../build}"
folder=$(cd "${1:-$here/../../build}" && pwd)
meshlab=${2:-$(dpkg-query --showformat='${source:Upstream-Version}' --show meshlab | sed 's/[+~].*//')}

"$here/meshlab_source.sh" "$meshlab" "$folder/meshlab-$meshlab"
tarball=$("$here/source_tarball.sh" "$folder")
name=$(basename "$tarball" .tar.xz)
version=${name##*-}+meshlab$meshlab
work=$folder/debian-source
rm -rf "$work"
mkdir "$work"
tar -xf "$tarball" -C "$work"
orig=$work/meshlab-laplacian-edit_$version.orig
mv "$tarball" "$orig.tar.xz"

source=$work/$name
cd "$folder/meshlab-$meshlab"
# vcglib is beside src or in it.
find . -path './src/common/*' -o -path './src/meshlab/*.h' -o -path '*/vcglib/vcg/*' -o -path '*/vcglib/wrap/*' \
  -o -path '*/vcglib/eigenlib/*' -o -name ML_VERSION -o -name 'LICENSE*' | LC_ALL=C sort |
  TZ=UTC tar --create --xz --file "$orig-meshlab.tar.xz" --format=gnu --no-recursion --owner=0 --group=0 --numeric-owner \
    --mode=u=rwX,go=rX --mtime="$(sed -n 's/^date-released: //p' "$source/CITATION.cff")" --transform='s,^[.],meshlab,' \
    --files-from=-
mkdir "$source/meshlab"
tar -xf "$orig-meshlab.tar.xz" -C "$source/meshlab" --strip-components=1
cp -R "$source/common/packaging/debian" "$source"
sed -i "1s/(.*)/($version-1)/" "$source/debian/changelog"
cd "$work"
dpkg-source --build "$name" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
[ $# -lt 2 ] || { echo "$work/meshlab-laplacian-edit_$version-1.dsc"; exit; }

cd "$source"
echo "Building the package; $work/log has what is printed." >&2
DEB_BUILD_OPTIONS="${DEB_BUILD_OPTIONS-noautodbgsym}" dpkg-buildpackage --build=binary --no-sign -jauto >"$work/log" 2>&1 ||
  { tail -n 60 "$work/log" >&2; exit 1; }
mv "$work"/meshlab-laplacian-edit_*.deb "$folder"
echo "$folder"/meshlab-laplacian-edit_"$version"-1_*.deb
