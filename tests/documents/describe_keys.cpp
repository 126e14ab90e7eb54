// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints the session's own table of keys: a line per row, name and sentence apart by a tabulator.
#include <cstdio>

#include "lapedit/session/drag_key.h"

int main() {
  for (const lapedit::KeyHelp& help : lapedit::kKeyHelp) {
    std::printf("%s\t%s\n", help.name, help.does);
  }
}
