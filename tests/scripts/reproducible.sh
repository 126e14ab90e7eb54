#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the Debian package twice from the source tarball, in two folders, without a compiler cache, and compares the bytes.
#
# usage: reproducible.sh [FOLDER]     FOLDER: for the builds, replaced; by default build/reproducible
#
# The second build has another umask, time zone, language and time than the first. Ends with 0 if the
# packages are the same and hold no path of theirs; some ten minutes on two cores.
set -euo pipefail

project=$(realpath "$(dirname "$0")/../..")
folder=$(realpath -m "${1:-$project/build/reproducible}")
rm -rf "$folder"
mkdir -p "$folder"
tarball=$("$project/common/scripts/source_tarball.sh" "$folder")

# build NAME JOBS: unpacks into folder/NAME, and leaves the package in folder/NAME/build.
build() {
  local source=$folder/$1
  mkdir -p "$source"
  tar -xf "$tarball" -C "$source" --strip-components=1 --touch
  # shellcheck disable=SC2016
  env -u CMAKE_CXX_COMPILER_LAUNCHER -u CMAKE_C_COMPILER_LAUNCHER CCACHE_DISABLE=1 sh -euc '
    DEB_BUILD_OPTIONS="noautodbgsym parallel=$2" "$1/common/scripts/debian_package.sh"' sh "$source" "$2" >"$source.log" 2>&1 || { tail -n 40 "$source.log" >&2; return 1; }
}

(umask 022 && TZ=UTC build one "$(nproc)")
(umask 077 && TZ=Asia/Tokyo LC_ALL=C.UTF-8 build another/folder/of/a/longer/name "$(nproc)")

packages=("$folder"/one/build/*.deb "$folder"/another/folder/of/a/longer/name/build/*.deb)
sha256sum "${packages[@]}"
status=0
cmp "${packages[@]}" || status=1
dpkg-deb -x "${packages[0]}" "$folder/unpacked"
if grep -rFl "$folder" "$folder/unpacked"; then
  echo "reproducible.sh: the files above hold the path of the build." >&2
  status=1
fi
exit "$status"
