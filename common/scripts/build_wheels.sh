#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the wheels of the Python package on Debian 12, with the compiler of PyPI's package ziglang: for each system one for
# CPython 3.11 and one for 3.12 and later. Each holds the program laplacian-edit too.
#
# usage: build_wheels.sh FOLDER [SYSTEM]...
#   FOLDER  where the wheels go; compiler, headers and objects go to FOLDER/build
#   SYSTEM  linux-x86_64, linux-aarch64, windows, macos-arm64, macos-x86_64: by default all
#
# It installs the two packages of Debian that it needs, and takes Python's headers from apt's sources, the rest from PyPI.
set -euo pipefail

[ $# -ge 1 ] || { sed -n '/^# usage/,/^#$/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
project=$(realpath "$(dirname "$0")/../..")
"$project/common/scripts/install_dependencies.sh" wheels
folder=$(realpath -m "$1")
shift
[ $# -gt 0 ] || set -- linux-x86_64 linux-aarch64 windows macos-arm64 macos-x86_64
build=$folder/build
mkdir -p "$build"
log=$build/log
export ZIG_GLOBAL_CACHE_DIR=$build/zig-cache ZIG_LOCAL_CACHE_DIR=$build/zig-cache PIP_DISABLE_PIP_VERSION_CHECK=1
export CMAKE_GENERATOR=Ninja CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

# run COMMAND...: prints what the command wrote if it fails
run() {
  "$@" >"$log" 2>&1 </dev/null || { tail -n 60 "$log" >&2; exit 1; }
}

if [ ! -f "$build/venv/done" ]; then
  rm -rf "$build/venv"
  run python3 -m venv "$build/venv"
  run "$build/venv/bin/pip" install 'pip>=23.1' 'ziglang==0.17.*' 'nanobind==3.1.*' 'scikit-build-core==1.1.*' 'cmeel-eigen==3.4.*' \
    'nlohmann-json==3.*' 'cmake==3.*' 'ninja==1.*'
  touch "$build/venv/done"
fi
PATH=$build/venv/bin:$PATH

# Python's headers: pyconfig.h in the forms of Windows and of any Unix with 64 bits, and on Windows import libraries.
python_headers() {
  local suite=$1 version=$2 source=$build/python-$2 libraries=$build/python-$2/libraries
  [ ! -f "$source/done" ] || return 0
  rm -rf "$source"
  run "$project/common/scripts/debian_download.sh" "$suite" "$source/download" "src:python$version"
  run tar -xf "$source"/download/*.orig.tar.* -C "$source" --strip-components=1 --wildcards '*/Include' '*/PC/pyconfig.h*' \
    '*/PC/python3dll.c'
  rm -r "$source/download"
  mkdir "$source/windows" "$source/unix" "$libraries"
  # That of 3.11 takes another compiler than Microsoft's for one of 32 bits.
  { printf '#ifndef MS_WIN64\n#define MS_WIN64\n#endif\n' && sed '/^#define MS_WIN64$/d' "$source"/PC/pyconfig.h*; } \
    >"$source/windows/pyconfig.h"
  local sizes="INT=4 LONG=8 LONG_LONG=8 VOID_P=8 SIZE_T=8 PID_T=4 WCHAR_T=4"
  {
    printf '#define HAVE_%s 1\n' LONG_LONG PTHREAD_H SSIZE_T STDDEF_H SYS_STAT_H SYS_TIME_H SYS_TYPES_H WCHAR_H
    printf '#define ALIGNOF_MAX_ALIGN_T 16\n#include <stdio.h>\n' # which nanobind uses, and Windows' includes
    # shellcheck disable=SC2086
    printf '#define SIZEOF_%s\n' ${sizes//=/ } | paste -d ' ' - - | sed 's/ #define SIZEOF_/ /'
  } >"$source/unix/pyconfig.h"
  { printf 'LIBRARY python3.dll\nEXPORTS\n' && sed -n 's/^EXPORT_[A-Z]*(\(.*\))$/\1/p' "$source/PC/python3dll.c"; } >"$libraries/python3.def"
  { printf 'LIBRARY python%s.dll\nEXPORTS\n' "${version/./}" && grep -ohE '\b_?Py[A-Za-z0-9_]+' -r "$source/Include" | sort -u; } \
    >"$libraries/python${version/./}.def"
  for file in "$libraries"/*.def; do
    run python -m ziglang dlltool -m i386:x86-64 -d "$file" -l "${file%.def}.lib"
  done
  touch "$source/done"
}

# zig SYSTEM TARGET: makes the commands of a compiler for C++ in $build/zig/SYSTEM
zig() {
  local commands=$build/zig/$1 tool zig=$build/venv/bin/python
  mkdir -p "$commands"
  for tool in ar ranlib rc; do
    printf '#!/bin/sh\nexec "%s" -m ziglang %s "$@"\n' "$zig" "$tool" >"$commands/$tool"
  done
  cat >"$commands/c++" <<END
#!/usr/bin/env bash
options=()
for option; do
  case \$option in # which zig's linker for macOS does not know
  -bundle) option=-shared ;;
  -Wl,@*) option=-Wl,-undefined,dynamic_lookup ;;
  esac
  options+=("\$option")
done
exec "$zig" -m ziglang c++ -O3 -s -target $2 "\${options[@]}"
END
  chmod +x "$commands"/*
}

# wheel SYSTEM VERSION TAG SUFFIX PLATFORM CMAKE_DEFINITION...
wheel() {
  local system=$1 version=$2 tag=$3 suffix=$4 options=()
  shift 4
  for option; do
    options+=(-C "cmake.define.$option")
  done
  rm -f "$build/wheels-$system/CMakeCache.txt" # which keeps another Python's
  run python -m pip wheel -v --no-deps --no-build-isolation -w "$folder" -C build-dir="$build/wheels-$system" -C wheel.tags="$tag" \
    -C cmake.define.LAPEDIT_TARGET_PYTHON_VERSION="$version" -C cmake.define.LAPEDIT_TARGET_PYTHON_SUFFIX="$suffix" "${options[@]}" "$project"
}

python_headers bookworm 3.11
python_headers trixie 3.13
for system; do
  library=
  headers=unix
  case $system in
  linux-x86_64) target=x86_64-linux-gnu.2.17 name=Linux platform=manylinux_2_17_x86_64 ending=.cpython-311-x86_64-linux-gnu.so ;;
  linux-aarch64) target=aarch64-linux-gnu.2.17 name=Linux platform=manylinux_2_17_aarch64 ending=.cpython-311-aarch64-linux-gnu.so ;;
  macos-arm64) target=aarch64-macos.11.0 name=Darwin platform=macosx_11_0_arm64 ending=.cpython-311-darwin.so ;;
  macos-x86_64) target=x86_64-macos.11.0 name=Darwin platform=macosx_11_0_x86_64 ending=.cpython-311-darwin.so ;;
  windows) target=x86_64-windows-gnu name=Windows platform=win_amd64 ending=.cp311-win_amd64.pyd headers=windows ;;
  *) echo "build_wheels.sh: $system is none of the systems that its usage names." >&2 && exit 2 ;;
  esac
  zig "$system" "$target"
  commands=$build/zig/$system
  for version in 3.11 3.13; do
    python=$build/python-$version
    tag=cp311-cp311-$platform
    [ "$version" = 3.11 ] || { tag=cp312-abi3-$platform && ending=.abi3.so; }
    if [ "$system" = windows ]; then
      library=$python/libraries/python311.lib
      [ "$version" = 3.11 ] || { library=$python/libraries/python3.lib && ending=.pyd; }
    fi
    wheel "$system" "$version" "$tag" "$ending" CMAKE_SYSTEM_NAME="$name" CMAKE_SYSTEM_PROCESSOR="${target%%-*}" \
      CMAKE_CXX_COMPILER="$commands/c++" CMAKE_AR="$commands/ar" CMAKE_RANLIB="$commands/ranlib" \
      CMAKE_RC_COMPILER="$commands/rc" CMAKE_OSX_DEPLOYMENT_TARGET=11.0 \
      LAPEDIT_TARGET_PYTHON="$python/$headers;$python/Include" LAPEDIT_TARGET_PYTHON_LIBRARY="$library"
    echo "$folder"/*"-$tag.whl"
  done
done
