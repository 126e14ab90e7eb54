// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <type_traits>
#include <utility>
#include <variant>

namespace lapedit {
namespace {

constexpr std::size_t kDeepest = 1024, kMostKeys = 100;

/// Checks a text before the library's parser reads it, since the parser accepts duplicate keys (the last one wins,
/// found by linear search) and any depth. Its callback would do, but takes time of the square of the length of a list.
class Watch : public Json::json_sax_t {
 public:
  bool null() override { return add_entry(); }
  bool boolean(bool) override { return add_entry(); }
  bool number_integer(Json::number_integer_t) override { return add_entry(); }
  bool number_unsigned(Json::number_unsigned_t) override { return add_entry(); }
  bool number_float(Json::number_float_t, const Json::string_t&) override { return add_entry(); }
  bool string(Json::string_t&) override { return add_entry(); }
  bool binary(Json::binary_t&) override { return add_entry(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(Json::string_t& key) override {
    add_key(key);
    return true;
  }
  bool parse_error(std::size_t, const std::string& read, const nlohmann::detail::exception& error) override {
    constexpr int kOverflow = 406;  // whose message has the whole number, however long, but not its place
    if (error.id == kOverflow) {
      refuse_json(where(open_.size()) + ": the number " + quoted_text(read) + " is too large: give a smaller one.",
                  where(open_.size()));
    }
    return false;  // the parser reports it
  }

 private:
  struct Open {
    bool is_array;
    std::size_t entries;  ///< number of complete entries
    std::string key;      ///< the last key
    std::set<std::string> keys;
  };

  bool open(bool is_array) {
    if (open_.size() == kDeepest) {
      refuse_json("The edit nests lists or objects more than " + std::to_string(kDeepest) +
                  " deep; a valid one nests them 6 deep.");
    }
    open_.push_back({is_array, 0, {}, {}});
    return true;
  }

  bool close() {
    open_.pop_back();
    return add_entry();
  }

  bool add_entry() {
    if (!open_.empty()) {
      ++open_.back().entries;
    }
    return true;
  }

  void add_key(const std::string& key) {
    Open& object = open_.back();
    if (!object.keys.insert(key).second) {
      refuse_json(where() + ": the key " + quoted_text(key) + " is given twice in one object; keep one of the two.",
                  where());
    }
    if (object.keys.size() > kMostKeys) {
      refuse_json(where() + ": the object has more than " + std::to_string(kMostKeys) + " keys.", where());
    }
    object.key = key;
  }

  /// Returns the path of the object that is being read, such as "steps[1].region".
  std::string where() const { return where(open_.size() - 1); }
  std::string where(std::size_t depth) const {
    std::string path;
    for (std::size_t i = 0; i < depth; ++i) {
      path +=
          open_[i].is_array ? "[" + std::to_string(open_[i].entries) + "]" : (path.empty() ? "" : ".") + open_[i].key;
    }
    return path.empty() ? "edit" : path;
  }

  std::vector<Open> open_;
};

void read_numbers(const JsonValue& value, double* numbers, std::size_t count) {
  if (!value.json.is_array() || value.json.size() != count) {
    value.refuse_kind("a list of " + std::to_string(count) + " numbers");
  }
  for (std::size_t k = 0; k < count; ++k) {
    read(value[k], numbers[k]);
  }
}

Json json_of(const Figure::Value& value) {
  Json json;
  const auto put = [&json](const auto& known) {
    if constexpr (!std::is_same_v<std::decay_t<decltype(known)>, std::monostate>) {
      json = known;
    }
  };
  std::visit(put, value);
  return json;
}

}  // namespace

void refuse_json(const std::string& sentence, const std::string& key) {
  EditError refusal(ErrorCause::BadScript, sentence);
  throw key.empty() ? refusal : refusal.at(key);
}

bool is_utf16(const std::string& text) {
  const std::string first = text.substr(0, 8);
  bool alternates = first.size() > 1;
  for (std::size_t k = 1; k < first.size(); ++k) {
    alternates = alternates && (first[k] == 0) != (first[k - 1] == 0);
  }
  return alternates || first.compare(0, 2, "\xFF\xFE") == 0 || first.compare(0, 2, "\xFE\xFF") == 0;
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
  if (is_utf16(json)) {
    refuse_json("The text is in UTF-16: save it in UTF-8.");
  }
  if (json.find('\0') != std::string::npos) {  // the parser would stop there
    refuse_json("The text is not valid JSON: it has a byte 0.");
  }
  Json root;
  try {
    Watch watch;
    Json::sax_parse(json, &watch);
    root = Json::parse(json);
  } catch (const Json::exception& error) {
    std::string what = error.what();
    what.erase(0, what.find("] ") + 2);                           // removes the library's error number
    what.erase(std::min(what.find("; last read"), what.size()));  // removes the quoted text
    refuse_json("The text is not valid JSON: " + what + ".");
  }
  if (!root.is_object()) {
    refuse_json("The text is " + describe(root) + "; it has to be a JSON object.");
  }
  return root;
}

std::string trimmed(const std::string& text, const char* space) {
  const std::size_t first = text.find_first_not_of(space);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(space) - first + 1);
}

std::string quoted_text(const std::string& text, int most_characters) {
  std::size_t end = 0;
  const std::size_t most = std::min(text.size(), 4 * static_cast<std::size_t>(most_characters));  // if it is no UTF-8
  for (int characters = 0; end < most; ++end) {
    characters += (text[end] & 0xC0) != 0x80;
    if (characters > most_characters) {
      break;
    }
  }
  return Json(end == text.size() ? text : text.substr(0, end) + "...")
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string describe(const Json& value) {
  if (value.is_string()) {
    return "the text " + quoted_text(value.get_ref<const std::string&>());
  }
  if (value.is_array()) {
    return "a list of length " + std::to_string(value.size());
  }
  return value.is_object() ? "an object" : (value.is_number() ? "the number " : "") + value.dump();
}

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
  if (!value.json.is_boolean()) {
    value.refuse_kind("true or false");
  }
  flag = value.json == true;
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

Json report_json(const std::vector<EditReport>& steps) {
  Json all = Json::array();
  for (const EditReport& report : steps) {
    Json step;
    for (const Figure& figure : report_table()) {
      const std::string key = figure.key == nullptr ? "" : figure.key;
      if (!key.empty() && (report.fit || key.rfind("fit/", 0) != 0)) {
        step[Json::json_pointer("/" + key)] = json_of(figure.get(report));
      }
    }
    step["fit"];  // null for a step without a fit
    step["landmarks"] = Json::array();
    for (const LandmarkResidual& one : report.landmarks) {
      step["landmarks"].push_back({{"name", one.name}, {"vertex", one.vertex}, {"residual", one.residual}});
    }
    all.push_back(std::move(step));
  }
  return all;
}

}  // namespace lapedit
