// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/landmarks.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <locale>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/json/json_text.h"

namespace lapedit {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char letter) { return static_cast<char>(std::tolower(static_cast<unsigned char>(letter))); });
  return text;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Reads a number; `std::nullopt` if the text is no finite one. libstdc++ 10 has no std::from_chars for it.
std::optional<double> number(const std::string& text) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0;
  return in >> value && (in >> std::ws).eof() ? std::optional<double>(value) : std::nullopt;
}

/// Collects landmarks, with the checks that all formats have in common.
class Collector {
 public:
  void add(const std::string& where, std::string name, const std::array<std::string, 3>& coordinates) {
    name = trimmed(name);
    if (name.empty()) {
      refuse_json(where + ": the landmark has no name; give it one, since landmarks are paired by name.");
    }
    Landmark landmark{std::move(name), {}};
    for (int k = 0; k < 3; ++k) {
      const std::string& text = coordinates[static_cast<std::size_t>(k)];
      const std::optional<double> value = number(text);
      if (!value || !std::isfinite(*value)) {
        refuse_json(where + ": the " + "xyz"[k] + " of landmark " + quoted_text(landmark.name) + " is " +
                    quoted_text(text) + "; give a finite number with a decimal point.");
      }
      landmark.point[k] = *value;
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
  static const std::map<std::string, std::string> entities = {
      {"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}, {"&quot;", "\""}, {"&apos;", "'"}};
  std::string plain;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text[at] == '&' ? text.find(';', at) : std::string::npos;
    const auto found = end == std::string::npos ? entities.end() : entities.find(text.substr(at, end + 1 - at));
    plain += found == entities.end() ? text.substr(at, 1) : found->second;
    at = found == entities.end() ? at + 1 : end + 1;
  }
  return plain;
}

/// Reads the attributes of an element, from after its name to its end.
std::map<std::string, std::string> attributes(const std::string& text) {
  std::map<std::string, std::string> found;
  std::size_t at = 0;
  while (true) {
    const std::size_t equals = text.find('=', at);
    const std::size_t open = equals == std::string::npos ? equals : text.find_first_of("\"'", equals);
    const std::size_t close = open == std::string::npos ? open : text.find(text[open], open + 1);
    if (close == std::string::npos) {
      return found;
    }
    found[trimmed(text.substr(at, equals - at))] = without_entities(text.substr(open + 1, close - open - 1));
    at = close + 1;
  }
}

/// Returns the end of an element: the first > outside quotes.
std::size_t end_of_element(const std::string& text, std::size_t at) {
  char quote = 0;
  for (; at < text.size(); ++at) {
    if (quote != 0 ? text[at] == quote : text[at] == '"' || text[at] == '\'') {
      quote = quote != 0 ? '\0' : text[at];
    } else if (quote == 0 && text[at] == '>') {
      return at;
    }
  }
  return std::string::npos;
}

void read_picked_points(const std::string& text, const std::string& name, Collector& all) {
  if (text.find("<PickedPoints") == std::string::npos) {
    refuse_json(name + ": has no element PickedPoints; save it with MeshLab's picked points.");
  }
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = text.find("-->", at);
      continue;
    }
    const std::size_t end = end_of_element(text, at);
    if (end == std::string::npos) {
      refuse_json(name + ": is truncated within an element; save it again.");
    }
    if (text.compare(at, 6, "<point") == 0 && std::isspace(static_cast<unsigned char>(text[at + 6])) != 0) {
      const auto found = attributes(text.substr(at + 6, end - at - 6));
      const auto value = [&found](const char* key) {
        const auto it = found.find(key);
        return it == found.end() ? std::string() : it->second;
      };
      if (value("active") != "0") {
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
        all.add(name + ", line " + std::to_string(line), value("name"), {value("x"), value("y"), value("z")});
      }
    }
    at = end;
  }
  if (!all.file.landmarks.empty() && text.find("</PickedPoints") == std::string::npos) {
    refuse_json(name + ": is truncated after landmark " + quoted_text(all.file.landmarks.back().name) +
                "; save it again.");
  }
}

// --- Tables ---------------------------------------------------------------------------------------------------------

std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"') {
      if (quoted && k + 1 < line.size() && line[k + 1] == '"') {
        cells.back() += line[++k];
      } else {
        quoted = !quoted;
      }
    } else if (line[k] == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[k];
    }
  }
  std::transform(cells.begin(), cells.end(), cells.begin(), trimmed);
  return cells;
}

/// Calls body(line number from 1, line) for lines that are not empty.
template <class Body>
void for_lines(const std::string& text, const Body& body) {
  std::size_t line = 0;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string content = trimmed(text.substr(at, end - at));
    if (!content.empty()) {
      body(line + 1, content);
    }
    at = end + 1;
  }
}

/// The columns of name, x, y and z; the column of names is -1 if there is none.
using Columns = std::array<int, 4>;

std::optional<Columns> columns_of(const std::vector<std::string>& header) {
  const auto find = [&header](const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      for (std::size_t k = 0; k < header.size(); ++k) {
        if (lower(header[k]) == name) {
          return static_cast<int>(k);
        }
      }
    }
    return -1;
  };
  const Columns columns = {find({"name", "label", "landmark", "id"}), find({"x"}), find({"y"}), find({"z"})};
  return std::count(columns.begin() + 1, columns.end(), -1) == 0 ? std::optional<Columns>(columns) : std::nullopt;
}

/// Old files have numbers in place of names.
std::string coordinate_system(const std::string& text) {
  return text == "0" ? "RAS" : text == "1" ? "LPS" : text;
}

/// @param fiducials  3D Slicer's .fcsv: comments name the columns and the coordinate system
void read_table(const std::string& text, const std::string& name, bool fiducials, Collector& all) {
  char separator = fiducials ? ',' : '\0';
  std::optional<Columns> columns;
  if (fiducials) {
    columns = Columns{11, 1, 2, 3};
  }
  int row = 0;
  for_lines(text, [&](std::size_t line, const std::string& content) {
    const std::string where = name + ", line " + std::to_string(line);
    if (content[0] == '#') {
      const std::size_t equals = fiducials ? content.find('=') : std::string::npos;
      const std::string key = equals == std::string::npos ? "" : lower(trimmed(content.substr(1, equals - 1)));
      if (key == "coordinatesystem") {
        all.file.system = coordinate_system(trimmed(content.substr(equals + 1)));
      } else if (key == "columns") {
        columns = columns_of(cells_of(content.substr(equals + 1), ','));
        if (!columns || (*columns)[0] < 0) {
          refuse_json(where + ": the columns are not named x, y, z and label; save it with 3D Slicer.");
        }
      }
      return;
    }
    if (separator == 0) {
      const auto at = content.find_first_of(";\t");
      separator = at == std::string::npos ? ',' : content[at];
    }
    const std::vector<std::string> cells = cells_of(content, separator);
    if (!columns) {
      columns = columns_of(cells);
      if (columns) {
        return;  // this line is the header
      }
      if (cells.size() != 3 && cells.size() != 4) {
        refuse_json(where + ": has " + std::to_string(cells.size()) +
                    " columns; give name, x, y and z, or a header that names them.");
      }
      const int first = cells.size() == 4 ? 1 : 0;
      columns = Columns{first - 1, first, first + 1, first + 2};
    }
    ++row;
    const auto last = static_cast<std::size_t>(*std::max_element(columns->begin(), columns->end()));
    if (cells.size() <= last) {
      refuse_json(where + ": has " + std::to_string(cells.size()) + " columns, but " + std::to_string(last + 1) +
                  " are needed; give name, x, y and z in each line.");
    }
    const auto cell = [&](int k) { return cells[static_cast<std::size_t>((*columns)[static_cast<std::size_t>(k)])]; };
    all.add(where, (*columns)[0] < 0 ? std::to_string(row) : cell(0), {cell(1), cell(2), cell(3)});
  });
}

// --- 3D Slicer's markups --------------------------------------------------------------------------------------------

void read_markups(const std::string& text, const std::string& name, Collector& all) {
  Json root;
  try {
    root = parse_json(text);
  } catch (const EditError& refusal) {
    throw EditError(refusal.cause(), name + ": " + refusal.what());
  }
  if (!root.contains("markups") || !root["markups"].is_array()) {
    refuse_json(name + ": has no list markups; save it with 3D Slicer.");
  }
  for (std::size_t m = 0; m < root["markups"].size(); ++m) {
    const Json& list = root["markups"][m];
    const std::string where = name + ": markups[" + std::to_string(m) + "]";
    if (!list.is_object() || !list.contains("controlPoints") || !list["controlPoints"].is_array()) {
      refuse_json(where + ": has no list controlPoints; save it with 3D Slicer.");
    }
    const auto system = list.find("coordinateSystem");
    if (system != list.end() && system->is_string()) {
      all.file.system = coordinate_system(system->get<std::string>());
    }
    for (std::size_t k = 0; k < list["controlPoints"].size(); ++k) {
      const Json& point = list["controlPoints"][k];
      const std::string location = where + ".controlPoints[" + std::to_string(k) + "]";
      if (!point.is_object() || !point.contains("label") || !point["label"].is_string()) {
        refuse_json(location + ": has no label; give it one, since landmarks are paired by name.");
      }
      if (point.contains("positionStatus") && point["positionStatus"] != "defined") {
        continue;
      }
      const auto position = point.find("position");
      if (position == point.end() || !position->is_array() || position->size() != 3) {
        refuse_json(location + ": the position of landmark " + quoted_text(point["label"].get<std::string>()) +
                    " is not three numbers.");
      }
      std::array<std::string, 3> coordinates;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        coordinates[axis] = (*position)[axis].dump();
      }
      all.add(location, point["label"].get<std::string>(), coordinates);
    }
  }
}

/// Returns the first names of a set, for a message.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + quoted_text(names[k]);
  }
  return names.size() > kMost ? text + " and " + std::to_string(names.size() - kMost) + " more" : text;
}

std::vector<std::string> missing(const std::vector<Landmark>& all, const std::map<std::string, Vector3>& in) {
  std::vector<std::string> names;
  for (const Landmark& landmark : all) {
    if (in.count(landmark.name) == 0) {
      names.push_back(landmark.name);
    }
  }
  return names;
}

std::map<std::string, Vector3> by_name(const std::vector<Landmark>& all) {
  std::map<std::string, Vector3> map;
  for (const Landmark& landmark : all) {
    map.emplace(landmark.name, landmark.point);
  }
  return map;
}

}  // namespace

LandmarkFile read_landmarks(const std::string& text, const std::string& name) {
  Collector all;
  const std::string shown = quoted_text(name), suffix = lower(name);
  const bool mark = text.compare(0, 3, "\xEF\xBB\xBF") == 0;
  const std::string content = mark ? text.substr(3) : text;
  if (ends_with(suffix, ".pp")) {
    read_picked_points(content, shown, all);
  } else if (ends_with(suffix, ".fcsv")) {
    read_table(content, shown, true, all);
  } else if (ends_with(suffix, ".csv")) {
    read_table(content, shown, false, all);
  } else if (ends_with(suffix, ".json")) {
    read_markups(content, shown, all);
  } else {
    refuse_json(shown + " has no suffix of a landmark file; give one of .pp, .csv, .fcsv and .mrk.json.");
  }
  if (all.file.landmarks.empty()) {
    refuse_json(shown + " has no landmarks; give at least one.");
  }
  return std::move(all.file);
}

HandleGroup pair_landmarks(const NamedLandmarks& from_file, const NamedLandmarks& to_file) {
  const LandmarkFile &first = from_file.file, &second = to_file.file;
  const std::string &from = from_file.name, &to = to_file.name;
  if (!first.system.empty() && !second.system.empty() && first.system != second.system) {
    refuse_json("The landmarks of " + quoted_text(from) + " are in " + first.system + " coordinates, those of " +
                quoted_text(to) + " in " + second.system + "; save both in those of the mesh.");
  }
  const std::map<std::string, Vector3> targets = by_name(second.landmarks);
  const std::vector<std::string> not_in_second = missing(first.landmarks, targets);
  const std::vector<std::string> not_in_first = missing(second.landmarks, by_name(first.landmarks));
  if (!not_in_second.empty() || !not_in_first.empty()) {
    std::string sentence = "Landmarks are paired by name, but ";
    if (!not_in_second.empty()) {
      sentence +=
          listed(not_in_second) + (not_in_second.size() == 1 ? " is" : " are") + " only in " + quoted_text(from);
    }
    if (!not_in_first.empty()) {
      sentence += (not_in_second.empty() ? "" : ", and ") + listed(not_in_first) +
                  (not_in_first.size() == 1 ? " is" : " are") + " only in " + quoted_text(to);
    }
    refuse_json(sentence + "; rename or remove names without a partner.");
  }
  HandleGroup group;
  for (const Landmark& landmark : first.landmarks) {
    group.names.push_back(landmark.name);
    group.query.points.push_back(landmark.point);
    group.targets.push_back(targets.at(landmark.name));
  }
  return group;
}

HandleGroup load_landmarks(const std::string& from, const std::string& to) {
  const NamedLandmarks points = {from, read_landmarks(read_text_file(from), from)};
  return pair_landmarks(points, {to, read_landmarks(read_text_file(to), to)});
}

Edit fit_landmarks(HandleGroup group) {
  EditStep step;
  step.region.kind = RegionSpec::Kind::Component;
  step.handles = {std::move(group)};
  step.settings = EditSettings::of(EditMethod::Linear);
  step.settings.laplacian = LaplacianKind::Cotangent;
  step.settings.handle_weight = step.settings.anchor_weight = 30;
  Edit edit;
  edit.steps = {std::move(step)};
  return edit;
}

std::string read_text_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    refuse_json(quoted_text(path) + " is not the path of a file.");
  }
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error && size > kLargestJson) {
    refuse_json(quoted_text(path) + " is a file of " + std::to_string(size) + " bytes; the limit is " +
                std::to_string(kLargestJson) + ".");
  }
  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  std::string text;
  if (file) {
    text.resize(static_cast<std::size_t>(size) + 1);  // one more byte, to detect that the file has grown
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  }
  if (!file || std::ferror(file.get()) != 0) {
    refuse_json(quoted_text(path) + " cannot be read: " + std::generic_category().message(errno) + ".");
  }
  return text;
}

}  // namespace lapedit
