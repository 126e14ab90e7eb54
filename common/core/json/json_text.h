// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/deform/edit_report.h"

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

struct Source;

/// A value together with its location in the text, such as "steps[1].handles[0]". Functions throw an EditError
/// (BadScript) that names the location; they never guess a value. The JSON has to outlive the object.
struct JsonValue {
  const Json& json;  ///< of the type discarded if the key is missing
  std::string where;
  Source* source = nullptr;  ///< shared by all values of a text

  bool has(const char* key) const { return json.contains(key); }
  JsonValue operator[](const char* key) const;
  JsonValue operator[](std::size_t k) const { return {json[k], where + "[" + std::to_string(k) + "]", source}; }

  [[noreturn]] void refuse(const std::string& sentence) const { refuse_json(where + ": " + sentence, where); }
  /// Refuses a value that is missing or of another kind.
  [[noreturn]] void refuse_kind(const std::string& expected) const;
  /// Refuses values that are no objects, and unknown keys. @param former  another key, which messages do not list
  void require_object(const std::vector<const char*>& known_keys, const char* former = "") const;
};

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

void read(const JsonValue& value, bool& flag);
void read(const JsonValue& value, int& number);  ///< from 0 to the largest int
void read(const JsonValue& value, double& number);
void read(const JsonValue& value, std::string& text);
void read(const JsonValue& value, Eigen::Vector3d& vector);
void read(const JsonValue& value, Matrix34& matrix);              ///< 16 numbers by rows; the last row is 0, 0, 0, 1
void read(const JsonValue& value, std::vector<double>& numbers);  ///< of any length
/// Returns what read() reads.
template <class Value>
Value value_of(const JsonValue& value) {
  Value result;
  read(value, result);
  return result;
}
/// Returns the index of a text in a list of names. @throws EditError (BadScript) that lists the names
int read_choice(const JsonValue& value, const std::vector<const char*>& names);

/// Returns a list with an object for each step: the figures of report_table() and `landmarks`.
Json report_json(const std::vector<EditReport>& steps);

}  // namespace lapedit
