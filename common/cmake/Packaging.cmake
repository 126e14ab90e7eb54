# SPDX-License-Identifier: GPL-3.0-or-later
#[[
Two ways out of the build folder besides `cmake --install`:

  cpack, or the target package     a .deb for the MeshLab that this was configured for
  install-user, uninstall-user     into the user's own folders, without root's rights; not for MeshLab 2020.09

Included last: needs the targets, and what FindMeshLab.cmake has found.
]]

# What software centres tell of it. The day is that of the release.
file(STRINGS "${PROJECT_SOURCE_DIR}/CITATION.cff" _date REGEX "^date-released: ")
string(REPLACE "date-released: " "" LAPEDIT_RELEASE_DATE "${_date}")
set(_files "${PROJECT_BINARY_DIR}/package")
set(_metainfo "${_files}/net.meshlab.meshlab.laplacian_edit.metainfo.xml")
configure_file("${CMAKE_CURRENT_LIST_DIR}/package/metainfo.xml.in" "${_metainfo}" @ONLY)
install(FILES "${_metainfo}" DESTINATION share/metainfo)

# Into the user's own folders ------------------------------------------------------------------------------------------

# As the host's mlapplication.cpp puts it together. With double precision it also has a version of its own.
math(EXPR _bits "8 * ${CMAKE_SIZEOF_VOID_P}")
if(MeshLab_API EQUAL 2020)
  set(_user_folder "")
elseif(MeshLab_SCALAR STREQUAL "double")
  set(_user_folder "VCG/MeshLab_${_bits}bit_dp/MeshLabExtraPlugins/${MeshLab_VERSION}d")
else()
  set(_user_folder "VCG/MeshLab_${_bits}bit_fp/MeshLabExtraPlugins/${MeshLab_VERSION}")
endif()
foreach(_mode IN ITEMS install uninstall)
  add_custom_target(
    ${_mode}-user
    COMMAND
      "${CMAKE_COMMAND}" -D "MODE=${_mode}" -D "BUILD_DIR=${PROJECT_BINARY_DIR}" -D
      "PLUGINS=$<TARGET_FILE_NAME:edit_laplacian_drag>;$<TARGET_FILE_NAME:filter_laplacian_edit>" -D
      "PLUGIN_DIR=${MeshLab_PLUGIN_DIR}" -D "USER_FOLDER=${_user_folder}" -D
      "MESHLAB_VERSION=${MeshLab_VERSION}" -P
      "${CMAKE_CURRENT_LIST_DIR}/package/install_user.cmake"
    VERBATIM)
endforeach()
add_dependencies(install-user edit_laplacian_drag filter_laplacian_edit)
if(TARGET laplacian_edit_command)
  add_dependencies(install-user laplacian_edit_command)
endif()

# The Debian package ---------------------------------------------------------------------------------------------------

find_program(LAPEDIT_DPKG_QUERY dpkg-query)
find_program(LAPEDIT_DPKG_SHLIBDEPS dpkg-shlibdeps)
find_program(LAPEDIT_GZIP gzip)
mark_as_advanced(LAPEDIT_DPKG_QUERY LAPEDIT_DPKG_SHLIBDEPS LAPEDIT_GZIP)
set(_meshlab "")
if(LAPEDIT_DPKG_QUERY)
  execute_process(COMMAND "${LAPEDIT_DPKG_QUERY}" -S "${MeshLab_LIBRARY}" OUTPUT_VARIABLE _owner ERROR_QUIET)
  string(REGEX REPLACE ":.*" "" _owner "${_owner}")
  if(_owner)
    execute_process(COMMAND "${LAPEDIT_DPKG_QUERY}" -W -f "\${Package} (= \${Version})" "${_owner}"
                    OUTPUT_VARIABLE _meshlab ERROR_QUIET)
  endif()
endif()
if(NOT _meshlab)
  set(_obstacle "${MeshLab_LIBRARY} belongs to no installed Debian package")
elseif(NOT LAPEDIT_DPKG_SHLIBDEPS OR NOT LAPEDIT_GZIP)
  set(_obstacle "dpkg-shlibdeps (package dpkg-dev) or gzip is missing")
elseif(LAPEDIT_SANITIZE)
  set(_obstacle "sanitizers are for tests")
else()
  set(_obstacle "")
endif()
if(_obstacle)
  message(STATUS "No package can be made of this build: ${_obstacle}.")
  return()
endif()

set(LAPEDIT_PACKAGE_CONTACT "Laplacian editing for MeshLab developers <developers@laplacian-edit.invalid>"
    CACHE STRING "Maintainer field of the package")
mark_as_advanced(LAPEDIT_PACKAGE_CONTACT)
set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_NAME meshlab-laplacian-edit)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}+meshlab${MeshLab_VERSION}")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_PACKAGE_CONTACT "${LAPEDIT_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Laplacian mesh editing for MeshLab ${MeshLab_VERSION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "Bends a part of a surface by moving one point of it. The surface follows
smoothly, the details on it keep their shape and turn with it, and nothing
outside the chosen part changes.
.
Contains the tool \"Laplacian Drag\" for MeshLab's window, the filters
\"Laplacian Edit\" and \"Laplacian Edit Replay\", and the program laplacian-edit,
which needs no display. It works with the version of MeshLab that it depends
on, and no other.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# The plugins hold inline code of the headers of one build of MeshLab, and objects of its library: no other will do.
# dpkg-shlibdeps adds what the files link to, except for MeshLab's own library, of which its package tells nothing.
get_filename_component(_directory "${MeshLab_LIBRARY}" DIRECTORY)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "${_meshlab}")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${_directory}")
# MeshLab's plugin folder is given as an absolute path, hence DESTDIR; MeshLab looks below /usr only.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# All that has a time in it has that of the release, so that another build gives the same bytes: the changelog here, and by
# cpack_settings.cmake what CPack writes.
execute_process(COMMAND date -u -d "${LAPEDIT_RELEASE_DATE}" +%s OUTPUT_VARIABLE LAPEDIT_RELEASE_TIME
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND date -u -R -d "${LAPEDIT_RELEASE_DATE}" OUTPUT_VARIABLE _date
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
configure_file("${CMAKE_CURRENT_LIST_DIR}/package/cpack_settings.cmake.in" "${_files}/cpack_settings.cmake" @ONLY)
set(CPACK_PROJECT_CONFIG_FILE "${_files}/cpack_settings.cmake")
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/package/same_everywhere.cmake")
set(CPACK_POST_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/package/pack_again.cmake")

# Files of the package alone.
configure_file("${CMAKE_CURRENT_LIST_DIR}/package/changelog.Debian.in" "${_files}/changelog.Debian" @ONLY)
configure_file("${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${_files}/changelog" COPYONLY)
execute_process(COMMAND "${LAPEDIT_GZIP}" -9nkf "${_files}/changelog" "${_files}/changelog.Debian"
                COMMAND_ERROR_IS_FATAL ANY)
if(TARGET laplacian_edit_command)
  configure_file("${PROJECT_SOURCE_DIR}/filter_laplacian_edit/command_line/laplacian-edit.1" "${_files}" COPYONLY)
  execute_process(COMMAND "${LAPEDIT_GZIP}" -9nkf "${_files}/laplacian-edit.1" COMMAND_ERROR_IS_FATAL ANY)
endif()
set(_modes PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
install(
  FILES "${CMAKE_CURRENT_LIST_DIR}/package/lintian-overrides"
  DESTINATION share/lintian/overrides ${_modes} RENAME "${CPACK_PACKAGE_NAME}"
  COMPONENT package EXCLUDE_FROM_ALL)
install(
  FILES "${CMAKE_CURRENT_LIST_DIR}/package/copyright" "${_files}/changelog.gz"
        "${_files}/changelog.Debian.gz"
  DESTINATION "share/doc/${CPACK_PACKAGE_NAME}" ${_modes}
  COMPONENT package EXCLUDE_FROM_ALL)
if(TARGET laplacian_edit_command)
  install(FILES "${_files}/laplacian-edit.1.gz" DESTINATION share/man/man1 ${_modes} COMPONENT package EXCLUDE_FROM_ALL)
endif()
set(_project "${PROJECT_BINARY_DIR}" laplacian_edit)
set(CPACK_INSTALL_CMAKE_PROJECTS ${_project} ALL / ${_project} package /)

include(CPack)
