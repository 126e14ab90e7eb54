#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Configures a build folder. In a new one several source files are compiled in one, which takes a quarter of the time, with
# Ninja and ccache where they are there. A folder that is there keeps its generator.
#
# usage: configure.sh FOLDER [CMAKE_OPTION]...
set -eu

folder=$1
shift
if [ ! -f "$folder/CMakeCache.txt" ]; then
  set -- -DCMAKE_UNITY_BUILD=ON "$@"
  ! command -v ninja >/dev/null || set -- -G Ninja "$@"
fi
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
exec cmake -S "$(dirname "$0")/../.." -B "$folder" "$@"
