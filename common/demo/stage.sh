#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a private copy of the installed MeshLab with plugins in it; nothing outside the stage is touched.
#
# usage: stage.sh STAGE PLUGIN.so... [BINARY...]
#   STAGE   folder to make; an old one is replaced
#   PLUGIN  plugins, found where they were built: a later build needs no new stage
#   BINARY  programs of MeshLab, by default meshlabserver and meshlab as far as they are installed
set -eu

stage=$1
shift
plugins=
while [ $# -gt 0 ] && [ "${1%.so}" != "$1" ]; do
  plugins="$plugins$(realpath "$1")
"
  shift
done
[ -n "$plugins" ] || { echo "stage.sh: no plugin is given" >&2; exit 1; }
if [ $# -eq 0 ]; then
  set -- $(command -v meshlabserver || true) $(command -v meshlab || true)
fi
[ $# -gt 0 ] || { echo "stage.sh: neither meshlabserver nor meshlab is installed" >&2; exit 1; }

rm -rf "$stage"
for binary in "$@"; do
  binary=$(realpath "$binary")
  prefix=$(dirname "$(dirname "$binary")")
  mkdir -p "$stage/bin" "$stage/share"
  # A copy, since MeshLab looks for its files from where the program really is.
  cp "$binary" "$stage/bin/"
  ln -sfn "$prefix/share/meshlab" "$stage/share/meshlab"
  for library in "$prefix"/lib/*/meshlab/libmeshlab-common.so "$prefix"/lib/meshlab/libmeshlab-common.so; do
    [ -e "$library" ] || continue
    host=$(dirname "$library")
    staged=$stage${host#"$prefix"}
    mkdir -p "$staged/plugins"
    ln -sf "$host"/*.so "$staged/"
    # Few plugins make a quick start.
    for name in io_base filter_select filter_func filter_layer filter_camera filter_unsharp filter_measure filter_colorproc edit_select edit_pickpoints decorate_base; do
      # Some need libraries that Debian's package only recommends; MeshLab 2022 and later stop at a dialog then.
      if LD_LIBRARY_PATH=$host ldd "$host/plugins/lib$name.so" 2>&1 | grep -Eq 'not found|No such file'; then continue; fi
      ln -sf "$host/plugins/lib$name.so" "$staged/plugins/"
    done
    printf %s "$plugins" | while read -r plugin; do
      ln -sf "$plugin" "$staged/plugins/"
    done
  done
done
