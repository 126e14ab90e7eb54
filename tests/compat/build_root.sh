# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# For scripts that build in a root: sourced with SUITE as argument, it makes the root if it is not there, and sets root_sh, root, and
# options: what the root is run with. The source is at /src there, the compiler's cache at /ccache, the real meshes at LAPEDIT_MESHES,
# and after add_meshlab_source the source of sid's MeshLab at /meshlab.
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
project=$(realpath "$here/../..")
hosts=$(realpath -m "${LAPEDIT_HOSTS_DIR:-$project/build/hosts}")
export LAPEDIT_HOSTS_DIR=$hosts
# If the script is ended, so is what it started.
root_sh=(setpriv --pdeathsig TERM "$here/root.sh")
# shellcheck disable=SC2034 # for the caller
root=$("${root_sh[@]}" make "$1" build)

mkdir -p "$hosts/$1-ccache"
options=(--bind-ro "$project=/src" --bind "$hosts/$1-ccache=/ccache" --env CCACHE_DIR=/ccache
  --env CMAKE_C_COMPILER_LAUNCHER=ccache --env CMAKE_CXX_COMPILER_LAUNCHER=ccache)
if [ -n "${LAPEDIT_MESHES:-}" ]; then
  options+=(--bind-ro "$LAPEDIT_MESHES=/meshes" --env LAPEDIT_MESHES=/meshes)
else
  options+=(--env LAPEDIT_MESHES=)
  echo "*** LAPEDIT_MESHES is not set: the tests on real meshes are left out on $1. ***"
fi

add_meshlab_source() {
  "$project/common/scripts/meshlab_source.sh" 2025.07 "$hosts/meshlab-2025.07"
  options+=(--bind-ro "$hosts/meshlab-2025.07=/meshlab")
}
