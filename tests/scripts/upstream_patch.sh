#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lays the two plugins out as MeshLab's own repository would have them, and prints how many lines that patch has.
#
# usage: upstream_patch.sh [--build | --extra] [FOLDER]
#   --build  also builds them there, in MeshLab 2025.07's own source: in the root of sid that tests/compat/root.sh makes
#   --extra  the same, but in a project that has MeshLab's source as a submodule, as meshlab-extra-plugins has
#   FOLDER   where the files go, replaced; by default build/upstream
set -euo pipefail

build=
if [ "${1:-}" = --build ] || [ "${1:-}" = --extra ]; then
  build=${1#--}
  shift
fi
project=$(realpath "$(dirname "$0")/../..")
folder=$(realpath -m "${1:-$project/build/upstream}")
filter=$folder/src/meshlabplugins/filter_laplacian_edit
tool=$folder/src/meshlabplugins/edit_laplacian_drag
rm -rf "$folder"
mkdir -p "$filter/lapedit" "$filter/lapedit_host/tool" "$tool/lapedit"
cd "$project"

# Of the host layer the newest interface alone.
cp -r common/core/{base,mesh,linear,deform,cells,fit,edit,json} "$filter/lapedit"
cp common/meshlab/*.{h,cpp} common/meshlab/api_2022/*.h common/meshlab/api_2022/parameters_2025/*.h "$filter/lapedit_host"
cp common/meshlab/tool/*.{h,cpp} "$filter/lapedit_host/tool"
cp filter_laplacian_edit/*.{h,cpp} "$filter"
cp -r common/session "$tool/lapedit"
cp edit_laplacian_drag/*.{h,cpp,qrc,png} "$tool"

version=$(sed -n 's/^project(laplacian_edit VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
# list FOLDER: its sources, as CMake takes them
list() {
  (cd "$1" && find . -name '*.cpp' | sort | sed 's,^\./,\t\t,')
}
kernels() {
  awk '/^set\(kernel_options|^set_source_files_properties\(/ { on = 1 } on { gsub("core/", "lapedit/"); print "\t" $0 } /\)$/ { on = 0 }' common/CMakeLists.txt
}
cat >"$filter/CMakeLists.txt" <<END
# SPDX-License-Identifier: GPL-3.0-or-later

find_package(Threads REQUIRED)
find_package(nlohmann_json 3.9 QUIET)
if(nlohmann_json_FOUND AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
	# Shared with edit_laplacian_drag.
	add_library(
		laplacian-edit-core STATIC EXCLUDE_FROM_ALL
$(list "$filter" | grep 'lapedit'))
$(kernels)
	target_include_directories(
		laplacian-edit-core PUBLIC \${CMAKE_CURRENT_SOURCE_DIR} \${CMAKE_CURRENT_SOURCE_DIR}/lapedit_host)
	# No decision differs with another compiler.
	target_compile_options(laplacian-edit-core PRIVATE -ffp-contract=off)
	target_compile_definitions(laplacian-edit-core PUBLIC LAPEDIT_VERSION="$version")
	target_link_libraries(
		laplacian-edit-core PUBLIC meshlab-common nlohmann_json::nlohmann_json Threads::Threads OpenGL::GLU)

	add_meshlab_plugin(
		filter_laplacian_edit
$(list "$filter" | grep -v 'lapedit'))
	target_link_libraries(filter_laplacian_edit PRIVATE laplacian-edit-core)
	set_target_properties(
		laplacian-edit-core filter_laplacian_edit
		PROPERTIES CXX_STANDARD 17 CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
else()
	message(STATUS "Skipping filter_laplacian_edit - needs nlohmann's JSON, and GCC or Clang.")
endif()
END
cat >"$tool/CMakeLists.txt" <<END
# SPDX-License-Identifier: GPL-3.0-or-later

if(TARGET laplacian-edit-core)
	add_meshlab_plugin(
		edit_laplacian_drag
$(list "$tool")
		icons.qrc)
	target_link_libraries(edit_laplacian_drag PRIVATE laplacian-edit-core \${CMAKE_DL_LIBS})
	target_compile_options(edit_laplacian_drag PRIVATE -ffp-contract=off)
	set_target_properties(
		edit_laplacian_drag PROPERTIES CXX_STANDARD 17 CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
else()
	message(STATUS "Skipping edit_laplacian_drag - filter_laplacian_edit is not built.")
endif()
END

find "$folder" -type f ! -name '*.png' -exec cat {} + | wc -l
[ -n "$build" ] || exit 0

# shellcheck source=tests/compat/build_root.sh
. "$project/tests/compat/build_root.sh" sid
add_meshlab_source
# shellcheck disable=SC2016
"${root_sh[@]}" run "$root" "${options[@]}" --bind-ro "$folder=/patch" --env "BUILD=$build" -- sh -euc '
  rm -rf /upstream
  mkdir /upstream
  cd /upstream
  cp -r /meshlab source
  plugins="filter_laplacian_edit edit_laplacian_drag"
  project=source
  if [ "$BUILD" = extra ]; then
    project=extra
    mkdir -p extra
    cat >extra/CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.18)
project(extra)
find_package(OpenGL REQUIRED)
find_package(Qt5 COMPONENTS OpenGL Xml Network REQUIRED)
find_package(GLEW)
find_package(Eigen3)
set(MESHLAB_BUILD_ONLY_LIBRARIES ON)
set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)
add_subdirectory(/upstream/source/src meshlab)
set(MESHLAB_PLUGIN_OUTPUT_DIR \${CMAKE_BINARY_DIR}/plugins)
set(MESHLAB_PLUGIN_INSTALL_DIR lib/meshlab/plugins)
foreach(plugin IN ITEMS $plugins)
  add_subdirectory(/patch/src/meshlabplugins/\${plugin} \${plugin})
endforeach()
END
    plugin_list=
  else
    plugin_list=$(printf "meshlabplugins/%s;" $plugins)
    cp -r /patch/src source
    sed -i "s,^\(\t*\)meshlabplugins/filter_layer$,&\n\1meshlabplugins/filter_laplacian_edit,
    s,^\(\t*\)meshlabplugins/edit_manipulators$,\1meshlabplugins/edit_laplacian_drag\n&," source/src/CMakeLists.txt
    [ "$(grep -c laplacian source/src/CMakeLists.txt)" -eq 2 ]
  fi
  # Not MeshLab'"'"'s other plugins, for many of which Debian has no libraries.
  /src/tests/compat/configure_meshlab.sh source $project build "-DMESHLAB_PLUGINS=$plugin_list" >configure.log 2>&1 || { cat configure.log; exit 1; }
  ninja -C build $plugins >build.log 2>&1 || { grep -A 12 FAILED build.log || tail -n 40 build.log; exit 1; }
  grep "MeshLab version" configure.log
  grep -c "warning:" build.log || true
  find build -name "lib*laplacian*.so" -exec ls -l {} +'
