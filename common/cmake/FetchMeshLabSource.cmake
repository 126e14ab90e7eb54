# SPDX-License-Identifier: GPL-3.0-or-later

# MeshLab installs no headers. This gets the upstream tarball of the installed package's Debian source package, with a
# private apt configuration: the machine's own sources, each taken as a deb-src entry. The system's apt is not touched.
#
# fetch_meshlab_source(LIBRARY <a file of the installed package> DIRECTORY <where> RESULT <variable>)
# The result is the source folder, or <variable>-NOTFOUND with a sentence in <variable>_MESSAGE.
function(fetch_meshlab_source)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "LIBRARY;DIRECTORY;RESULT" "")
  set(${arg_RESULT} "${arg_RESULT}-NOTFOUND" PARENT_SCOPE)

  find_program(LAPEDIT_DPKG_QUERY dpkg-query)
  find_program(LAPEDIT_APT_GET apt-get)
  mark_as_advanced(LAPEDIT_DPKG_QUERY LAPEDIT_APT_GET)
  if(NOT LAPEDIT_DPKG_QUERY OR NOT LAPEDIT_APT_GET)
    set(${arg_RESULT}_MESSAGE "this machine has no dpkg-query and apt-get to get them with" PARENT_SCOPE)
    return()
  endif()

  execute_process(COMMAND "${LAPEDIT_DPKG_QUERY}" -S "${arg_LIBRARY}" OUTPUT_VARIABLE owner ERROR_QUIET)
  string(REGEX REPLACE ":.*" "" package "${owner}")
  execute_process(
    COMMAND "${LAPEDIT_DPKG_QUERY}" -W -f "\${source:Package}=\${source:Version}" "${package}"
    OUTPUT_VARIABLE source ERROR_QUIET)
  if(NOT source MATCHES "=.")
    set(${arg_RESULT}_MESSAGE "${arg_LIBRARY} belongs to no installed Debian package" PARENT_SCOPE)
    return()
  endif()

  string(REGEX REPLACE "[^A-Za-z0-9.+~-]" "_" folder "${source}")
  set(root "${arg_DIRECTORY}/${folder}")
  file(GLOB tarball "${root}/*.orig.tar.*")
  if(NOT tarball)
    message(STATUS "Getting the headers of ${source} from its Debian source package")
    _lapedit_write_apt_configuration("${root}/apt")
    set(ENV{LC_ALL} C.UTF-8)
    execute_process(
      COMMAND "${LAPEDIT_APT_GET}" -c "${root}/apt/apt.conf" -q update TIMEOUT 600
      OUTPUT_VARIABLE update_log ERROR_VARIABLE update_log)
    # One unreachable source among several fails the update; what counts is whether the tarball can be had.
    execute_process(
      COMMAND "${LAPEDIT_APT_GET}" -c "${root}/apt/apt.conf" -q source --download-only --tar-only "${source}" TIMEOUT 600
      WORKING_DIRECTORY "${root}" OUTPUT_VARIABLE source_log ERROR_VARIABLE source_log)
    file(GLOB tarball "${root}/*.orig.tar.*")
    file(REMOVE_RECURSE "${root}/apt")
    if(NOT tarball)
      string(CONCAT message "apt-get source ${source} failed (is the mirror of this machine's apt sources reachable, and "
                    "does it still have this version?):\n${update_log}\n${source_log}")
      set(${arg_RESULT}_MESSAGE "${message}" PARENT_SCOPE)
      return()
    endif()
  endif()

  # The headers of the application itself are needed by tools in its window.
  file(GLOB unpacked "${root}/unpacked/*/src/meshlab/glarea.h")
  if(NOT unpacked)
    file(REMOVE_RECURSE "${root}/unpacked")
    file(ARCHIVE_EXTRACT INPUT "${tarball}" DESTINATION "${root}/unpacked" PATTERNS "*/ML_VERSION" "*/src/common/*"
         "*/src/meshlab/*.h" "*/vcglib/*")
  endif()
  file(GLOB unpacked "${root}/unpacked/*/ML_VERSION")
  if(NOT unpacked)
    set(${arg_RESULT}_MESSAGE "${tarball} is not a MeshLab source tarball" PARENT_SCOPE)
    return()
  endif()
  cmake_path(GET unpacked PARENT_PATH folder)
  set(${arg_RESULT} "${folder}" PARENT_SCOPE)
endfunction()

function(_lapedit_write_apt_configuration root)
  file(REMOVE_RECURSE "${root}")
  file(MAKE_DIRECTORY "${root}/sources" "${root}/lists/partial" "${root}/cache/archives/partial")
  file(GLOB one_line /etc/apt/sources.list /etc/apt/sources.list.d/*.list)
  file(GLOB deb822 /etc/apt/sources.list.d/*.sources)
  foreach(file IN LISTS one_line)
    cmake_path(GET file FILENAME name)
    file(READ "${file}" text)
    string(REGEX REPLACE "(^|\n)[ \t]*deb([ \t])" "\\1deb-src\\2" text "${text}")
    file(WRITE "${root}/sources/${name}" "${text}")
  endforeach()
  foreach(file IN LISTS deb822)
    cmake_path(GET file FILENAME name)
    file(READ "${file}" text)
    string(REGEX REPLACE "(^|\n)Types:[^\n]*" "\\1Types: deb-src" text "${text}")
    file(WRITE "${root}/sources/${name}" "${text}")
  endforeach()
  # The update hooks of some machines clean the system's own caches: not our business here.
  file(WRITE "${root}/apt.conf" "\
Dir::Etc::sourcelist \"/dev/null\";
Dir::Etc::sourceparts \"${root}/sources\";
Dir::State::lists \"${root}/lists\";
Dir::Cache \"${root}/cache\";
APT::Sandbox::User \"root\";
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
")
endfunction()
