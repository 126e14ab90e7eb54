# SPDX-License-Identifier: GPL-3.0-or-later
#[[
What `cmake --install` installs besides plugins and program, and the targets

  install-user, uninstall-user     into the user's own folders, without root's rights; not for MeshLab 2020.09

The Debian package is made by common/scripts/debian_package.sh.

Included last: needs the targets, and what FindMeshLab.cmake has found.
]]

# What software centres tell of it. The day is that of the release.
set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS CITATION.cff)
file(STRINGS "${PROJECT_SOURCE_DIR}/CITATION.cff" _date REGEX "^date-released: ")
string(REPLACE "date-released: " "" LAPEDIT_RELEASE_DATE "${_date}")
set(_files "${PROJECT_BINARY_DIR}/package")
set(_metainfo "${_files}/net.meshlab.meshlab.laplacian_edit.metainfo.xml")
configure_file("${CMAKE_CURRENT_LIST_DIR}/package/metainfo.xml.in" "${_metainfo}" @ONLY)
install(FILES "${_metainfo}" DESTINATION share/metainfo)
set(_program "${PROJECT_SOURCE_DIR}/common/cli")
install(FILES "${_program}/laplacian-edit.1" DESTINATION share/man/man1)
install(FILES "${_program}/completion.bash" DESTINATION share/bash-completion/completions RENAME laplacian-edit)

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
add_dependencies(install-user edit_laplacian_drag filter_laplacian_edit laplacian_edit_program)
