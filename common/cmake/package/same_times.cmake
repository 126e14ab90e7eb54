# SPDX-License-Identifier: GPL-3.0-or-later
# Run by CPack before it packs: gives all of it the time SOURCE_DATE_EPOCH.
execute_process(COMMAND find "${CPACK_TEMPORARY_DIRECTORY}" -exec touch -h -d "@$ENV{SOURCE_DATE_EPOCH}" {} +
                COMMAND_ERROR_IS_FATAL ANY)
