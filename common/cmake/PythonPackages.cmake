# SPDX-License-Identifier: GPL-3.0-or-later
#
# Python, and the headers that pip installs for the build of the Python package: Eigen's and those of nlohmann's JSON. Where
# they are missing, the system's are taken.
find_package(Python 3.8 REQUIRED COMPONENTS Interpreter Development.Module OPTIONAL_COMPONENTS Development.SABIModule)
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
