# SPDX-License-Identifier: GPL-3.0-or-later
#[[
Finds SuiteSparse's CHOLMOD where no CMake package comes with it (Debian 12).

Result: CHOLMOD_FOUND, CHOLMOD_VERSION, imported target SuiteSparse::CHOLMOD.
]]

find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY)

if(CHOLMOD_INCLUDE_DIR)
  file(GLOB _headers "${CHOLMOD_INCLUDE_DIR}/cholmod*.h")
  set(CHOLMOD_VERSION "")
  foreach(_header IN LISTS _headers)
    foreach(_part IN ITEMS MAIN SUB SUBSUB)
      file(STRINGS "${_header}" _line REGEX "^#define CHOLMOD_${_part}_VERSION[ \t]+[0-9]+")
      if(_line)
        string(REGEX REPLACE ".*VERSION[ \t]+([0-9]+).*" "\\1" _number "${_line}")
        list(APPEND CHOLMOD_VERSION ${_number})
      endif()
    endforeach()
  endforeach()
  list(JOIN CHOLMOD_VERSION "." CHOLMOD_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  CHOLMOD REQUIRED_VARS CHOLMOD_LIBRARY CHOLMOD_INCLUDE_DIR VERSION_VAR CHOLMOD_VERSION)

if(CHOLMOD_FOUND AND NOT TARGET SuiteSparse::CHOLMOD)
  add_library(SuiteSparse::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(
    SuiteSparse::CHOLMOD PROPERTIES IMPORTED_LOCATION "${CHOLMOD_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES
                                                                           "${CHOLMOD_INCLUDE_DIR}")
endif()

# CHOLMOD is as fast as the BLAS that the system's alternatives point to.
find_file(CHOLMOD_BLAS libblas.so.3 PATHS ${CMAKE_SYSTEM_LIBRARY_PATH} /usr/lib PATH_SUFFIXES
                                                                          ${CMAKE_LIBRARY_ARCHITECTURE})
mark_as_advanced(CHOLMOD_BLAS)
if(CHOLMOD_FOUND AND CHOLMOD_BLAS)
  file(REAL_PATH "${CHOLMOD_BLAS}" _blas)
  if(_blas MATCHES "/blas/libblas")
    message(NOTICE "CHOLMOD uses the reference BLAS on this machine, which makes it about five times slower than with "
                   "OpenBLAS (Debian: libopenblas0-pthread).")
  endif()
endif()
