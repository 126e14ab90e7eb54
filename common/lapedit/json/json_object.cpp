// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_object.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lapedit {
namespace {

void read_numbers(const Json& list, const std::string& where, double* values, int count) {
  if (!list.is_array() || list.size() != static_cast<std::size_t>(count)) {
    refuse_json(where + ": expected a list of " + std::to_string(count) + " numbers, found " + describe(list) + ".");
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_number()) {
      refuse_json(where + "[" + std::to_string(i) + "]: expected a number, found " + describe(list[i]) + ".");
    }
    values[i] = list[i].get<double>();
  }
}

}  // namespace

JsonObject::JsonObject(const Json& value, std::string where, const std::vector<const char*>& known_keys)
    : object_(value), where_(std::move(where)) {
  if (!value.is_object()) {
    refuse_json(where_ + ": expected an object, found " + describe(value) + ".");
  }
  for (const auto& [key, ignored] : object_.get_ref<const Json::object_t&>()) {
    if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      std::string list;
      for (const char* known : known_keys) {
        list += (list.empty() ? "" : ", ") + std::string(known);
      }
      refuse_json(where_ + ": unknown key " + quoted_text(key) + "; known keys are " + list + ".");
    }
  }
}

const Json& JsonObject::operator[](const char* key) const {
  static const Json null;
  const auto found = object_.find(key);
  return found == object_.end() ? null : *found;
}

void JsonObject::refuse_key(const char* key, const std::string& expected) const {
  refuse_json(where(key) + ": expected " + expected + ", " +
              (has(key) ? "found " + describe((*this)[key]) : "but the key is missing") + ".");
}

double JsonObject::number(const char* key, double absent) const {
  if (!has(key)) {
    return absent;
  }
  if (!(*this)[key].is_number()) {
    refuse_key(key, "a number");
  }
  return (*this)[key].get<double>();
}

int JsonObject::integer(const char* key, int absent) const {
  constexpr int kLargest = std::numeric_limits<int>::max();
  const double value = number(key, absent);
  if (value != std::floor(value) || value < 0 || value > kLargest) {
    refuse_key(key, "a whole number from 0 to " + std::to_string(kLargest));
  }
  return static_cast<int>(value);
}

const std::string& JsonObject::text(const char* key) const {
  if (!(*this)[key].is_string()) {
    refuse_key(key, "a text");
  }
  return (*this)[key].get_ref<const std::string&>();
}

const Json& JsonObject::filled_list(const char* key, const char* of_what) const {
  const Json& list = (*this)[key];
  if (!list.is_array() || list.empty()) {
    refuse_key(key, std::string("a list of one or more ") + of_what);
  }
  return list;
}

std::vector<double> JsonObject::number_list(const char* key) const {
  if (!(*this)[key].is_array()) {
    refuse_key(key, "a list of numbers");
  }
  std::vector<double> values((*this)[key].size());
  numbers(key, values.data(), static_cast<int>(values.size()));
  return values;
}

int JsonObject::choice(const char* key, const std::vector<const char*>& names, int absent) const {
  if (!has(key)) {
    return absent;
  }
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if ((*this)[key] == names[i]) {
      return static_cast<int>(i);
    }
    list += (i == 0 ? "\"" : ", \"") + std::string(names[i]) + "\"";
  }
  refuse_key(key, "one of " + list);
}

std::vector<Eigen::Vector3d> JsonObject::point_list(const char* key, const char* of_what) const {
  const Json& list = filled_list(key, of_what);
  std::vector<Eigen::Vector3d> points(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    read_numbers(list[i], where(key) + "[" + std::to_string(i) + "]", points[i].data(), 3);
  }
  return points;
}

void JsonObject::numbers(const char* key, double* values, int count) const {
  if (!has(key)) {
    refuse_key(key, "a list of " + std::to_string(count) + " numbers");
  }
  read_numbers((*this)[key], where(key), values, count);
}

}  // namespace lapedit
