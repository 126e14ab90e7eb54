#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a newcomer does first, in a Debian release with nothing installed: the README's first command and its first script,
# on a copy of this project without builds; then the same, and tests, without any rights, as in a container that mounts
# nothing.
#
# usage: first.sh SUITE     SUITE: bookworm, trixie, sid
#
# All is done in a copy of root.sh's bare root, which is removed in the end. LAPEDIT_HOSTS_DIR as for root.sh; what was
# printed stays there, in SUITE-first.log.
set -euo pipefail

here=$(dirname "$(realpath "$0")")
project=$(realpath "$here/../..")
LAPEDIT_HOSTS_DIR=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$project/build/hosts}")
export LAPEDIT_HOSTS_DIR
[ $# -eq 1 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
suite=$1

if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "first.sh: root's rights are needed to use a root, and there is no sudo." >&2; exit 1; }
  exec sudo -- env "LAPEDIT_HOSTS_DIR=$LAPEDIT_HOSTS_DIR" "$0" "$@"
fi

bare=$("$here/root.sh" make "$suite" bare)
root=$LAPEDIT_HOSTS_DIR/$suite-first
exec 9>>"$root.own-lock"
flock 9
trap 'rm -rf --one-file-system "$root" "$root.lock"' EXIT
trap 'exit 143' TERM INT HUP
rm -rf --one-file-system "$root"
# Nobody may make it anew meanwhile.
(flock -s 8 && cp -a --reflink=auto "$bare" "$root") 8>>"$bare.lock"
mkdir "$root/project"
tar -C "$project" --exclude='./build*' --exclude=./.git --owner=0 --group=0 -c . | tar -C "$root/project" -x
# In the background, so that a signal is seen at once; what it started ends with it.
PYTHONDONTWRITEBYTECODE=1 LAPEDIT_FIRST_ROOT=$root LAPEDIT_OUTPUT=$root.log \
  setpriv --pdeathsig TERM python3 "$here/first_test.py" -v --failfast 9>&- &
wait $!
