# SPDX-License-Identifier: GPL-3.0-or-later
#
# Python, and the headers that pip installs for the build of the Python package: Eigen's and those of nlohmann's JSON. Where
# they are missing, the system's are taken.
if(LAPEDIT_TARGET_PYTHON)
  # Another system's Python, of which common/scripts/build_wheels.sh gives this folder of headers and import libraries, the
  # version, and the ends of the modules' names. CMake's own search would find the one that runs this build.
  set(Python_VERSION "${LAPEDIT_TARGET_PYTHON_VERSION}")
  set(Python_INTERPRETER_ID Python)
  set(Python_INCLUDE_DIRS "${LAPEDIT_TARGET_PYTHON}")
  set(SKBUILD_SOABI "")
  set(NB_SUFFIX "${LAPEDIT_TARGET_PYTHON_SUFFIX}")
  set(NB_SUFFIX_S "${LAPEDIT_TARGET_PYTHON_SUFFIX}")
  add_executable(Python::Interpreter IMPORTED GLOBAL)
  foreach(target IN ITEMS Module SABIModule)
    add_library(Python::${target} INTERFACE IMPORTED GLOBAL)
    target_link_libraries(Python::${target} INTERFACE ${LAPEDIT_TARGET_PYTHON_LIBRARY})
  endforeach()
else()
  find_package(Python 3.8 REQUIRED COMPONENTS Interpreter Development.Module OPTIONAL_COMPONENTS Development.SABIModule)
endif()
foreach(folder IN LISTS CMAKE_PREFIX_PATH)
  if(EXISTS "${folder}/cmeel.prefix")
    list(PREPEND CMAKE_PREFIX_PATH "${folder}/cmeel.prefix")
  endif()
  set(include "${folder}/nlohmann_json/include")
  if(EXISTS "${include}/nlohmann/json.hpp" AND NOT TARGET nlohmann_json::nlohmann_json)
    add_library(nlohmann_json::nlohmann_json INTERFACE IMPORTED GLOBAL)
    target_include_directories(nlohmann_json::nlohmann_json SYSTEM INTERFACE "${include}")
  endif()
endforeach()
