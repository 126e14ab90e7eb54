#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Debian roots: folders with another Debian release in them, to build and test with its MeshLab.
#
# usage: root.sh make SUITE KIND     makes the root if it is not there yet; prints its folder
#        root.sh run ROOT [OPTION]... -- COMMAND [ARGUMENT]...
#                                    runs a command in it; ends with the command's exit code
#        root.sh check               ends with 0 where roots can be used; else says what is missing
#
#   SUITE             a release of Debian: bookworm, trixie, sid
#   KIND bare         what debootstrap's smallest variant gives, and no more
#   KIND clean        the packaged MeshLab, what it depends on, and Mesa's software OpenGL
#   KIND build        that, and all that is needed to build and test; 1.4 GB where clean takes 0.5
#   --bind FROM=TO    FROM, a folder of this machine, is at TO in the root
#   --bind-ro FROM=TO the same, read-only
#   --env NAME=VALUE  for the command; else it gets DISPLAY, CI and TERM of the caller's and nothing more
#   --directory DIR   of the root: where the command starts
#
# LAPEDIT_HOSTS_DIR: where the roots are, and what the checks keep beside them; by default build/hosts in this project. A root is
# kept until this script wants other packages; to make it again, remove it while no command runs in it.
#
# It needs root's rights (sudo is used where it is) and debootstrap. The mirror and apt's proxy are those of this machine. Mounts and
# processes of a root end with this script. An X server of this machine is reached through its abstract socket, with the same DISPLAY.
set -euo pipefail

recipe=1 # Another number makes all roots anew.
clean_packages="meshlab libgl1-mesa-dri"
build_packages="
  build-essential cmake ninja-build ccache pkg-config debhelper file
  qtbase5-dev libqt5opengl5-dev libeigen3-dev nlohmann-json3-dev libglew-dev libglu1-mesa-dev
  libsuitesparse-dev libopenblas-dev libgtest-dev libmuparser-dev
  xvfb xauth xdotool
  python3 python3-numpy
"
script=$(realpath "$0")
hosts=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$(dirname "$script")/../../build/hosts}")

fail() {
  echo "root.sh: $*" >&2
  exit 1
}

usage() {
  sed -n '/^# usage/,/^set/s/^# \{0,1\}//p' "$0" >&2
  exit 2
}

in_namespace() {
  setpriv --pdeathsig KILL unshare --mount --propagation private --pid --fork --kill-child=KILL "$@"
}

check() {
  command -v debootstrap >/dev/null || fail "debootstrap is missing: common/scripts/install_dependencies.sh installs it."
  in_namespace mount -t proc proc /proc 2>/dev/null ||
    fail "this machine lets nobody make mount namespaces (in a container, give it CAP_SYS_ADMIN): no root can be used."
}

make_bare() {
  local suite=$1 root=$2 uri
  # The mirror that this machine's own release comes from.
  # shellcheck disable=SC2016
  uri=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    awk '$2 !~ /-/ && $3 == "main" && !found { print $1; found = 1 }')
  [ -n "$uri" ] || fail "this machine's apt sources name no Debian mirror to make a root from."
  in_namespace debootstrap --variant=minbase --force-check-gpg \
    --keyring=/usr/share/keyrings/debian-archive-keyring.gpg "$suite" "$root" "$uri" || return
  echo "deb $uri $suite main" >"$root/etc/apt/sources.list"
  {
    # A mirror may be a snapshot, and a root is kept for longer than sid's lists are valid.
    echo 'Acquire::Check-Valid-Until "false";'
    apt-config dump | grep -Ei '^Acquire::(https?|Check-Date|Retries)\b.* "[^"]+";$' || true
  } >"$root/etc/apt/apt.conf.d/99lapedit"
  # It can be made again, and is made faster so.
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/lapedit"
}

install_packages() {
  local root=$1 packages=$2
  # shellcheck disable=SC2086
  enter "$root" / env DEBIAN_FRONTEND=noninteractive sh -euc '
    apt-get update -q
    apt-get install -qy --no-install-recommends "$@"
    apt-get clean
    rm -rf /var/lib/apt/lists/*' sh $packages </dev/null
}

# enter ROOT DIRECTORY COMMAND...: with the arrays mounts (rw or ro, FROM, TO) and environment
mounts=()
environment=()
enter() {
  local root=$1 directory=$2
  shift 2
  # The user may have changed networks since it was made.
  [ ! -e /etc/resolv.conf ] || cat /etc/resolv.conf >"$root/etc/resolv.conf"
  # The shell stays: as the first process of its namespace the command would not die of its own signals.
  # shellcheck disable=SC2016
  in_namespace sh -euc '
    root=$1 directory=$2 count=$3
    shift 3
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount -t tmpfs -o mode=1777 tmpfs "$root/tmp"
    while [ "$count" -gt 0 ]; do
      mkdir -p "$root$3"
      mount --bind "$2" "$root$3"
      [ "$1" = rw ] || mount -o remount,bind,ro "$root$3"
      shift 3
      count=$((count - 1))
    done
    status=0
    env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
      chroot "$root" env -C "$directory" "$@" || status=$?
    exit "$status"' sh "$root" "$directory" $((${#mounts[@]} / 3)) "${mounts[@]}" "${environment[@]}" "$@"
}

make() {
  [ $# -eq 2 ] || usage
  local suite=$1 kind=$2 root=$hosts/$1-$2 below='' packages='' stamp
  case $suite in *[!a-z0-9-]* | '' | -*) usage ;; esac
  case $kind in
  bare) ;;
  clean) below=bare packages=$clean_packages ;;
  build) below=clean packages="$clean_packages $build_packages" ;;
  *) usage ;;
  esac
  # Written last: a root with another stamp, or none, is not ready.
  # shellcheck disable=SC2086,SC2116
  stamp=$(echo "$recipe $suite $kind $(echo $packages)" | sha256sum | cut -d ' ' -f 1)
  mkdir -p "$hosts"
  exec 9>>"$root.lock"
  flock 9
  if [ "$(cat "$root/.lapedit-root" 2>/dev/null)" != "$stamp" ]; then
    check
    echo "Making $root" >&2
    rm -rf --one-file-system "$root" "$root.part"
    if [ -z "$below" ]; then
      make_bare "$suite" "$root.part"
    else
      cp -a --reflink=auto "$("$script" make "$suite" "$below" 9>&-)" "$root.part" && rm "$root.part/.lapedit-root" &&
        install_packages "$root.part" "$packages"
    fi >"$root.log" 2>&1 9>&- || { tail -n 30 "$root.log" >&2; fail "$root could not be made, see $root.log."; }
    echo "$stamp" >"$root.part/.lapedit-root"
    mv "$root.part" "$root"
    rm -f "$root.log"
  fi
  echo "$root"
}

run() {
  local root=${1:-} directory=/ name
  shift || usage
  for name in DISPLAY CI TERM; do
    [ -z "${!name:-}" ] || environment+=("$name=${!name}")
  done
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    [ $# -ge 2 ] || usage
    case $1 in
    --bind) mounts+=(rw "${2%%=*}" "${2#*=}") ;;
    --bind-ro) mounts+=(ro "${2%%=*}" "${2#*=}") ;;
    --env) environment+=("$2") ;;
    --directory) directory=$2 ;;
    *) usage ;;
    esac
    shift 2
  done
  [ $# -ge 2 ] || usage
  shift
  root=$(realpath -m "$root")
  [ -s "$root/.lapedit-root" ] || fail "$root is no root made by this script, or was not finished."
  enter "$root" "$directory" "$@"
}

case ${1:-} in make | run | check) ;; *) usage ;; esac
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "root's rights are needed to make and use a root, and there is no sudo."
  exec sudo -- env ${DISPLAY:+"DISPLAY=$DISPLAY"} ${CI:+"CI=$CI"} ${TERM:+"TERM=$TERM"} \
    "LAPEDIT_HOSTS_DIR=$hosts" "$script" "$@"
fi
"$@"
