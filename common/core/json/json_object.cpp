// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_object.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapedit {
namespace {

void read_numbers(const JsonValue& value, double* numbers, std::size_t count) {
  if (!value.json.is_array() || value.json.size() != count) {
    value.refuse_kind("a list of " + std::to_string(count) + " numbers");
  }
  for (std::size_t k = 0; k < count; ++k) {
    read(value[k], numbers[k]);
  }
}

}  // namespace

JsonValue JsonValue::operator[](const char* key) const {
  static const Json missing(Json::value_t::discarded);
  const auto found = json.find(key);
  return {found == json.end() ? missing : *found, where.empty() || where == "edit" ? key : where + "." + key, source};
}

void JsonValue::refuse_kind(const std::string& expected) const {
  refuse("expected " + expected + ", " + (json.is_discarded() ? "but the key is missing" : "found " + describe(json)) +
         ".");
}

void JsonValue::require_object(const std::vector<const char*>& known_keys, const char* former) const {
  if (!json.is_object()) {
    refuse_kind("an object");
  }
  for (const auto& [key, ignored] : json.get_ref<const Json::object_t&>()) {
    if (key != former && std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      std::string list;
      for (const char* known : known_keys) {
        list += (list.empty() ? "" : ", ") + std::string(known);
      }
      refuse("unknown key " + quoted_text(key) + "; known keys are " + list + ".");
    }
  }
}

void read(const JsonValue& value, bool& flag) {
  if (!(value.json == true)) {
    value.refuse_kind("true");
  }
  flag = true;
}

void read(const JsonValue& value, int& number) {
  constexpr int kLargest = std::numeric_limits<int>::max();
  const auto real = value_of<double>(value);
  if (real != std::floor(real) || real < 0 || real > kLargest) {
    value.refuse_kind("a whole number from 0 to " + std::to_string(kLargest));
  }
  number = static_cast<int>(real);
}

void read(const JsonValue& value, double& number) {
  if (!value.json.is_number()) {
    value.refuse_kind("a number");
  }
  number = value.json.get<double>();
}

void read(const JsonValue& value, std::string& text) {
  if (!value.json.is_string()) {
    value.refuse_kind("a text");
  }
  text = value.json.get_ref<const std::string&>();
}

void read(const JsonValue& value, Eigen::Vector3d& vector) {
  read_numbers(value, vector.data(), 3);
}

void read(const JsonValue& value, Matrix34& matrix) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> whole;
  read_numbers(value, whole.data(), 16);
  if (whole.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    value.refuse("the last row (the last four numbers) has to be 0, 0, 0, 1.");
  }
  matrix = whole.topRows<3>();
}

void read(const JsonValue& value, std::vector<double>& numbers) {
  if (!value.json.is_array()) {
    value.refuse_kind("a list of numbers");
  }
  numbers.resize(value.json.size());
  read_numbers(value, numbers.data(), numbers.size());
}

int read_choice(const JsonValue& value, const std::vector<const char*>& names) {
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (value.json == names[k]) {
      return static_cast<int>(k);
    }
    list += (k == 0 ? "\"" : ", \"") + std::string(names[k]) + "\"";
  }
  value.refuse_kind("one of " + list);
}

}  // namespace lapedit
