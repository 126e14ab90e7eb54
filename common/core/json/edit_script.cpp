// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/edit_script.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/json/json_text.h"
#include "lapedit/json/landmarks.h"

namespace lapedit {

constexpr std::int64_t kMostListedVertices = 100000000;  // of all lists of an edit together

/// Data shared by all values of one text.
struct Source {
  const std::string& folder;        ///< of relative file names
  const TriangleMesh* mesh;         ///< null: unknown
  std::vector<std::string>* files;  ///< gets the files that the text names; may be null
  struct Limits {
    std::int64_t end = std::int64_t{1} << 31;  ///< the first number that is no vertex
    std::int64_t most = kMostListedVertices;   ///< number of vertices that can be listed
    bool by_position = false;                  ///< these are those of mesh.positions
  } limits = {};
  std::int64_t listed = 0;              ///< vertices in the lists before
  std::optional<EditError> later = {};  ///< thrown at the end, since errors of the text itself come first
};

namespace {

constexpr int kVersion = 1;

/// Returns the path of a file that the text names.
std::string named_file(const JsonValue& value) {
  const Source& source = *value.source;
  std::string path = (std::filesystem::path(source.folder) / value_of<std::string>(value)).string();
  if (source.files != nullptr) {
    source.files->push_back(path);
  }
  return path;
}

using Ranges = std::vector<std::pair<int, int>>;  // the first and the last vertex of each

/// Returns the vertex number that a text consists of; -1 if the text is no vertex number.
int vertex_number(const std::string& text) {
  const std::string digits = trimmed(text, " \t\n\r");
  const char* const end = digits.data() + digits.size();
  int number = -1;
  const auto [stop, error] = std::from_chars(digits.data(), end, number);
  return error == std::errc() && stop == end && digits[0] != '-' ? number : -1;
}

/// Adds a range of vertices, unless it goes beyond the mesh.
void add_range(const JsonValue& value, int first, int last, Ranges& ranges) {
  Source& source = *value.source;
  if (last < source.limits.end) {
    ranges.emplace_back(first, last);
  } else if (!source.later) {
    const std::int64_t beyond = std::max<std::int64_t>(first, source.limits.end);
    const std::string sentence =
        "vertex " + std::to_string(beyond) +
        (source.limits.by_position ? " is not among mesh.positions, by which the edit is applied; add it."
                                   : " is outside the edit's mesh, which has " + std::to_string(source.limits.end) +
                                         " vertices, counted from 0.");
    source.later.emplace(ErrorCause::BadScript, value.where + ": " + sentence, static_cast<int>(beyond))
        .at(value.where);
  }
}

/// Adds one piece of a vertex list: a number, or a range with both ends.
void add_piece(const JsonValue& value, const std::string& piece, Ranges& ranges) {
  const std::size_t minus = std::min(piece.find('-'), piece.size());
  const int first = vertex_number(piece.substr(0, minus));
  const int last = minus == piece.size() ? first : vertex_number(piece.substr(minus + 1));
  if (first < 0 || last < 0) {
    value.refuse(quoted_text(piece) + " is no vertex number or range; write them as in \"12-40,77\", from 0 to " +
                 std::to_string(std::numeric_limits<int>::max()) + ".");
  }
  if (last < first) {
    value.refuse(quoted_text(piece) + " is a range from high to low; put the lower vertex first.");
  }
  add_range(value, first, last, ranges);
}

/// Adds what a text or a number lists.
void add_ranges(const JsonValue& value, Ranges& ranges) {
  if (value.json.is_number()) {
    const int vertex = value_of<int>(value);
    return add_range(value, vertex, vertex, ranges);
  }
  if (!value.json.is_string()) {
    value.refuse_kind("vertices, as in \"12-40,77\" or [12, 77]");
  }
  const auto& text = value.json.get_ref<const std::string&>();
  for (std::size_t at = 0; at <= text.size();) {
    const std::string piece = text.substr(at, text.find(',', at) - at);
    add_piece(value, piece, ranges);
    at += piece.size() + 1;
  }
}

std::int64_t count_of(const Ranges& ranges) {
  std::int64_t count = 0;
  for (const auto& [first, last] : ranges) {
    count += std::int64_t{1} + last - first;
  }
  return count;
}

/// Returns the union of ranges, ascending.
Ranges union_of(Ranges ranges) {
  std::sort(ranges.begin(), ranges.end());
  Ranges all;
  for (const auto& [first, last] : ranges) {
    if (all.empty() || first > all.back().second) {
      all.emplace_back(first, last);
    }
    all.back().second = std::max(all.back().second, last);
  }
  return all;
}

/// Reads a vertex list, in its order. A list that is longer than the mesh becomes a set. Counts the vertices before
/// memory is allocated for them.
void read(const JsonValue& value, std::vector<int>& vertices) {
  Source& source = *value.source;
  Ranges ranges;
  if (value.json.is_array() && !value.json.empty()) {
    for (std::size_t k = 0; k < value.json.size(); ++k) {
      add_ranges(value[k], ranges);
    }
  } else {
    add_ranges(value, ranges);
  }
  if (source.later) {
    return;
  }
  if (count_of(ranges) > source.limits.most) {
    ranges = union_of(std::move(ranges));
  }
  const std::int64_t count = count_of(ranges);
  if (source.limits.by_position && count > source.limits.most) {
    value.refuse("lists " + std::to_string(count) + " vertices, but mesh.positions has points for " +
                 std::to_string(source.limits.most) + "; give one for each.");
  }
  if (source.listed + count > kMostListedVertices) {
    value.refuse("the vertex lists up to here hold " + std::to_string(source.listed + count) +
                 " vertices or more; an edit may list " + std::to_string(kMostListedVertices) + ".");
  }
  source.listed += count;
  vertices.reserve(static_cast<std::size_t>(count));
  for (const auto& [first, last] : ranges) {
    for (std::int64_t vertex = first; vertex <= last; ++vertex) {
      vertices.push_back(static_cast<int>(vertex));
    }
  }
}

void read(const JsonValue& from, FitMode& mode) {
  mode = static_cast<FitMode>(read_choice(from, {name(FitMode::Shape), name(FitMode::Pose)}));
}

void read(const JsonValue& from, FitAlign& align) {
  align = static_cast<FitAlign>(
      read_choice(from, {name(FitAlign::Similarity), name(FitAlign::Rigid), name(FitAlign::None)}));
}

template <class Value>
Json json_of(Value& value);

/// Writes whole numbers as "0" and not "0.0".
Json json_of(double& number) {
  constexpr double kLargestWhole = 9007199254740992;  // 2^53
  if (!std::isfinite(number)) {
    throw EditError(ErrorCause::NotFinite, "The edit cannot be written: one of its numbers is NaN or infinite.");
  }
  const bool is_whole = number == std::floor(number) && std::abs(number) <= kLargestWhole;
  return is_whole ? Json(static_cast<std::int64_t>(number)) : Json(number);
}

Json json_of(Vector3& vector) {
  return {json_of(vector[0]), json_of(vector[1]), json_of(vector[2])};
}

template <class Value>
Json json_of(std::vector<Value>& values) {
  Json list = Json::array();
  for (Value& value : values) {
    list.push_back(json_of(value));
  }
  return list;
}

Json json_of(Matrix34& matrix) {
  std::vector<double> numbers(matrix.data(), matrix.data() + matrix.size());
  numbers.insert(numbers.end(), {0, 0, 0, 1});
  return json_of(numbers);
}

/// Writes consecutive numbers as ranges.
Json json_of(std::vector<int>& vertices) {
  std::string text;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t first = i;
    while (i + 1 < vertices.size() && vertices[i] < vertices[i + 1] && vertices[i] + 1 == vertices[i + 1]) {
      ++i;
    }
    text += (first == 0 ? "" : ",") + std::to_string(vertices[first]);
    if (i > first) {
      text += "-" + std::to_string(vertices[i]);
    }
  }
  return text;
}

template <class Value>
Json json_of(std::optional<Value>& value) {
  return json_of(*value);
}

template <class Object>
void read(const JsonValue& from, Object& object);

template <class Value>
void read(const JsonValue& from, std::optional<Value>& value) {
  Value result;
  read(from, result);
  value = std::move(result);
}

template <class Value>
void read(const JsonValue& from, std::vector<Value>& values) {
  if (!from.json.is_array() || from.json.empty()) {
    from.refuse_kind(std::string("a list of one or more ") + (std::is_same_v<Value, EditStep>      ? "steps"
                                                              : std::is_same_v<Value, HandleGroup> ? "handle groups"
                                                                                                   : "points"));
  }
  for (std::size_t k = 0; k < from.json.size(); ++k) {
    read(from[k], values.emplace_back());  // one by one, since a wrong entry takes less memory as text
  }
}

/// Return whether a value is written by default: an empty list, an unknown value and `false` are not.
template <class Value>
bool is_written(const Value&) {
  return true;
}
template <class Value>
bool is_written(const std::vector<Value>& values) {
  return !values.empty();
}
template <class Value>
bool is_written(const std::optional<Value>& value) {
  return value.has_value();
}
bool is_written(bool value) {
  return value;
}

/// The table of an object's keys, one row for each key in the order of the written text. A visit() function lists the
/// rows, and runs three times: to collect the names for refusals, to read, and to write.
struct Keys {
  const JsonValue* from = nullptr;
  Json* to = nullptr;
  std::vector<const char*> names = {};
  const char* former_key = "";

  /// Handles an optional key. @return whether it was read or written
  template <class Value>
  bool may(const char* key, Value& value) {
    return may(key, value, is_written(value));
  }
  template <class Value>
  bool may(const char* key, Value& value, bool written) {
    names.push_back(key);
    if (has(key)) {
      read((*from)[key], value);
    } else if (to != nullptr && written) {
      (*to)[key] = json_of(value);
    }
    return has(key) || (to != nullptr && written);
  }

  /// Handles numbers of a scan's faces, which are written as vertex lists are.
  void may_list_faces(const char* key, std::vector<int>& faces) {
    const auto limits = from == nullptr ? Source::Limits() : std::exchange(from->source->limits, {});
    may(key, faces);
    if (from != nullptr) {
      from->source->limits = limits;
    }
  }

  /// Handles an optional key that is `true`.
  void chosen(const char* key, bool& value) {
    if (has(key) && !((*from)[key].json == true)) {
      (*from)[key].refuse_kind("true");
    }
    may(key, value);
  }

  /// Handles a required key.
  template <class Value>
  void need(const char* key, Value& value) {
    if (!may(key, value) && from != nullptr) {
      read((*from)[key], value);  // throws, since the key is missing
    }
  }

  /// Ignores a key of an earlier version if its value is `true`, the default.
  void former(const char* key, const char* why) {
    former_key = key;
    if (has(key) && !((*from)[key].json == true)) {
      refuse(key, why);
    }
  }

  // The following functions have no effect unless keys are read.

  bool has(const char* key) const { return from != nullptr && from->has(key); }
  void refuse(const char* key, const std::string& sentence) const {
    if (from != nullptr) {
      (*from)[key].refuse(sentence);
    }
  }
  /// Refuses an object unless it has exactly one of some keys.
  void exactly_one(const std::vector<const char*>& keys) const {
    std::string list;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      list += std::string(k == 0 ? "" : k + 1 < keys.size() ? ", " : " and ") + keys[k];
    }
    if (from != nullptr && std::count_if(keys.begin(), keys.end(), [this](const char* key) { return has(key); }) != 1) {
      from->refuse("needs exactly one of the keys " + list + ".");
    }
  }
  /// Refuses keys that another given key replaces. @param why  the message; null: a message that names both keys
  void alone(const char* key, const std::vector<const char*>& others, const char* why = nullptr) const {
    for (const char* other : others) {
      if (has(key) && has(other)) {
        why != nullptr ? refuse(key, why)
                       : from->refuse(std::string("has both ") + key + " and " + other + "; remove one of the two.");
      }
    }
  }
  /// Refuses two lists of different lengths, unless one is empty.
  void one_each(const char* key, std::size_t entries, const char* what, std::size_t others, const char* of_what) const {
    if (entries > 0 && others > 0 && entries != others) {
      refuse(key, "holds " + std::to_string(entries) + what + std::to_string(others) + of_what +
                      "; give one for each, in the same order.");
    }
  }
};

/// An object in JSON that has no type of its own.
struct Nested {
  std::function<void(Keys&)> list;
};

void visit(Keys& keys, Nested& object) {
  object.list(keys);
}

template <class Object>
void read(const JsonValue& from, Object& object) {
  Keys names, keys{&from};
  visit(names, object);
  from.require_object(names.names, names.former_key);
  visit(keys, object);
}

template <class Value>
Json json_of(Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return name(value);
  } else if constexpr (std::is_constructible_v<Json, Value&>) {
    return value;
  } else {
    Json json;
    Keys keys{nullptr, &json};
    visit(keys, value);
    return json;
  }
}

double read_setting(const JsonValue& from, const Setting& setting) {
  return setting.kind == Setting::Kind::Choice   ? read_choice(from, setting.choices)
         : setting.kind == Setting::Kind::Whole  ? value_of<int>(from)
         : setting.kind == Setting::Kind::Switch ? value_of<bool>(from)
                                                 : value_of<double>(from);
}

Json json_of(const Setting& setting, double value) {
  if (setting.kind == Setting::Kind::Switch) {
    return value != 0;
  }
  if (setting.kind != Setting::Kind::Choice) {
    return json_of(value);
  }
  const bool is_known = value >= setting.low && value <= setting.high;
  return is_known ? Json(setting.choices[static_cast<std::size_t>(value)]) : Json();
}

void visit(Keys& keys, const Setting& setting, EditSettings& settings) {
  keys.names.push_back(setting.key);
  const bool applies = setting.applies(settings.method);
  if (keys.has(setting.key) && !applies) {
    keys.refuse(setting.key, std::string("has no meaning with the method ") + name(settings.method) +
                                 "; remove it, or use the method " + name(*setting.only) + ".");
  }
  if (keys.has(setting.key)) {
    setting.set(settings, read_setting((*keys.from)[setting.key], setting));
  } else if (keys.to != nullptr && applies && !(setting.kind == Setting::Kind::Switch && setting.get(settings) == 0)) {
    (*keys.to)[setting.key] = json_of(setting, setting.get(settings));
  }
}

void visit(Keys& keys, VertexQuery::Disc& disc) {
  keys.need("point", disc.point);
  keys.need("radius", disc.radius);
}

void visit(Keys& keys, KeptAnchors& anchors) {
  keys.need("vertices", anchors.vertices);
  keys.need("weights", anchors.weights);
  keys.need("depths", anchors.depths);
  keys.may("reach", anchors.reach);
}

void visit_region(Keys& keys, RegionSpec& region, VertexQuery& query) {
  using Kind = RegionSpec::Kind;
  const bool is_set = region.kind == Kind::Vertices;
  bool is_component = region.kind == Kind::Component;
  keys.exactly_one({"radius", "vertices", "component", "within", "selected"});
  keys.alone("anchors", {"radius", "component", "within", "selected"}, "kept anchors go with the key vertices only.");
  const bool has_radius = keys.may("radius", region.radius, region.kind == Kind::Radius);
  keys.may("vertices", region.vertices, is_set && query.empty());
  keys.chosen("component", is_component);
  keys.may("within", query.within);
  keys.chosen("selected", query.selected);
  region.kind = has_radius ? Kind::Radius : is_component ? Kind::Component : Kind::Vertices;
  keys.may("padding", region.padding, !is_component);
  keys.may("connect", region.connect_gap, region.connect_gap != 0);
  keys.may("tips", region.tips);
  keys.may("pieces", region.pieces);
  keys.may("held", region.held);
  keys.may("anchors", region.anchors, is_set && !region.anchors.empty());
}

/// Visits the object of the key "rotation".
void visit(Keys& keys, HandleTransform& transform) {
  keys.may("axis", transform.axis);
  keys.may("degrees", transform.degrees);
  keys.may("center", transform.center);
}

void visit(Keys& keys, FitStep& fit) {
  ScanFitSettings& settings = fit.settings;
  keys.may("to", fit.to, !fit.to.empty());
  keys.may("mode", settings.mode);
  keys.may("align", settings.align);
  keys.may("detail", settings.detail);
  keys.may("distance", settings.distance);
  keys.may("accuracy", settings.accuracy);
  keys.may("borders", settings.borders);
  Nested exclude = {[&fit](Keys& inside) {
    inside.may("vertices", fit.exclude);
    inside.may_list_faces("scan_faces", fit.exclude_faces);
    inside.chosen("scan_selected", fit.exclude_selected);
    if (inside.from != nullptr && !inside.has("vertices") && !inside.has("scan_faces") &&
        !inside.has("scan_selected")) {
      inside.from->refuse("needs vertices, scan_faces or scan_selected.");
    }
  }};
  keys.may("exclude", exclude, !fit.exclude.empty() || !fit.exclude_faces.empty() || fit.exclude_selected);
  if (keys.from != nullptr) {
    fit.folder = keys.from->source->folder;
  }
  if (keys.has("to")) {
    named_file((*keys.from)["to"]);
    if (fit.to.empty()) {
      keys.refuse("to", "is empty; give the file of a scan, or remove the key to make the mesh symmetric.");
    }
  }
}

/// Replaces a group by the landmarks of two files.
void visit_landmarks(Keys& keys, HandleGroup& group) {
  std::string file;
  keys.need("from", file);
  keys.need("to", file);
  if (const JsonValue* const files = keys.from; files != nullptr) {
    const std::string first = named_file((*files)["from"]), second = named_file((*files)["to"]);
    group =
        keyed(files->where, [&] { return refused_at(files->where, [&] { return load_landmarks(first, second); }); });
  }
}

void visit(Keys& keys, HandleGroup& handle) {
  VertexQuery& query = handle.query;
  HandleTransform& transform = handle.transform;
  const bool has_targets = !handle.targets.empty(), has_parts = !has_targets && !transform.matrix;
  Nested landmarks = {[&handle](Keys& inside) { visit_landmarks(inside, handle); }};
  keys.exactly_one({"vertices", "points", "within", "selected", "landmarks"});
  keys.alone("landmarks", {"targets", "translation", "rotation", "scale", "matrix"});
  keys.alone("targets", {"translation", "rotation", "scale", "matrix"});
  keys.alone("matrix", {"translation", "rotation", "scale"});
  keys.alone("weights", {"within", "selected"}, "goes with vertices, points or landmarks only.");
  keys.alone("targets", {"within", "selected"},
             "goes with points or vertices only, since each target needs its vertex.");
  keys.may("vertices", handle.vertices, query.empty());
  keys.may("points", query.points);
  keys.may("within", query.within);
  keys.chosen("selected", query.selected);
  keys.may("landmarks", landmarks, false);  // points and targets are written
  keys.may("weights", handle.weights);
  keys.may("targets", handle.targets);
  keys.one_each("weights", handle.weights.size(), " numbers for ", query.points.size(), " points");
  keys.one_each("targets", handle.targets.size(), " targets for ", query.points.size(), " points");
  for (std::size_t k = 0; keys.has("targets") && k < query.points.size(); ++k) {
    handle.names.push_back((*keys.from)["points"][k].where);
  }
  keys.may("slide", handle.slide, handle.slide != 1);
  if (!(handle.slide >= 0 && handle.slide <= 1)) {
    keys.refuse("slide", "expected a number from 0 to 1, found " + number_text(handle.slide) + ".");
  }
  keys.alone("slide", {"translation", "rotation", "scale", "matrix"}, "goes with targets or landmarks only.");
  keys.may("translation", transform.translation, has_parts);
  keys.may("rotation", transform, has_parts);
  keys.may("scale", transform.scale, has_parts);
  keys.may("matrix", transform.matrix, !has_targets && transform.matrix);
}

void visit(Keys& keys, MirrorPlane& mirror) {
  keys.need("point", mirror.point);
  keys.need("normal", mirror.normal);
}

void visit(Keys& keys, EditStep& step) {
  Nested region = {[&step](Keys& inside) { visit_region(inside, step.region, step.region_query); }};
  keys.need("region", region);
  keys.may("fit", step.fit);
  const bool is_empty = keys.has("handles") && (*keys.from)["handles"].json == Json::array();
  const bool is_alone =
      keys.from == nullptr ? step.handles.empty() : (!keys.has("handles") || is_empty) && keys.has("detail");
  const bool is_detail = is_alone && step.region.kind == RegionSpec::Kind::Vertices;
  if (is_alone && !is_detail && !step.fit) {
    keys.refuse("detail",
                "needs handles in this region, since radius and component begin at a handle; give the region by "
                "vertices, within or selected.");
  }
  if (!step.fit && (keys.from != nullptr || keys.to != nullptr) && !is_detail) {
    keys.need("handles", step.handles);
  } else if (!is_empty) {
    keys.may("handles", step.handles);
  }
  keys.may("mirror", step.mirror);
  for (std::size_t g = 0; step.fit && g < step.handles.size(); ++g) {
    if (step.handles[g].targets.empty()) {
      keys.refuse("fit", "handles[" + std::to_string(g) + "] has no targets, but the handles of a fit are landmarks.");
    }
  }
  for (std::size_t g = 0; !step.fit && g < step.handles.size(); ++g) {
    if (step.handles[g].slide != 1) {
      keys.refuse("handles", "slide goes with a fit only, since targets slide along its scan.");
    }
  }
  keys.former("weld",
              "can no longer be switched off, since vertices at the same place always move as one; remove the key, and "
              "move vertices that shall come apart to different places, or into different files, before the edit.");
  for (const Setting& setting : settings_table()) {
    visit(keys, setting, step.settings);
  }
}

void visit(Keys& keys, VertexPositions& positions) {
  const std::vector<int>& vertices = positions.vertices;
  keys.need("vertices", positions.vertices);
  keys.need("points", positions.points);
  keys.one_each("points", positions.points.size(), " positions of ", vertices.size(), " vertices");
  const auto wrong = std::adjacent_find(vertices.begin(), vertices.end(), std::greater_equal<>());
  if (wrong != vertices.end()) {
    keys.refuse("vertices", "vertex " + std::to_string(wrong[1]) + " comes after " + std::to_string(wrong[0]) +
                                "; put them in ascending order, each once.");
  }
}

/// Limits vertex lists to the vertices of the edit's mesh, or to those whose positions it gives.
void limit_lists(const JsonValue& description, const Edit& edit) {
  Source& source = *description.source;
  if (edit.mesh_vertices) {
    try {
      if (source.mesh != nullptr && *edit.mesh_vertices != source.mesh->vertices.rows()) {
        require_same_mesh(*source.mesh, edit);
      }
    } catch (const EditError& error) {
      source.later = error;
    }
    source.limits.end = source.limits.most = *edit.mesh_vertices;
  } else if (description.has("positions") && !edit.mesh_faces && edit.connectivity.empty()) {
    source.limits = {};
    source.limits.most = static_cast<std::int64_t>(description["positions"]["points"].json.size());
    source.limits.by_position = true;
  }
}

/// Visits the description of the edit's mesh.
void visit_mesh(Keys& keys, Edit& edit) {
  keys.may("vertices", edit.mesh_vertices);
  keys.may("faces", edit.mesh_faces);
  if (keys.may("connectivity", edit.connectivity, !edit.connectivity.empty()) &&
      (edit.connectivity.size() != 16 ||
       edit.connectivity.find_first_not_of("0123456789abcdef") != std::string::npos)) {
    keys.refuse("connectivity", "expected a checksum of 16 digits from 0 to 9 and a to f, found the text " +
                                    quoted_text(edit.connectivity) + ".");
  }
  if (keys.from != nullptr) {
    limit_lists(*keys.from, edit);
  }
  keys.may("positions", edit.positions, !edit.positions.vertices.empty());
  if (keys.from != nullptr && edit.by_position()) {
    keys.from->source->limits.end = edit.positions.vertices.back() + std::int64_t{1};
  }
}

void visit(Keys& keys, Edit& edit) {
  int version = kVersion;
  Nested mesh = {[&edit](Keys& inside) { visit_mesh(inside, edit); }};
  keys.need("laplacian_edit", version);
  keys.may("mesh", mesh,
           edit.mesh_vertices || edit.mesh_faces || !edit.connectivity.empty() || !edit.positions.vertices.empty());
  keys.need("steps", edit.steps);
}

}  // namespace

Edit read_edit(const std::string& json, const std::string& folder, const TriangleMesh* mesh,
               std::vector<std::string>* files) {
  const Json root = parse_json(json);
  Edit edit;
  Source source = {folder, mesh, files};
  if (mesh != nullptr) {
    source.limits.end = source.limits.most = mesh->vertices.rows();
  }
  const JsonValue whole = {root, "edit", &source};
  // Check the version first, since another version may have other keys.
  if (const JsonValue version = whole["laplacian_edit"]; !(version.json == kVersion)) {
    version.refuse_kind("the number " + std::to_string(kVersion) + ", the version of this format");
  }
  read(whole, edit);
  if (source.later) {
    throw EditError(*source.later);
  }
  return edit;
}

Edit load_edit(const std::string& text_or_path, const TriangleMesh* mesh) {
  const std::string text = trimmed(text_or_path);
  if (text.compare(0, 1, "{") == 0 || text.compare(0, 3, "\xEF\xBB\xBF") == 0) {
    return read_edit(text, {}, mesh);
  }
  if (text.empty()) {
    refuse_json("No edit is given; give JSON text that begins with {, or the path of a .json file.");
  }
  const std::string json = read_text_file(text, "is neither JSON text, which begins with {, nor the path of a file");
  const std::string folder = std::filesystem::path(text).parent_path().string();
  return refused_at(quoted_text(text), [&] { return read_edit(json, folder, mesh); });
}

std::string write_edit(Edit edit) {
  std::string text = json_of(edit).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  read_edit(text);  // throws if the text could not be read again
  return text;
}

}  // namespace lapedit
