# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Completes the options of laplacian-edit, which are those of its --help, and file names.
_laplacian_edit() {
  local word=${COMP_WORDS[COMP_CWORD]} words=
  [[ $word != -* ]] || words=$("$1" --help 2>/dev/null | grep -oE '^ *-[^ ]*(, --[a-z-]+)?' | tr -d ' ' | tr , '\n')
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o bashdefault -o default -F _laplacian_edit laplacian-edit
