#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a newcomer does first, in a Debian release with nothing installed: the README's commands, as they are printed there, on a copy of
# this project without builds; then the same without any rights, as in a container that mounts nothing.
#
# usage: first.sh SUITE     SUITE: bookworm, trixie, sid
#
# All is done in a copy of root.sh's bare root, which is removed in the end. LAPEDIT_HOSTS_DIR as for root.sh.
set -euo pipefail

here=$(dirname "$(realpath "$0")")
project=$(realpath "$here/../..")
LAPEDIT_HOSTS_DIR=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$project/build/hosts}")
export LAPEDIT_HOSTS_DIR
[ $# -eq 1 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "first.sh: root's rights are needed to use a root, and there is no sudo." >&2; exit 1; }
  exec sudo -- env "LAPEDIT_HOSTS_DIR=$LAPEDIT_HOSTS_DIR" "$0" "$@"
fi

root=$LAPEDIT_HOSTS_DIR/$1-first
exec 9>>"$root.lock"
flock 9
trap 'rm -rf --one-file-system "$root"' EXIT
rm -rf --one-file-system "$root"
cp -a --reflink=auto "$("$here/root.sh" make "$1" bare 9>&-)" "$root"
mkdir "$root/project"
tar -C "$project" --exclude='./build*' --exclude=./.git --owner=0 --group=0 -c . | tar -C "$root/project" -x

# readme START: the README's only command that begins so.
readme() {
  python3 - "$project/README.md" "$1" <<'END'
import re, sys
text = open(sys.argv[1], encoding="utf-8").read()
found = set(re.findall(rf"(?:^    |`)({re.escape(sys.argv[2])}(?:'[^']*'|[^\n`'])*)", text, re.M))
assert len(found) == 1, (sys.argv[2], found)
print(found.pop())
END
}
options=()
rights=()
# run COMMAND...: shell commands in the root, in /project
run() {
  local command
  for command in "$@"; do
    echo "\$ ${command:?}"
    "$here/root.sh" run "$root" --directory /project "${options[@]}" -- "${rights[@]}" sh -euc "$command" </dev/null
  done
}
demonstration() {
  run "$(readme common/demo/run)" \
    'for name in dragon_after after after_replay; do test -s build/demo/$name.ply; ! cmp -s build/demo/before.ply build/demo/$name.ply || exit 1; done' \
    'test -z "$(find build/demo -name "*.png" -size -20k)"'
}
# A disc at the middle of the plate is lifted by 0.5 as a whole.
first_script() {
  run "rm -f after.ply" "$(readme 'echo ')
$(readme 'laplacian-edit build/')"
  python3 - "$root/project" "$here" <<'END'
import math, pathlib, sys
sys.path.insert(0, f"{sys.argv[2]}/../cli")
from ply import Ply
before, after = (Ply(pathlib.Path(sys.argv[1], name)).points() for name in ("build/demo/before.ply", "after.ply"))
lifted = [math.dist(q, (p[0], p[1], p[2] + 0.5)) for p, q in zip(before, after) if math.dist(p, (2, 1, 0.12)) < 0.07]
assert len(lifted) > 10 and max(lifted) < 1e-3, lifted
END
}
nothing_installed='! find /usr /home /root -name "*laplacian*" -not -type d | grep .'

run "! command -v cmake"
demonstration
run "apt-get install -qy --no-install-recommends sudo" # which a newcomer has
run "$(readme common/scripts/install_dependencies.sh)" "$(readme common/scripts/debian_package.sh)" "yes | $(readme 'sudo apt install ./build/')"
first_script
run "yes | $(readme 'sudo apt purge meshlab-laplacian-edit')" "$nothing_installed" "$(readme 'cmake -S . -B build')" "$(readme 'sudo cmake --install build')"
first_script
run "xargs rm <build/install_manifest.txt" "$nothing_installed"

# No right is left, none can be had, nothing can be mounted, and there is no shared memory.
run "rm -r build/demo; mkdir /home/newcomer; chown -R 1000:1000 /project /home/newcomer"
options=(--env HOME=/home/newcomer --env PATH=/home/newcomer/.local/bin:/project/build/common/cli:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin)
rights=(sh -euc 'mount -t tmpfs -o ro none /dev/shm; exec "$@"' sh setpriv --reuid=1000 --regid=1000 --clear-groups
  --bounding-set=-all --inh-caps=-all --ambient-caps=-all --no-new-privs)
run "! mount -t tmpfs none /mnt"
demonstration
install=$(readme 'cmake --build build --target install-user')
if [ -e "$root/usr/bin/meshlabserver" ]; then
  run "if $install >install.log 2>&1; then exit 1; fi" "tr -s ' \n' ' ' <install.log | grep 'has no plugin folder for users'"
else
  run "$install"
fi
first_script
run "cmake -S . -B build -DLAPEDIT_BUILD_TESTS=ON && ctest --test-dir build --output-on-failure --no-tests=error --parallel $(nproc) -R '^(command\.program|host\.(stage|filter|refusal))$'"
