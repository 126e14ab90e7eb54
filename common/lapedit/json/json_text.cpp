// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

constexpr std::size_t kDeepest = 1024;

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::string line_and_column(const std::string& json, std::size_t offset) {
  const char* const at = json.data() + std::min(offset, json.size());
  const char* const line_start =
      std::find(std::make_reverse_iterator(at), std::make_reverse_iterator(json.data()), '\n').base();
  const auto is_character = [](char c) { return (c & 0xC0) != 0x80; };  // not a later byte of a UTF-8 sequence
  return "line " + std::to_string(std::count(json.data(), at, '\n') + 1) + ", column " +
         std::to_string(std::count_if(line_start, at, is_character) + 1);
}

/// Bytes for the parser. It knows for itself only where it failed; this tells where it is.
class Cursor {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Cursor(const char* at, const char** reached) : at_(at), reached_(reached) {}
  /// Inside a text a raw line break or tab counts as a space: long lists of vertices are broken into lines.
  char operator*() const { return is_space(*at_) ? ' ' : *at_; }
  Cursor& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  bool operator==(const Cursor& other) const { return at_ == other.at_; }
  bool operator!=(const Cursor& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** reached_;
};

/// Builds the value. The library's own builder takes the last of two equal keys, looks for them one by one, and reads
/// as deep as the text goes.
class Builder : public nlohmann::json_sax<Json> {
 public:
  explicit Builder(const std::string& json) : json_(json), reached_(json.data()) {}

  Json build() {
    const char* const end = json_.data() + json_.size();
    Json::sax_parse(Cursor(json_.data(), &reached_), Cursor(end, &reached_), this);
    if (const std::size_t at = json_.find('\0'); at != std::string::npos) {  // the parser takes it for the end
      refuse(at, kGarbage);
    }
    return std::move(root_);
  }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(std::int64_t value) override { return add(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) override { return add(static_cast<double>(value)); }
  bool number_float(double value, const std::string&) override { return add(value + 0.0); }  // 0 for -0
  bool string(std::string& value) override { return add(std::move(value)); }
  bool binary(Json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    if (!open_.back().keys.insert(name).second) {
      const std::size_t closing_quote = static_cast<std::size_t>(reached_ - json_.data()) - 1;
      refuse_json("At " + line_and_column(json_, opening_quote(closing_quote)) + ": the key " + quoted_text(name) +
                  " is given twice in one object; keep one of the two.");
    }
    key_ = std::move(name);
    value_is_due_ = true;
    return true;
  }

  /// @param position  how many bytes were read, the last one being the one that does not fit
  bool parse_error(std::size_t position, const std::string& token, const nlohmann::json::exception& error) override {
    std::string what = error.what();
    what.erase(std::min(what.find("; last read"), what.size()));  // which quotes the text
    const auto is = [&what](const char* part) { return what.find(part) != std::string::npos; };
    std::size_t at = std::min(position - 1, json_.size());
    if (is("invalid string")) {
      refuse(at, is("UTF-8")               ? "invalid UTF8 string"
                 : is("closing quote")     ? "unterminated string"
                 : is("control character") ? "unescaped control character"
                                           : "invalid escape sequence");
    }
    const bool no_token = is("invalid"), end = is("unexpected end");
    if (is("unexpected string") || is("unexpected number")) {
      at = position - std::min(position, token.size());
    } else if (no_token || is_of_word(json_[at])) {
      while (at > 0 && is_of_word(json_[at - 1])) --at;
    }
    const char first = json_[at];
    if (no_token || end) {  // shown right after the last that was one
      while (at > 0 && is_space(json_[at - 1])) --at;
    }
    if (open_.empty() && !root_.is_null()) {
      refuse(at, kGarbage);
    }
    if (!open_.empty() && end) {
      refuse(at, open_.back().value->is_array() ? "unterminated array" : "unterminated object");
    }
    if (const std::size_t unexpected = what.find("unexpected"); unexpected != std::string::npos) {
      refuse(at, what.substr(unexpected));
    }
    const bool value_is_due = !open_.empty() && (open_.back().value->is_array() || value_is_due_);
    const bool literal = first == 't' || first == 'f' || first == 'n';
    refuse(at, value_is_due && !literal ? "illegal number" : "illegal value");
  }

 private:
  struct Open {
    Json* value;
    std::set<std::string> keys;
  };

  static constexpr const char* kGarbage = "garbage at the end of the document";

  static bool is_of_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-';
  }

  [[noreturn]] void refuse(std::size_t offset, const std::string& why) const {
    refuse_json("Near " + line_and_column(json_, offset) + ": the edit is not valid JSON (" + why + ").");
  }

  /// A quote inside a text follows an odd number of backslashes.
  std::size_t opening_quote(std::size_t closing_quote) const {
    for (std::size_t at = closing_quote; at > 0;) {
      if (json_[--at] == '"') {
        std::size_t before = at;
        while (before > 0 && json_[before - 1] == '\\') --before;
        if ((at - before) % 2 == 0) {
          return at;
        }
      }
    }
    return 0;
  }

  Json& place(Json&& value) {
    if (open_.empty()) {
      return root_ = std::move(value);
    }
    value_is_due_ = false;
    Json& parent = *open_.back().value;
    if (parent.is_array()) {
      return parent.emplace_back(std::move(value));
    }
    // Not by the key, which would be looked for: that it is new is known.
    return parent.get_ref<Json::object_t&>()
        .std::vector<Json::object_t::value_type>::emplace_back(std::move(key_), std::move(value))
        .second;
  }

  bool add(Json&& value) {
    if (open_.empty()) {
      refuse(0, "illegal value");
    }
    place(std::move(value));
    return true;
  }

  bool open(Json&& value) {
    if (open_.size() == kDeepest) {
      refuse_json("The edit nests lists or objects more than " + std::to_string(kDeepest) +
                  " deep; a valid one nests them 6 deep.");
    }
    open_.push_back({&place(std::move(value)), {}});
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& json_;
  const char* reached_;
  Json root_;
  std::vector<Open> open_;
  std::string key_;
  bool value_is_due_ = false;
};

}  // namespace

void refuse_json(const std::string& sentence) {
  throw EditError(ErrorCause::BadScript, sentence);
}

Json parse_json(std::string json) {
  if (json.size() > kLargestJson) {
    refuse_json("The edit is a text of " + std::to_string(json.size()) + " bytes; the limit is " +
                std::to_string(kLargestJson) + ".");
  }
  if (json.compare(0, 3, "\xEF\xBB\xBF") == 0) {
    json.erase(0, 3);
  }
  if (std::all_of(json.begin(), json.end(), is_space)) {
    refuse_json("The edit is an empty text; give a JSON object.");
  }
  Json root = Builder(json).build();
  if (!root.is_object()) {
    refuse_json("The edit is a JSON list; it has to be an object.");
  }
  return root;
}

std::string json_number(double number) {
  if (number == 0) {
    return "0";
  }
  char buffer[40];
  const char* const end =
      std::to_chars(buffer, buffer + sizeof buffer, std::abs(number), std::chars_format::scientific).ptr;
  const std::string scientific(static_cast<const char*>(buffer), end);
  const std::size_t e = scientific.find('e');
  std::string digits = scientific.substr(0, e);
  digits.erase(std::min<std::size_t>(1, digits.size()), digits.size() > 1 ? 1 : 0);  // the point
  const int count = static_cast<int>(digits.size()), point = std::stoi(scientific.substr(e + 1)) + 1;
  const auto zeros = [](int many) { return std::string(static_cast<std::size_t>(many), '0'); };
  const std::string plain = point <= 0       ? "0." + zeros(-point) + digits
                            : point >= count ? digits + zeros(point - count)
                                             : digits.insert(static_cast<std::size_t>(point), ".");
  // The shorter one, where a single digit counts as if it had a point; whole numbers that fit into 64 bits in full.
  const bool whole = number == std::floor(number) && std::abs(number) < std::ldexp(1.0, 64);
  const bool shorter = plain.size() <= scientific.size() + (count == 1 ? 1 : 0);
  return (number < 0 ? "-" : "") + (whole || shorter ? plain : scientific);
}

std::string quoted_text(const std::string& text) {
  constexpr int kLongest = 60;  // characters, not bytes
  std::size_t end = 0;
  for (int characters = 0; end < text.size(); ++end) {
    characters += (text[end] & 0xC0) != 0x80;
    if (characters > kLongest) {
      break;
    }
  }
  return Json(end == text.size() ? text : text.substr(0, end) + "...")
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string describe(const Json& value) {
  switch (value.type()) {
    case Json::value_t::null:
      return "null";
    case Json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case Json::value_t::string:
      return "the text " + quoted_text(value.get_ref<const std::string&>());
    case Json::value_t::array:
      return "a list of length " + std::to_string(value.size());
    case Json::value_t::object:
      return "an object";
    default:
      return "the number " + json_number(value.get<double>());
  }
}

}  // namespace lapedit
