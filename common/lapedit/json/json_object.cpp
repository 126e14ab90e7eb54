// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_object.h"

#include <QJsonDocument>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

constexpr std::size_t kDeepestJson = 1024;  // Qt's limit

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::string line_and_column(const QByteArray& json, int offset) {
  const char* const at = json.begin() + std::clamp(offset, 0, json.size());
  const char* const line_start =
      std::find(std::make_reverse_iterator(at), std::make_reverse_iterator(json.begin()), '\n').base();
  const auto is_character = [](char c) { return (c & 0xC0) != 0x80; };  // not a later byte of a UTF-8 sequence
  return "line " + std::to_string(std::count(json.begin(), at, '\n') + 1) + ", column " +
         std::to_string(std::count_if(line_start, at, is_character) + 1);
}

/// Qt silently takes the last of two equal keys (and leaks the others' contents). Looked for before Qt reads the text,
/// so that it may be anything; what is no JSON is left to Qt.
void refuse_repeated_keys(const QByteArray& json) {
  std::vector<std::set<QByteArray>> keys;  // of the objects that are open
  for (const char* at = json.begin(); at != json.end() && keys.size() <= kDeepestJson; ++at) {
    if (*at == '{') {
      keys.emplace_back();
    } else if (*at == '}' && !keys.empty()) {
      keys.pop_back();
    } else if (*at == '"') {
      const char* const start = at;
      for (++at; at != json.end() && *at != '"'; ++at) {
        at += *at == '\\' && at + 1 != json.end();
      }
      if (at == json.end()) {
        return;
      }
      const char* const next = std::find_if_not(at + 1, json.end(), is_space);
      if (next == json.end() || *next != ':' || keys.empty()) {
        continue;
      }
      QByteArray key(start + 1, static_cast<int>(at - start - 1));
      if (key.contains('\\')) {  // Qt undoes the escapes
        key = QJsonDocument::fromJson("[\"" + key + "\"]").array()[0].toString().toUtf8();
      }
      if (!keys.back().insert(key).second) {
        refuse_json("At " + line_and_column(json, static_cast<int>(start - json.begin())) + ": the key " +
                    quoted(QString::fromUtf8(key)) + " is given twice in one object; keep one of the two.");
      }
    }
  }
}

}  // namespace

void refuse_json(const std::string& sentence) {
  throw EditError(ErrorCause::BadScript, sentence);
}

QByteArray to_json(const QJsonValue& value) {
  const QByteArray list = QJsonDocument(QJsonArray{value}).toJson(QJsonDocument::Compact);
  return list.mid(1, list.size() - 2);
}

std::string quoted(const QString& text) {
  constexpr int kLongest = 60;
  return to_json(text.size() <= kLongest ? text : text.left(kLongest) + QLatin1String("...")).toStdString();
}

std::string describe(const QJsonValue& value) {
  switch (value.type()) {
    case QJsonValue::Bool:
      return value.toBool() ? "true" : "false";
    case QJsonValue::Double:
      return "the number " + to_json(value).toStdString();
    case QJsonValue::String:
      return "the text " + quoted(value.toString());
    case QJsonValue::Array:
      return "a list of length " + std::to_string(value.toArray().size());
    case QJsonValue::Object:
      return "an object";
    default:
      return "null";
  }
}

QJsonObject parse_json(QByteArray json) {
  if (json.size() > kLargestJson) {
    refuse_json("The edit is a text of " + std::to_string(json.size()) + " bytes; the limit is " +
                std::to_string(kLargestJson) + ".");
  }
  if (json.startsWith("\xEF\xBB\xBF")) {
    json.remove(0, 3);
  }
  if (std::all_of(json.begin(), json.end(), is_space)) {
    refuse_json("The edit is an empty text; give a JSON object.");
  }
  refuse_repeated_keys(json);
  QJsonParseError error;
  const QJsonDocument document = QJsonDocument::fromJson(json, &error);
  if (error.error == QJsonParseError::DeepNesting) {
    refuse_json("The edit nests lists or objects more than " + std::to_string(kDeepestJson) +
                " deep; a valid one nests them 6 deep.");
  }
  if (error.error != QJsonParseError::NoError) {
    refuse_json("Near " + line_and_column(json, error.offset - 1) + ": the edit is not valid JSON (" +
                error.errorString().toStdString() + ").");
  }
  if (!document.isObject()) {
    refuse_json("The edit is a JSON list; it has to be an object.");
  }
  return document.object();
}

JsonObject::JsonObject(const QJsonValue& value, std::string where, const std::vector<const char*>& known_keys)
    : object_(value.toObject()), where_(std::move(where)) {
  if (!value.isObject()) {
    refuse_json(where_ + ": expected an object, found " + describe(value) + ".");
  }
  for (const QString& key : object_.keys()) {
    const auto same = [&](const char* known) { return key == QLatin1String(known); };
    if (std::none_of(known_keys.begin(), known_keys.end(), same)) {
      std::string list;
      for (const char* known : known_keys) {
        list += (list.empty() ? "" : ", ") + std::string(known);
      }
      refuse_json(where_ + ": unknown key " + quoted(key) + "; known keys are " + list + ".");
    }
  }
}

void JsonObject::refuse_key(const char* key, const std::string& expected) const {
  refuse_json(where(key) + ": expected " + expected + ", " +
              (has(key) ? "found " + describe((*this)[key]) : "but the key is missing") + ".");
}

double JsonObject::number(const char* key, double absent) const {
  if (!has(key)) {
    return absent;
  }
  if (!(*this)[key].isDouble()) {
    refuse_key(key, "a number");
  }
  return (*this)[key].toDouble();
}

int JsonObject::integer(const char* key, int absent) const {
  constexpr int kLargest = std::numeric_limits<int>::max();
  const double value = number(key, absent);
  if (value != std::floor(value) || value < 0 || value > kLargest) {
    refuse_key(key, "a whole number from 0 to " + std::to_string(kLargest));
  }
  return static_cast<int>(value);
}

QString JsonObject::text(const char* key) const {
  if (!(*this)[key].isString()) {
    refuse_key(key, "a text");
  }
  return (*this)[key].toString();
}

QJsonArray JsonObject::filled_list(const char* key, const char* of_what) const {
  QJsonArray list = (*this)[key].toArray();
  if (list.isEmpty()) {
    refuse_key(key, std::string("a list of one or more ") + of_what);
  }
  return list;
}

std::vector<double> JsonObject::number_list(const char* key) const {
  if (!(*this)[key].isArray()) {
    refuse_key(key, "a list of numbers");
  }
  std::vector<double> values(static_cast<std::size_t>((*this)[key].toArray().size()));
  numbers(key, values.data(), static_cast<int>(values.size()));
  return values;
}

int JsonObject::choice(const char* key, const std::vector<const char*>& names, int absent) const {
  if (!has(key)) {
    return absent;
  }
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if ((*this)[key] == QJsonValue(QLatin1String(names[i]))) {
      return static_cast<int>(i);
    }
    list += (i == 0 ? "\"" : ", \"") + std::string(names[i]) + "\"";
  }
  refuse_key(key, "one of " + list);
}

void JsonObject::numbers(const char* key, double* values, int count) const {
  const QJsonArray list = (*this)[key].toArray();
  if (list.size() != count) {
    refuse_key(key, "a list of " + std::to_string(count) + " numbers");
  }
  for (int i = 0; i < count; ++i) {
    if (!list[i].isDouble()) {
      refuse_json(where(key) + "[" + std::to_string(i) + "]: expected a number, found " + describe(list[i]) + ".");
    }
    values[i] = list[i].toDouble();
  }
}

}  // namespace lapedit
