// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lapedit/json/json_text.h"

namespace lapedit {

/// An object together with its location in the text, such as "steps[1].handles[0]". Nothing is guessed, and each
/// EditError (BadScript) names the location. The value has to outlive the object.
class JsonObject {
 public:
  /// Refuses values that are no objects, and unknown keys.
  JsonObject(const Json& value, std::string where, const std::vector<const char*>& known_keys);

  const std::string& where() const { return where_; }
  std::string where(const char* key) const { return where_ + "." + key; }
  bool has(const char* key) const { return object_.contains(key); }
  const Json& operator[](const char* key) const;  ///< null where the key is missing

  [[noreturn]] void refuse_key(const char* key, const std::string& expected) const;

  double number(const char* key, double absent) const;
  int integer(const char* key, int absent) const;  ///< from 0 to the largest int
  const std::string& text(const char* key) const;
  const Json& filled_list(const char* key, const char* of_what) const;  ///< one entry or more

  std::vector<double> number_list(const char* key) const;                               ///< of any length
  std::vector<Eigen::Vector3d> point_list(const char* key, const char* of_what) const;  ///< one point or more

  template <int N>
  Eigen::Matrix<double, N, 1> numbers(const char* key) const {
    Eigen::Matrix<double, N, 1> result;
    numbers(key, result.data(), N);
    return result;
  }

  /// The number of the name that is given.
  int choice(const char* key, const std::vector<const char*>& names, int absent) const;

 private:
  void numbers(const char* key, double* values, int count) const;

  const Json& object_;
  std::string where_;
};

}  // namespace lapedit
