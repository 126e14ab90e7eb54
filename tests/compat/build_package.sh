#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the Debian package for a Debian release's MeshLab in a root of that release, and prints its path.
#
# usage: build_package.sh SUITE FOLDER     SUITE: bookworm, trixie, sid
#                                          FOLDER: for source package, build, package and build.log; replaced
#
# LAPEDIT_HOSTS_DIR as for root.sh; the compiler's cache stays there, in SUITE-ccache/. DEB_CXXFLAGS_STRIP=-g builds without
# symbols for debuggers, which takes half the time and gives other bytes.
set -euo pipefail
[ $# -eq 2 ] || { sed -n '/^# usage/,/^#$/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
suite=$1
rm -rf "$2"
mkdir -p "$2"
folder=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
project=$(realpath "$here/../..")
cache=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$project/build/hosts}")/$suite-ccache
mkdir -p "$cache"

# build ROOT
build() {
  local meshlab
  meshlab=$("$here/root.sh" run "$1" -- dpkg-query --showformat='${source:Upstream-Version}' --show meshlab) &&
    "$project/common/scripts/debian_package.sh" "$folder" "${meshlab%%[+~]*}" &&
    "$here/root.sh" run "$1" --bind "$folder=/debian" --bind "$cache=/ccache" \
      --env CCACHE_DIR=/ccache --env CMAKE_CXX_COMPILER_LAUNCHER=ccache --env DEB_BUILD_OPTIONS=noautodbgsym \
      --env "DEB_CXXFLAGS_STRIP=${DEB_CXXFLAGS_STRIP:-}" -- sh -euc '
        cd /debian
        dpkg-source --extract debian-source/*.dsc source
        cd source
        dpkg-buildpackage --build=binary --no-sign -jauto'
}
build "$("$here/root.sh" make "$suite" build)" >"$folder/build.log" 2>&1 ||
  { tail -n 40 "$folder/build.log" >&2; echo "build_package.sh: no package was made, see $folder/build.log" >&2; exit 1; }
echo "$folder"/*.deb
