#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what building, testing and the demonstration need on Debian 12; does nothing when all of it is there.
set -eu

packages="
  g++ cmake make pkg-config
  qtbase5-dev libqt5opengl5-dev libeigen3-dev nlohmann-json3-dev libglew-dev libglu1-mesa-dev
  libsuitesparse-dev libopenblas-dev
  libgtest-dev clang-format clang-tidy
  meshlab dpkg-dev
  xvfb xauth xdotool libgl1-mesa-dri
  python3 python3-numpy python3-vtk9
  debootstrap
"

missing=
for package in $packages; do
  # shellcheck disable=SC2016
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install_dependencies.sh: as root, please install:$missing" >&2; exit 1; }
  as_root=sudo
fi
echo "Installing:$missing"
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# shellcheck disable=SC2086
{
  $as_root apt-get update -q &&
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $missing
} >"$log" 2>&1 </dev/null || { cat "$log" >&2; exit 1; }
