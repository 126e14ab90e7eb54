#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the package for a Debian release's MeshLab, and tests it there: installed in a clean root it works in the stock
# MeshLab, and removed again it leaves nothing. Then the same for an installation into the user's own folders.
#
# usage: package_test.sh SUITE     SUITE: bookworm, trixie, sid
#
# Ends with 0 if all is well, with 1 if not. What is installed goes to copies of root.sh's roots. LAPEDIT_HOSTS_DIR as for root.sh; the
# build and what MeshLab printed last stay there, in SUITE-package/.
set -euo pipefail

here=$(dirname "$(realpath "$0")")
LAPEDIT_HOSTS_DIR=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$here/../../build/hosts}")
export LAPEDIT_HOSTS_DIR
[ $# -eq 1 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "package_test.sh: root's rights are needed to use a root, and there is no sudo." >&2; exit 1; }
  exec sudo -- env "LAPEDIT_HOSTS_DIR=$LAPEDIT_HOSTS_DIR" ${CI:+"CI=$CI"} "$0" "$@"
fi

folder=$LAPEDIT_HOSTS_DIR/$1-package
mkdir -p "$folder"
exec 9>>"$folder.lock"
flock 9
trap 'rm -rf --one-file-system "$folder/clean" "$folder/build"' EXIT
echo "Building the package for $1"
DEB_CXXFLAGS_STRIP=-g "$here/build_package.sh" "$1" "$folder/debian" 9>&-
for kind in clean build; do
  rm -rf --one-file-system "${folder:?}/$kind"
  cp -a --reflink=auto "$("$here/root.sh" make "$1" "$kind" 9>&-)" "$folder/$kind"
done
PYTHONDONTWRITEBYTECODE=1 LAPEDIT_PACKAGE="$(echo "$folder"/debian/*.deb)" LAPEDIT_DEBIAN="$folder/debian" \
  LAPEDIT_CLEAN_ROOT="$folder/clean" LAPEDIT_USER_ROOT="$folder/build" LAPEDIT_OUTPUT="$folder" \
  setpriv --pdeathsig TERM python3 "$here/package_test.py" -v 9>&-
