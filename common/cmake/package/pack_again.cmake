# SPDX-License-Identifier: GPL-3.0-or-later
# Run by CPack when it has packed: packs again with Debian's own tool, as CPack lets the builder's umask into the package.
set(folder "${CPACK_TEMPORARY_DIRECTORY}.again")
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  file(REMOVE_RECURSE "${folder}")
  execute_process(COMMAND dpkg-deb --raw-extract "${package}" "${folder}" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND chmod 755 "${folder}" "${folder}/DEBIAN" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND dpkg-deb --root-owner-group -Zxz --build "${folder}" "${package}" OUTPUT_QUIET
                  COMMAND_ERROR_IS_FATAL ANY)
endforeach()
