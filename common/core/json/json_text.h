// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lapedit/base/error.h"

/// Reads JSON from users' files, and formats values for messages.
namespace lapedit {

/// Objects keep the order of their keys.
using Json = nlohmann::ordered_json;

constexpr std::size_t kLargestJson = 64 << 20;  ///< bytes; seven million vertex numbers fit

/// @throws EditError (BadScript)
[[noreturn]] void refuse_json(const std::string& sentence, const std::string& key = {});

/// Calls read(), and adds a location to the message of an EditError that it throws.
template <class Read>
auto refused_at(const std::string& where, const Read& read) {
  try {
    return read();
  } catch (const EditError& refusal) {
    throw EditError(refusal.cause(), where + ": " + refusal.what(), refusal.vertex()).at(refusal.key());
  }
}

/// Returns whether a text seems to be in UTF-16: it has a byte order mark, or each second one of its first bytes is 0.
bool is_utf16(const std::string& text);

/// Returns the object in a UTF-8 text, with or without a byte order mark.
/// @throws EditError (BadScript) for invalid JSON, with line and column; for a key that is given twice in an object;
///         for texts of more than kLargestJson bytes, objects of more than 100 keys, and values more than 1,024 deep
/// Cost: O(n log k) for n bytes with at most k keys in an object
Json parse_json(std::string json);

/// Returns the text without white space at its ends.
std::string trimmed(const std::string& text, const char* space = " \t\n\v\f\r");

/// Returns a user's text for a message: quoted, shortened, with control characters escaped.
std::string quoted_text(const std::string& text, int most_characters = 60);

/// Returns the description of a value for a message, such as "the number 3" or "a list of length 2".
std::string describe(const Json& value);

}  // namespace lapedit
