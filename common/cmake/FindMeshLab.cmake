# SPDX-License-Identifier: GPL-3.0-or-later
#[[
Finds the installed MeshLab and the headers that belong to it.

Result:
  MeshLab_FOUND, MeshLab_VERSION (of the headers)
  MeshLab_API         generation of the plugin interface: 2020 or 2022, decided by the headers
  MeshLab_APIS        folders of common/meshlab/ that hold the adapter, without "api_"
  MeshLab::common     imported target: library, headers, Qt and OpenGL

Cache variables:
  MESHLAB_SOURCE_DIR  an unpacked MeshLab source tarball; set it to use that instead of fetching one
  MeshLab_PLUGIN_DIR  where the installed MeshLab looks for plugins
  MeshLab_SCALAR      float (what distributions ship) or double: as the library has it, and it has to be that
]]

set(MESHLAB_SOURCE_DIR "" CACHE PATH "Unpacked MeshLab source of the installed version; empty: fetched by apt")

find_library(MeshLab_LIBRARY meshlab-common PATH_SUFFIXES meshlab)
mark_as_advanced(MeshLab_LIBRARY)
set(_scalar float)
if(MeshLab_LIBRARY)
  if(NOT EXISTS "${MeshLab_LIBRARY}")
    message(FATAL_ERROR "MeshLab_LIBRARY is ${MeshLab_LIBRARY}, where there is no file: give the path of "
                        "libmeshlab-common.so.")
  endif()
  # The name of a function that takes a matrix of coordinates, as the linker has it.
  file(STRINGS "${MeshLab_LIBRARY}" _name LIMIT_COUNT 1
       REGEX "setSceneTransformationMatrixERKN3vcg8Matrix44I[fd]EE")
  if(_name MATCHES "Matrix44IdE")
    set(_scalar double)
  elseif(NOT _name)
    message(WARNING "${MeshLab_LIBRARY} does not tell whether its coordinates are float or double.")
  endif()
endif()
set(MeshLab_SCALAR "${_scalar}" CACHE STRING "Coordinate type that the installed MeshLab was built with")
set_property(CACHE MeshLab_SCALAR PROPERTY STRINGS float double)
mark_as_advanced(MeshLab_SCALAR)
if(_name AND NOT MeshLab_SCALAR STREQUAL _scalar)
  message(FATAL_ERROR "MeshLab_SCALAR is ${MeshLab_SCALAR}, but ${MeshLab_LIBRARY} has coordinates in ${_scalar}: give "
                      "-DMeshLab_SCALAR=${_scalar}, or another MeshLab_LIBRARY.")
endif()
find_package(Qt5 5.11 COMPONENTS Core Gui Widgets OpenGL Xml QUIET)
find_package(OpenGL COMPONENTS OpenGL QUIET)
find_package(GLEW QUIET)

if(MeshLab_LIBRARY AND Qt5_FOUND AND OpenGL_FOUND AND OPENGL_GLU_FOUND AND GLEW_FOUND)
  set(MeshLab_ROOT_DIR "${MESHLAB_SOURCE_DIR}")
  if(NOT MeshLab_ROOT_DIR)
    include(FetchMeshLabSource)
    fetch_meshlab_source(LIBRARY "${MeshLab_LIBRARY}" DIRECTORY "${PROJECT_BINARY_DIR}/meshlab-source" RESULT
                         MeshLab_ROOT_DIR)
    if(NOT MeshLab_ROOT_DIR)
      message(FATAL_ERROR "MeshLab is installed, but its headers could not be had: ${MeshLab_ROOT_DIR_MESSAGE}\n"
                          "Unpack the source of the installed version and give its folder with "
                          "-DMESHLAB_SOURCE_DIR=..., or build the core alone with -DLAPEDIT_WITH_MESHLAB=OFF.")
    endif()
  endif()
  find_path(MeshLab_VCG_DIR vcg/complex/complex.h PATHS "${MeshLab_ROOT_DIR}/vcglib" "${MeshLab_ROOT_DIR}/src/vcglib"
            NO_DEFAULT_PATH NO_CACHE)
  if(EXISTS "${MeshLab_ROOT_DIR}/src/common/interfaces.h")
    set(MeshLab_API 2020)
    set(MeshLab_APIS 2020)
  elseif(EXISTS "${MeshLab_ROOT_DIR}/src/common/plugins/interfaces/filter_plugin.h")
    set(MeshLab_API 2022)
    # The kinds of parameters changed with 2023.12.
    if(EXISTS "${MeshLab_ROOT_DIR}/src/common/parameters/values.h")
      set(MeshLab_APIS 2022 2022/parameters_2025)
    else()
      set(MeshLab_APIS 2022 2022/parameters_2022)
    endif()
  endif()
  if(NOT MeshLab_VCG_DIR OR NOT MeshLab_API OR NOT EXISTS "${MeshLab_ROOT_DIR}/ML_VERSION")
    message(FATAL_ERROR "${MeshLab_ROOT_DIR} is not a complete MeshLab source: ML_VERSION, src/common with its plugin "
                        "interfaces and vcglib are needed.")
  endif()
  file(STRINGS "${MeshLab_ROOT_DIR}/ML_VERSION" MeshLab_VERSION LIMIT_COUNT 1)
  # With double precision its version ends with d; the H is the compiler's.
  file(STRINGS "${MeshLab_LIBRARY}" _versions REGEX "^20[0-9][0-9][.][0-9][0-9]d?H?$")
  string(REGEX REPLACE "[dH]" "" _versions "${_versions}")
  list(REMOVE_DUPLICATES _versions)
  if(NOT _versions)
    message(WARNING "${MeshLab_LIBRARY} does not tell its version: that it is ${MeshLab_VERSION}, as the headers are, is "
                    "not checked.")
  elseif(NOT MeshLab_VERSION IN_LIST _versions)
    list(JOIN _versions ", " _versions)
    message(FATAL_ERROR "The headers in ${MeshLab_ROOT_DIR} are MeshLab ${MeshLab_VERSION}'s, but ${MeshLab_LIBRARY} is "
                        "of MeshLab ${_versions}: give that version's source with -DMESHLAB_SOURCE_DIR=..., or another "
                        "MeshLab_LIBRARY.")
  endif()
  cmake_path(GET MeshLab_LIBRARY PARENT_PATH _directory)
  set(MeshLab_PLUGIN_DIR "${_directory}/plugins" CACHE PATH "Where MeshLab looks for plugins, and ours are installed")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  MeshLab
  REQUIRED_VARS MeshLab_LIBRARY Qt5_FOUND OPENGL_GLU_FOUND GLEW_FOUND MeshLab_API
  VERSION_VAR MeshLab_VERSION)

add_feature_info("MeshLab ${MeshLab_VERSION}" MeshLab_FOUND "coordinates in ${MeshLab_SCALAR}, ${MeshLab_LIBRARY}")

if(MeshLab_FOUND AND NOT TARGET MeshLab::common)
  add_library(MeshLab::common SHARED IMPORTED)
  set_target_properties(MeshLab::common PROPERTIES IMPORTED_LOCATION "${MeshLab_LIBRARY}")
  # Of an imported target these are system headers: no warnings from them.
  target_include_directories(MeshLab::common INTERFACE "${MeshLab_ROOT_DIR}/src" "${MeshLab_VCG_DIR}")
  target_compile_definitions(MeshLab::common INTERFACE MESHLAB_SCALAR=${MeshLab_SCALAR})
  if(NOT MeshLab_API EQUAL 2020)
    target_compile_definitions(MeshLab::common INTERFACE MESHLAB_VERSION=${MeshLab_VERSION})
  endif()
  target_link_libraries(MeshLab::common INTERFACE Eigen3::Eigen Qt5::Core Qt5::Gui Qt5::Widgets Qt5::OpenGL Qt5::Xml
                                                  OpenGL::GL OpenGL::GLU)
endif()
