#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the package for a Debian release's MeshLab, and tests it there: installed in a clean root it works in the stock
# MeshLab, and removed again it leaves nothing. Then the same for an installation into the user's own folders.
#
# usage: package_test.sh SUITE     SUITE: bookworm, trixie, sid
#
# Ends with 0 if all is well, with 1 if not. The roots are those of root.sh, and are not changed: what is installed goes
# to a layer above, or to a copy where this machine cannot mount an overlay. LAPEDIT_HOSTS_DIR as for root.sh; the build
# and what MeshLab printed last stay there, in SUITE-package/.
set -euo pipefail

fail() {
  echo "package_test.sh: $*" >&2
  exit 1
}

here=$(dirname "$(realpath "$0")")
LAPEDIT_HOSTS_DIR=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$here/../../build/hosts}")
export LAPEDIT_HOSTS_DIR
[ $# -eq 1 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
suite=$1

if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "root's rights are needed to use a root, and there is no sudo."
  exec sudo -- env "LAPEDIT_HOSTS_DIR=$LAPEDIT_HOSTS_DIR" ${CI:+"CI=$CI"} "$0" "$@"
fi
# All that is mounted or started ends with this script, however that ends.
if [ -z "${LAPEDIT_OWN_NAMESPACE:-}" ]; then
  exec env LAPEDIT_OWN_NAMESPACE=yes unshare --mount --propagation private --pid --fork --kill-child=KILL --mount-proc \
    "$0" "$@"
fi

build_root=$("$here/root.sh" make "$suite" build)
clean_root=$("$here/root.sh" make "$suite" clean)
folder=$LAPEDIT_HOSTS_DIR/$suite-package
mkdir -p "$folder"
exec 9>>"$folder.lock"
flock 9

echo "Building the package for $suite"
debian=$folder/debian
DEB_CXXFLAGS_STRIP=-g "$here/build_package.sh" "$suite" "$debian" 9>&-

# layer NAME ROOT: prints a folder that looks like ROOT and can be written to.
layer() {
  local top=$folder/$1
  rm -rf --one-file-system "$top" "$top.upper" "$top.work" "$top.lock"
  mkdir -p "$top" "$top.upper" "$top.work"
  if ! mount -t overlay -o "lowerdir=$2,upperdir=$top.upper,workdir=$top.work" overlay "$top" 2>/dev/null; then
    echo "No overlay can be mounted here: copying $2" >&2
    cp -a --reflink=auto "$2/." "$top"
  fi
  echo "$top"
}

drop() {
  umount "$1" 2>/dev/null || true
  rm -rf --one-file-system "$1" "$1.upper" "$1.work" "$1.lock"
}

# Nobody may make them anew meanwhile.
exec 8>>"$clean_root.lock" 7>>"$build_root.lock"
flock -s 8
flock -s 7
clean=$(layer clean "$clean_root")
user=$(layer user "$build_root")
status=0
env -u LAPEDIT_OWN_NAMESPACE PYTHONDONTWRITEBYTECODE=1 LAPEDIT_SUITE="$suite" LAPEDIT_PACKAGE="$(echo "$folder"/debian/*.deb)" \
  LAPEDIT_DEBIAN="$debian" LAPEDIT_CLEAN_ROOT="$clean" LAPEDIT_USER_ROOT="$user" LAPEDIT_OUTPUT="$folder" \
  python3 "$here/package_test.py" -v 7>&- 8>&- 9>&- || status=1
drop "$clean"
drop "$user"
exit "$status"
