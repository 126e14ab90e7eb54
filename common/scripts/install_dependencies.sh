#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs on Debian 12 or 13 what is missing; does nothing when all of it is there.
#
# usage: install_dependencies.sh [WHAT]...
#   build       MeshLab, and what the plugins are built with: the default
#   tests       also what tests/run takes
#   pictures    also what the demonstration and the pictures take
#   bench       also what tests/bench/ takes
#   wheels      only what build_wheels.sh takes
#   everything  also what tests/run --everything takes
#
# It needs root's rights, or sudo.
set -eu

packages="
  build-essential cmake pkg-config debhelper file
  qtbase5-dev libqt5opengl5-dev libeigen3-dev nlohmann-json3-dev libglew-dev libglu1-mesa-dev
  meshlab"
fast="ninja-build ccache"
# A MeshLab that runs without a screen.
display="xvfb xauth libgl1-mesa-dri python3"
tests="$display $fast python3-venv libgtest-dev libsuitesparse-dev xdotool python3-numpy parallel appstream strace"
for what in "$@"; do
  case $what in
  build) ;;
  wheels) packages="python3-venv xz-utils" ;;
  tests) packages="$packages $tests" ;;
  pictures) packages="$packages $display $fast python3-numpy python3-vtk9" ;;
  bench) packages="$packages $display $fast libsuitesparse-dev libopenblas-dev libcgal-dev python3-numpy python3-scipy python3-vtk9" ;;
  everything) packages="$packages $tests clang-format clang-tidy clang libclang-rt-dev gcovr universal-ctags debootstrap lintian
    libc++-dev libc++abi-dev g++-aarch64-linux-gnu qemu-user-static wine64 llvm" ;;
  *)
    sed -n '/^# usage/,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
  esac
done

log=$(mktemp)
trap 'rm -f "$log"' EXIT
# install PACKAGE...: what is missing of them
install() {
  missing=
  for package in "$@"; do
    # shellcheck disable=SC2016
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0

  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "install_dependencies.sh: as root, please install:$missing" >&2; exit 1; }
    as_root=sudo
  fi
  echo "Installing:$missing"
  # shellcheck disable=SC2086
  {
    $as_root apt-get update -q &&
      $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $missing
  } >"$log" 2>&1 </dev/null || { cat "$log" >&2; exit 1; }
}
# shellcheck disable=SC2086
install $packages
# Libraries of MeshLab's own plugins are only recommended by its package from Debian 13 on. Without them it lacks filters.
# shellcheck disable=SC2016,SC2046
install $(dpkg-query -W -f '${Recommends}' meshlab 2>/dev/null | tr , '\n' | sed -n '/|/d; s/^ *\(lib[^ ]*\).*/\1/p')
