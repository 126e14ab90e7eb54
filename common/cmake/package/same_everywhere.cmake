# SPDX-License-Identifier: GPL-3.0-or-later
# Run by CPack before it packs: folders get the usual permissions, whatever the builder's umask, and all gets the time
# SOURCE_DATE_EPOCH.
execute_process(COMMAND find "${CPACK_TEMPORARY_DIRECTORY}" -type d -exec chmod 755 {} + COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND find "${CPACK_TEMPORARY_DIRECTORY}" -exec touch -h -d "@$ENV{SOURCE_DATE_EPOCH}" {} +
                COMMAND_ERROR_IS_FATAL ANY)
