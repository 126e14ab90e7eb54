// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/landmarks.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <locale>
#include <map>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "lapedit/json/json_text.h"

namespace lapedit {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return text;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char letter) { return std::toupper(letter); });
  return text;
}

/// Collects landmarks, with the checks that all formats have in common.
class Collector {
 public:
  void add(const std::string& where, const std::string& name, const std::array<std::string, 3>& coordinates) {
    Landmark landmark = {trimmed(name), {}};
    if (landmark.name.empty()) {
      refuse_json(where + ": the landmark has no name; give it one, since landmarks are paired by name.");
    }
    for (std::size_t k = 0; k < 3; ++k) {
      std::istringstream in(coordinates[k]);  // libstdc++ 10 has no std::from_chars for double
      in.imbue(std::locale::classic());
      double& value = landmark.point[static_cast<Eigen::Index>(k)];
      if (!(in >> value && (in >> std::ws).eof() && std::isfinite(value))) {
        refuse_json(where + ": the " + "xyz"[k] + " of landmark " + quoted_text(landmark.name) + " is " +
                    quoted_text(coordinates[k]) + "; give a finite number with a decimal point.");
      }
    }
    if (!names_.insert(landmark.name).second) {
      refuse_json(where + ": there are two landmarks " + quoted_text(landmark.name) + "; give each a name of its own.");
    }
    file.landmarks.push_back(std::move(landmark));
  }

  LandmarkFile file;

 private:
  std::set<std::string> names_;
};

// --- MeshLab's picked points ----------------------------------------------------------------------------------------

std::string without_entities(const std::string& text) {
  static const std::map<std::string, char> entities = {
      {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string plain;
  for (std::size_t at = 0; at < text.size();) {
    const auto entity = std::find_if(entities.begin(), entities.end(), [&](const auto& one) {
      return text.compare(at, one.first.size(), one.first) == 0;
    });
    plain += entity == entities.end() ? text[at] : entity->second;
    at += entity == entities.end() ? 1 : entity->first.size();
  }
  return plain;
}

/// Reads the attributes of an element. @param at  in: the index after its name; out: that of the first > outside quotes
std::map<std::string, std::string> read_attributes(const std::string& text, std::size_t& at) {
  std::map<std::string, std::string> all;
  std::string key;
  for (; at < text.size() && text[at] != '>'; ++at) {
    if (text[at] == '"' || text[at] == '\'') {
      const std::size_t open = at + 1;
      at = std::min(text.find(text[at], open), text.size());
      all[trimmed(key)] = without_entities(text.substr(open, at - open));
      key.clear();
    } else if (text[at] != '=') {
      key += text[at];
    }
  }
  return all;
}

void read_picked_points(const std::string& text, const std::string& name, Collector& all) {
  if (text.find("<PickedPoints") == std::string::npos) {
    refuse_json(name + ": has no element PickedPoints; save it with MeshLab's picked points.");
  }
  std::size_t line = 1, seen = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = text.find("-->", at);
      continue;
    }
    const bool is_point = text.compare(at, 6, "<point") == 0 && trimmed(text.substr(at + 6, 1)).empty();
    line += static_cast<std::size_t>(std::count(&text[seen], &text[at], '\n'));
    seen = at;
    at += is_point ? 6 : 1;
    auto found = read_attributes(text, at);
    if (at >= text.size()) {
      refuse_json(name + ": is truncated within an element; save it again.");
    }
    if (is_point && found["active"] != "0") {
      all.add(name + ", line " + std::to_string(line), found["name"], {found["x"], found["y"], found["z"]});
    }
  }
  if (!all.file.landmarks.empty() && text.find("</PickedPoints") == std::string::npos) {
    refuse_json(name + ": is truncated after landmark " + quoted_text(all.file.landmarks.back().name) +
                "; save it again.");
  }
}

// --- Tables ---------------------------------------------------------------------------------------------------------

constexpr std::size_t kMostColumns = 1000;

/// Returns the cells of a line, the first ones of a line with more than kMostColumns.
std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (std::size_t k = 0; k < line.size() && cells.size() <= kMostColumns; ++k) {
    if (line[k] == '"') {
      is_quoted = !is_quoted;
      cells.back() += is_quoted && k > 0 && line[k - 1] == '"' ? "\"" : "";  // "" is an escaped quote
    } else if (line[k] == separator && !is_quoted) {
      cells.back() = trimmed(cells.back());
      cells.emplace_back();
    } else {
      cells.back() += line[k];
    }
  }
  cells.back() = trimmed(cells.back());
  return cells;
}

/// The columns of x, y, z, name and whether the point is defined; -1 for a column that is missing.
using Columns = std::array<int, 5>;

/// Finds the columns in a header. @param system  out: the coordinate system, if the names of the axes give it (r, a, s)
Columns columns_of(std::vector<std::string> header, std::string& system) {
  static const std::vector<std::string> names[] = {
      {"x", "r", "l"}, {"y", "a", "p"}, {"z", "s"}, {"name", "label", "landmark", "id"}, {"defined"}};
  Columns columns = {-1, -1, -1, -1, -1};
  std::string axes;
  std::transform(header.begin(), header.end(), header.begin(), lower);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    for (const std::string& name : names[k]) {
      const auto cell = std::find(header.begin(), header.end(), name);
      if (columns[k] < 0 && cell != header.end()) {
        columns[k] = static_cast<int>(cell - header.begin());
        axes += k < 3 ? name : "";
      }
    }
  }
  if (axes.find_first_of("xyz") == std::string::npos) {
    system = upper(axes);
  }
  return columns;
}

/// Returns the name of a coordinate system. Old files give a number in place of the name.
std::string coordinate_system(const std::string& text) {
  return text == "0" ? "RAS" : text == "1" ? "LPS" : upper(text);
}

/// Reads the comments of 3D Slicer's .fcsv, which name the columns and the coordinate system.
void read_comment(const std::string& where, const std::string& comment, Collector& all, Columns& columns) {
  const std::size_t equals = std::min(comment.find('='), comment.size());
  const std::string key = lower(trimmed(comment.substr(1, equals - 1)));
  const std::string value = trimmed(comment.substr(std::min(equals + 1, comment.size())));
  if (key == "coordinatesystem") {
    all.file.system = coordinate_system(value);
  } else if (key == "columns") {
    columns = columns_of(cells_of(value, ','), all.file.system);
    if (std::count(columns.begin(), columns.end() - 1, -1) > 0) {
      refuse_json(where + ": the columns are not named x, y, z and label; save it with 3D Slicer.");
    }
  }
}

void read_table(const std::string& text, const std::string& name, const std::string& suffix, Collector& all) {
  const bool is_fcsv = suffix == ".fcsv";
  Columns columns = is_fcsv ? Columns{1, 2, 3, 11, -1} : Columns{-1, -1, -1, -1, -1};
  char separator = is_fcsv ? ',' : suffix == ".tsv" ? '\t' : '\0';
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string where = name + ", line " + std::to_string(number), content = trimmed(line);
    if (is_fcsv && content[0] == '#') {
      read_comment(where, content, all, columns);
    }
    if (content.empty() || content[0] == '#') {
      continue;
    }
    if (separator == 0) {
      const std::size_t at = content.find_first_of(";\t");
      separator = at == std::string::npos ? ',' : content[at];
    }
    const std::vector<std::string> cells = cells_of(content, separator);
    if (cells.size() > kMostColumns) {
      refuse_json(where + ": has more than " + std::to_string(kMostColumns) + " columns; give name, x, y and z.");
    }
    if (columns[0] < 0) {
      std::string system;
      const Columns named = columns_of(cells, system);
      if (std::count(named.begin(), named.begin() + 3, -1) == 0) {
        columns = named;
        all.file.system = system;
        continue;  // this line is the header
      }
      if (cells.size() != 3 && cells.size() != 4) {
        refuse_json(
            where + ": has " + std::to_string(cells.size()) + (cells.size() == 1 ? " column" : " columns") +
            "; give name, x, y and z with commas, semicolons or tabs between them, or a header that names them.");
      }
      columns = cells.size() == 3 ? Columns{0, 1, 2, -1, -1} : Columns{1, 2, 3, 0, -1};
    }
    const auto needed = static_cast<std::size_t>(*std::max_element(columns.begin(), columns.end())) + 1;
    if (cells.size() < needed) {
      refuse_json(where + ": has " + std::to_string(cells.size()) + " columns, but " + std::to_string(needed) +
                  " are needed; give name, x, y and z in each line.");
    }
    if (columns[4] >= 0 && (cells[columns[4]] == "0" || lower(cells[columns[4]]) == "false")) {
      continue;
    }
    const std::string label = columns[3] < 0 ? std::to_string(all.file.landmarks.size() + 1) : cells[columns[3]];
    all.add(where, label, {cells[columns[0]], cells[columns[1]], cells[columns[2]]});
  }
}

// --- 3D Slicer's markups --------------------------------------------------------------------------------------------

JsonValue list_of(const JsonValue& object, const char* key) {
  if (!object.json.is_object() || !object.has(key) || !object[key].json.is_array()) {
    refuse_json(object.where + (object.where.empty() ? "has" : ": has") + " no list " + key +
                "; save it with 3D Slicer.");
  }
  return object[key];
}

void read_markups(const std::string& text, Collector& all) {
  const Json root = parse_json(text);
  const JsonValue markups = list_of({root, ""}, "markups");
  for (std::size_t m = 0; m < markups.json.size(); ++m) {
    const JsonValue points = list_of(markups[m], "controlPoints");
    if (const Json& system = markups[m]["coordinateSystem"].json; system.is_string()) {
      const std::string before = std::exchange(all.file.system, coordinate_system(system.get<std::string>()));
      if (m > 0 && before != all.file.system) {
        markups[m].refuse("is in " + all.file.system + " coordinates, the list before in " + before +
                          "; save them in one system.");
      }
    }
    for (std::size_t k = 0; k < points.json.size(); ++k) {
      const JsonValue point = points[k];
      if (!point.json.is_object() || !point["label"].json.is_string()) {
        point.refuse("has no label; give it one, since landmarks are paired by name.");
      }
      if (point.has("positionStatus") && point["positionStatus"].json != "defined") {
        continue;
      }
      const std::string label = point["label"].json.get<std::string>();
      const Json& position = point["position"].json;
      if (!position.is_array() || position.size() != 3) {
        point.refuse("the position of landmark " + quoted_text(label) + " is not three numbers.");
      }
      all.add(point.where, label, {position[0].dump(), position[1].dump(), position[2].dump()});
    }
  }
}

/// Returns the phrase that names are in one file only, with the first of them; empty without names.
std::string listed(const std::vector<std::string>& names, const std::string& file) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + quoted_text(names[k]);
  }
  text += names.size() > kMost ? " and " + std::to_string(names.size() - kMost) + " more" : "";
  return text.empty() ? text : text + (names.size() == 1 ? " is" : " are") + " only in " + quoted_text(file);
}

}  // namespace

LandmarkFile read_landmarks(const std::string& text, const std::string& name) {
  Collector all;
  const std::string shown = quoted_text(name), suffix = lower(std::filesystem::path(name).extension().string());
  all.file.name = name;
  const std::string content = text.substr(text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0);
  if (is_utf16(content)) {
    refuse_json(shown + " is text in UTF-16: save it in UTF-8.");
  }
  if (suffix == ".pp") {
    read_picked_points(content, shown, all);
  } else if (suffix == ".csv" || suffix == ".tsv" || suffix == ".fcsv") {
    read_table(content, shown, suffix, all);
  } else if (suffix == ".json") {
    refused_at(shown, [&] { read_markups(content, all); });
  } else {
    refuse_json(shown + " has no suffix of a landmark file; give one of .pp, .csv, .tsv, .fcsv and .mrk.json.");
  }
  if (all.file.landmarks.empty()) {
    refuse_json(shown + " has no landmarks; give at least one.");
  }
  return std::move(all.file);
}

HandleGroup pair_landmarks(const LandmarkFile& from, const LandmarkFile& to) {
  HandleGroup group;
  group.spaces = {from.system, to.system, {}};
  std::vector<std::string> only_from, only_to;
  std::map<std::string, Vector3> targets;
  for (const Landmark& landmark : to.landmarks) {
    targets.emplace(landmark.name, landmark.point);
  }
  for (const Landmark& landmark : from.landmarks) {
    const auto target = targets.find(landmark.name);
    if (target == targets.end()) {
      only_from.push_back(landmark.name);
    } else {
      group.names.push_back(landmark.name);
      group.query.points.push_back(landmark.point);
      group.targets.push_back(target->second);
      targets.erase(target);
    }
  }
  for (const auto& [name, target] : targets) {
    only_to.push_back(name);
  }
  if (!only_from.empty() || !only_to.empty()) {
    refuse_json("Landmarks are paired by name, but " + listed(only_from, from.name) +
                (only_from.empty() || only_to.empty() ? "" : ", and ") + listed(only_to, to.name) +
                "; rename or remove names without a partner.");
  }
  return group;
}

HandleGroup load_landmarks(const std::string& from, const std::string& to) {
  const LandmarkFile points = read_landmarks(read_text_file(from), from);
  return pair_landmarks(points, read_landmarks(read_text_file(to), to));
}

Edit fit_landmarks(HandleGroup group) {
  Edit edit;
  EditStep& step = edit.steps.emplace_back();
  step.region.kind = RegionSpec::Kind::Component;
  step.region.pieces = true;
  step.handles = {std::move(group)};
  step.settings = EditSettings::of(EditMethod::Linear);
  step.settings.laplacian = LaplacianKind::Surface;
  step.settings.handle_weight = step.settings.anchor_weight = 30;
  return edit;
}

Edit fit_scan(std::string to, HandleGroup landmarks) {
  Edit edit;
  EditStep& step = edit.steps.emplace_back();
  step.region.kind = RegionSpec::Kind::Component;
  if (!landmarks.query.points.empty()) {
    step.handles = {std::move(landmarks)};
  }
  step.fit.emplace().to = std::move(to);
  return edit;
}

std::string read_text_file(const std::string& path, const char* otherwise) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    const std::string folder = std::filesystem::absolute(path, error).parent_path().string();
    refuse_json(quoted_text(path) + " " + otherwise + ". It was looked for in the folder " + quoted_text(folder, 1000) +
                ".");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kLargestJson) {
    refuse_json(quoted_text(path) + " is a file of " + std::to_string(size) + " bytes; the limit is " +
                std::to_string(kLargestJson) + ".");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(error ? 0 : static_cast<std::size_t>(size), '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (!file.is_open() || file.bad()) {
    refuse_json(quoted_text(path) + " cannot be read: " + std::generic_category().message(errno) + ".");
  }
  return text;
}

}  // namespace lapedit
