// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_text.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

constexpr std::size_t kDeepest = 1024;

/// Builds the value. The library's own builder takes the last of two equal keys, looks for them one by one, and reads
/// as deep as the text goes.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(std::int64_t value) override { return add(value); }
  bool number_unsigned(std::uint64_t value) override { return add(value); }
  bool number_float(double value, const std::string&) override { return add(value); }
  bool string(std::string& value) override { return add(std::move(value)); }
  bool binary(Json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    if (!open_.back().keys.insert(name).second) {
      refuse_json(where() + ": the key " + quoted_text(name) + " is given twice in one object; keep one of the two.");
    }
    key_ = std::move(name);
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) override {
    std::string what = error.what();
    what.erase(0, what.find("] ") + 2);                           // the library's number of the error
    what.erase(std::min(what.find("; last read"), what.size()));  // which quotes the text
    refuse_json("The edit is not valid JSON: " + what + ".");
  }

 private:
  struct Open {
    Json* value;
    std::string key;  ///< of this value in the object that holds it
    std::set<std::string> keys;
  };

  /// Where the value that is being read is, such as "steps[1].region".
  std::string where() const {
    std::string path = "edit";
    for (std::size_t i = 1; i < open_.size(); ++i) {
      const Json& parent = *open_[i - 1].value;
      path = parent.is_array() ? path + "[" + std::to_string(parent.size() - 1) + "]"
             : i == 1          ? open_[i].key
                               : path + "." + open_[i].key;
    }
    return path;
  }

  Json& place(Json&& value) {
    if (open_.empty()) {
      return root_ = std::move(value);
    }
    Json& parent = *open_.back().value;
    if (parent.is_array()) {
      return parent.emplace_back(std::move(value));
    }
    // Not by the key, which would be looked for: that it is new is known.
    return parent.get_ref<Json::object_t&>()
        .std::vector<Json::object_t::value_type>::emplace_back(key_, std::move(value))
        .second;
  }

  bool add(Json&& value) {
    place(std::move(value));
    return true;
  }

  bool open(Json&& value) {
    if (open_.size() == kDeepest) {
      refuse_json("The edit nests lists or objects more than " + std::to_string(kDeepest) +
                  " deep; a valid one nests them 6 deep.");
    }
    open_.push_back({&place(std::move(value)), key_, {}});
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  Json root_;
  std::vector<Open> open_;
  std::string key_;
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
  if (json.find_first_not_of(" \t\r\n") == std::string::npos) {
    refuse_json("The edit is an empty text; give a JSON object.");
  }
  if (json.find('\0') != std::string::npos) {  // the parser takes it for the end
    refuse_json("The edit is not valid JSON: it has a byte 0.");
  }
  Builder builder;
  Json::sax_parse(json, &builder);
  Json root = builder.take();
  if (!root.is_object()) {
    refuse_json("The edit is " + describe(root) + "; it has to be a JSON object.");
  }
  return root;
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
      return "the number " + value.dump();
  }
}

}  // namespace lapedit
