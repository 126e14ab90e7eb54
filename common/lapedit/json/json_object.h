// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <QByteArray>
#include <QJsonArray>
#include <QJsonObject>
#include <QString>
#include <string>
#include <vector>

/// Reading JSON that a person wrote: nothing is guessed, and each complaint says where it is. All functions throw
/// EditError (BadScript).
namespace lapedit {

constexpr qint64 kLargestJson = 64 << 20;  ///< bytes; seven million vertex numbers fit

[[noreturn]] void refuse_json(const std::string& sentence);

/// A value as compact JSON text. Qt prints the shortest number that reads back as the same double; only a zero's sign
/// is lost.
QByteArray to_json(const QJsonValue& value);

/// Text from outside, made fit for a message: quoted, control characters escaped, not too long.
std::string quoted(const QString& text);

/// What a value is, for a message: "the number 3", "a list of length 2".
std::string describe(const QJsonValue& value);

/// The object that a UTF-8 text (with or without a byte order mark) holds. Refuses what is no JSON, a key that is given
/// twice in an object, and texts of more than kLargestJson bytes.
QJsonObject parse_json(QByteArray json);

/// An object together with its place in the text, such as "steps[1].handles[0]".
class JsonObject {
 public:
  /// Refuses what is no object, and keys that are not known.
  JsonObject(const QJsonValue& value, std::string where, const std::vector<const char*>& known_keys);

  const std::string& where() const { return where_; }
  std::string where(const char* key) const { return where_ + "." + key; }
  bool has(const char* key) const { return object_.contains(QLatin1String(key)); }
  QJsonValue operator[](const char* key) const { return object_[QLatin1String(key)]; }

  [[noreturn]] void refuse_key(const char* key, const std::string& expected) const;

  double number(const char* key, double absent) const;
  int integer(const char* key, int absent) const;  ///< from 0 to the largest int
  QString text(const char* key) const;
  QJsonArray filled_list(const char* key, const char* of_what) const;  ///< one entry or more

  std::vector<double> number_list(const char* key) const;  ///< of any length

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

  QJsonObject object_;
  std::string where_;
};

}  // namespace lapedit
