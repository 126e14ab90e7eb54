# SPDX-License-Identifier: GPL-3.0-or-later
#[[
Puts the plugins where MeshLab looks for a user's own, and the program into ~/.local/bin; removes them again.

cmake -D MODE=<install|uninstall> -D BUILD_DIR=<build folder>
      -D PLUGINS=<their files' names> -D PLUGIN_DIR=<the system's plugin folder>
      -D USER_FOLDER=<where the plugins go, below the user's data folder; empty where MeshLab has no such place>
      -D MESHLAB_VERSION=<version> -P install_user.cmake
]]
cmake_minimum_required(VERSION 3.25)

# What was made, folders after their files: one path a line.
set(manifest "${BUILD_DIR}/install_user_manifest.txt")

function(make_folders folder)
  if(NOT IS_DIRECTORY "${folder}")
    cmake_path(GET folder PARENT_PATH parent)
    make_folders("${parent}")
    file(MAKE_DIRECTORY "${folder}")
    file(READ "${manifest}" rest)
    file(WRITE "${manifest}" "${folder}\n${rest}")
  endif()
endfunction()

function(put file folder)
  make_folders("${folder}")
  file(COPY "${file}" DESTINATION "${folder}")
  cmake_path(GET file FILENAME name)
  file(READ "${manifest}" rest)
  file(WRITE "${manifest}" "${folder}/${name}\n${rest}")
  message("Installed ${folder}/${name}")
endfunction()

if(MODE STREQUAL "uninstall")
  if(NOT EXISTS "${manifest}")
    message(FATAL_ERROR "install-user has installed nothing from this build folder.")
  endif()
  file(STRINGS "${manifest}" made)
  foreach(path IN LISTS made)
    if(NOT IS_DIRECTORY "${path}")
      file(REMOVE "${path}")
      message("Removed ${path}")
    else()
      # MeshLab may have put something of its own there.
      file(GLOB content LIST_DIRECTORIES ON "${path}/*" "${path}/.*")
      list(FILTER content EXCLUDE REGEX "/\\.\\.?$")
      if(NOT content)
        file(REMOVE_RECURSE "${path}")
      endif()
    endif()
  endforeach()
  file(REMOVE "${manifest}")
  return()
endif()

if(NOT USER_FOLDER)
  message(FATAL_ERROR "MeshLab ${MESHLAB_VERSION} has no plugin folder for users: install with cmake --install, or make "
                      "a package with common/scripts/debian_package.sh.")
endif()
if(NOT DEFINED ENV{HOME} OR "$ENV{HOME}" STREQUAL "")
  message(FATAL_ERROR "HOME is not set: it is not known where the user's folders are.")
endif()

foreach(plugin IN LISTS PLUGINS)
  if(EXISTS "${PLUGIN_DIR}/${plugin}")
    message(FATAL_ERROR "${PLUGIN_DIR}/${plugin} is installed for all users, and MeshLab would load both: remove it "
                        "first (apt-get remove meshlab-laplacian-edit, if that package brought it).")
  endif()
endforeach()

# What is installed, with the right search paths for libraries, below a folder of ours. The component is that of all that
# names none: its list of installed files is not the one that an installation by root has left.
set(stage "${BUILD_DIR}/install_user_stage")
file(REMOVE_RECURSE "${stage}")
execute_process(COMMAND "${CMAKE_COMMAND}" -E env "DESTDIR=${stage}" "${CMAKE_COMMAND}" --install "${BUILD_DIR}" --strip
                        --prefix /usr --component Unspecified OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

# As Qt does.
if(IS_ABSOLUTE "$ENV{XDG_DATA_HOME}")
  set(data "$ENV{XDG_DATA_HOME}")
else()
  set(data "$ENV{HOME}/.local/share")
endif()
if(NOT EXISTS "${manifest}")
  file(WRITE "${manifest}" "")
endif()
foreach(plugin IN LISTS PLUGINS)
  put("${stage}${PLUGIN_DIR}/${plugin}" "${data}/${USER_FOLDER}")
endforeach()
file(GLOB programs "${stage}/usr/bin/*")
foreach(program IN LISTS programs)
  put("${program}" "$ENV{HOME}/.local/bin")
endforeach()
file(REMOVE_RECURSE "${stage}")
