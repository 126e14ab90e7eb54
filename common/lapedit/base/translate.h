// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

/// Marks a sentence that users read for translators, as Qt's QT_TRANSLATE_NOOP does, and changes nothing of it:
/// `lupdate -tr-function-alias QT_TRANSLATE_NOOP+=LAPEDIT_TEXT` finds it, under the context given, which is "lapedit"
/// everywhere.
#define LAPEDIT_TEXT(context, sentence) sentence

namespace lapedit {

/// From an English sentence to the user's; gives back what it does not know.
using Translator = std::function<std::string(const char*)>;

/// What translated() asks from now on; nothing: sentences stay English, as they are without a call of this.
void set_translator(Translator translator);

/// A marked sentence in the user's language. One for format_text() stays English unless its conversions are the same,
/// in the same order. From any thread; O(length).
/// @return the argument, or what stays valid until the next set_translator()
#if defined(__GNUC__)
__attribute__((format_arg(1)))
#endif
const char*
translated(const char* sentence);

}  // namespace lapedit
