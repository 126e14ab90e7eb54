#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Configures MeshLab's source, or a project that contains it, in a root: without downloads, as Debian has what is needed here.
#
# usage: configure_meshlab.sh SOURCE PROJECT BUILD CMAKE_OPTION...
set -eu

source=$1 project=$2 build=$3
shift 3
downloads=$(grep -oh 'MESHLAB_ALLOW_DOWNLOAD_SOURCE_[A-Z0-9_]*' "$source"/src/external/*.cmake | sort -u | sed 's/.*/-D&=OFF/')
# Newer Eigen and CMake do not tell these in the way that MeshLab asks for.
# shellcheck disable=SC2016,SC2086
exec cmake -G Ninja -S "$project" -B "$build" -DCMAKE_BUILD_TYPE=Release -DEIGEN3_INCLUDE_DIR=/usr/include/eigen3 \
  "-DGLEW_VERSION=$(dpkg-query -W -f '${Version}' libglew-dev)" $downloads "$@"
