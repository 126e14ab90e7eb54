// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any text as an edit: it is read or refused with a sentence, and what was read is written such that it reads the same.
#include <string>

#include "fuzz.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"

using namespace lapedit;

namespace {

/// Ranges of so many vertices that a run would do nothing but write them down: a minus before six digits.
bool has_long_range(const std::string& text) {
  int digits = 6;
  for (const char letter : text) {
    if (letter == '-') {
      digits = 0;
    } else if (letter >= '0' && letter <= '9') {
      if (++digits == 6) return true;
    } else if (letter != ' ') {
      digits = 6;
    }
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (has_long_range(text)) return -1;  // not kept
  std::string written;
  try {
    written = write_edit(read_edit(text));
  } catch (const EditError& error) {
    fuzz::require(error.cause() == ErrorCause::BadScript, "a text is refused as a bad script");
    fuzz::require(std::strlen(error.what()) > 10, "a refusal is a sentence");
    fuzz::require(std::strlen(error.what()) < 1000, "a refusal is no longer than can be read");
    return 0;
  }
  fuzz::require(write_edit(read_edit(written)) == written, "what was written is read as what it was");
  return 0;
}
