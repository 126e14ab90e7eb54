# SPDX-License-Identifier: GPL-3.0-or-later
#
# Writes a file for ctest with a test for each suite of a test program: all tests of a suite run in one process.
#
# usage: cmake -DPROGRAM=<program> -DFILE=<file to write> -DLABEL=<label> -DENVIRONMENT=<variables> -DSKIPPED=<tests>
#              -P suites.cmake
#   SKIPPED   tests that are not run, as in --gtest_filter

execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\r" "" listed "${listed}")
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+[.]" suites "${listed}")
string(REPLACE ";" " " program "${PROGRAM}")
set(text "")
if(SKIPPED)
  set(skipped "-${SKIPPED}")
endif()
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  string(APPEND text "add_test([=[${suite}]=] ${program} --gtest_filter=${suite}.*${skipped})\n"
                     "set_tests_properties([=[${suite}]=] PROPERTIES LABELS ${LABEL} TIMEOUT 900 ENVIRONMENT [=[${ENVIRONMENT}]=])\n")
endforeach()
file(WRITE "${FILE}" "${text}")
