// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lapedit/json/json_text.h"

namespace lapedit {

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

void read(const JsonValue& value, bool& flag);   ///< accepts `true` only
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

}  // namespace lapedit
