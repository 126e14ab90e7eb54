// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/edit_script.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/json/json_object.h"
#include "lapedit/json/landmarks.h"

namespace lapedit {
namespace {

constexpr int kVersion = 1;
constexpr std::int64_t kMostListedVertices = 100000000;  // of all lists of an edit together

/// Reads vertex lists, and counts the vertices before memory is allocated for them.
class VertexLists {
 public:
  explicit VertexLists(const std::optional<int>& mesh_vertices) : mesh_vertices_(mesh_vertices) {}

  std::vector<int> read(const JsonObject& object, const char* key) {
    const std::string where = object.where(key) + ": ";
    const std::string& text = object.text(key);
    const char* const end = text.data() + text.size();
    std::vector<std::pair<int, int>> ranges;
    std::int64_t count = 0;
    const char* at = text.data();
    for (bool more = true; more;) {
      const char* const piece = at;
      int first = 0, last = 0;
      bool good = number(at, end, first);
      last = first;
      if (good && at != end && *at == '-') {
        good = number(++at, end, last);
      }
      if (!good || (at != end && *at != ',')) {
        refuse_json(where + offender(piece, end) +
                    " is no vertex number or range; write them as in \"12-40,77\", from 0 to " +
                    std::to_string(std::numeric_limits<int>::max()) + ".");
      }
      if (last < first) {
        refuse_json(where + offender(piece, end) + " is a range from high to low; put the lower vertex first.");
      }
      if (mesh_vertices_ && last >= *mesh_vertices_) {
        refuse_json(where + "vertex " + std::to_string(last) + " is outside the edit's mesh, which has " +
                    std::to_string(*mesh_vertices_) + " vertices, counted from 0.");
      }
      count += static_cast<std::int64_t>(last) - first + 1;
      check(where, count);
      ranges.emplace_back(first, last);
      more = at != end;
      at += more;
    }
    total_ += count;
    std::vector<int> vertices;
    vertices.reserve(static_cast<std::size_t>(count));
    for (const auto& [first, last] : ranges) {
      for (int vertex = first; vertex < last; ++vertex) {
        vertices.push_back(vertex);
      }
      vertices.push_back(last);  // separately, since last + 1 may overflow
    }
    return vertices;
  }

 private:
  static bool number(const char*& at, const char* end, int& value) {
    const auto skip_space = [&] {
      while (at != end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r')) ++at;
    };
    skip_space();
    if (at == end || *at < '0' || *at > '9') {  // from_chars would accept a minus sign
      return false;
    }
    const auto [stop, error] = std::from_chars(at, end, value);
    at = stop;
    skip_space();
    return error == std::errc();
  }

  static std::string offender(const char* piece, const char* end) {
    return quoted_text(std::string(piece, std::find(piece, end, ',')));
  }

  void check(const std::string& where, std::int64_t count) const {
    if (mesh_vertices_ && count > *mesh_vertices_) {
      refuse_json(where + "lists " + std::to_string(count) + " vertices or more, but the edit's mesh has only " +
                  std::to_string(*mesh_vertices_) + "; list each vertex once.");
    }
    if (total_ + count > kMostListedVertices) {
      refuse_json(where + "the vertex lists up to here hold " + std::to_string(total_ + count) +
                  " vertices or more; an edit may list " + std::to_string(kMostListedVertices) + ".");
    }
  }

  std::optional<int> mesh_vertices_;
  std::int64_t total_ = 0;
};

void require_true(const JsonObject& object, const char* key) {
  if (object[key] != true) {
    object.refuse_key(key, "true");
  }
}

/// Refuses an object unless it has exactly one of some keys.
void require_one_of(const JsonObject& object, const std::vector<const char*>& keys) {
  std::string list;
  int count = 0;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    list += std::string(k == 0 ? "" : k + 1 < keys.size() ? ", " : " and ") + keys[k];
    count += object.has(keys[k]) ? 1 : 0;
  }
  if (count != 1) {
    refuse_json(object.where() + ": needs exactly one of the keys " + list + ".");
  }
}

/// Reads the vertices of a region or a group, or the query that finds them.
void read_vertices(const JsonObject& object, VertexLists& lists, std::vector<int>& vertices, VertexQuery& query) {
  if (object.has("vertices")) {
    vertices = lists.read(object, "vertices");
  } else if (object.has("points")) {
    query.points = object.point_list("points", "points");
  } else if (object.has("within")) {
    const JsonObject disc(object["within"], object.where("within"), {"point", "radius"});
    if (!disc.has("radius")) {
      disc.refuse_key("radius", "a number");
    }
    query.within = VertexQuery::Disc{disc.numbers<3>("point"), disc.number("radius", 0)};
  } else {
    require_true(object, "selected");
    query.selected = true;
  }
}

RegionSpec read_region(const JsonObject& object, VertexLists& lists, VertexQuery& query) {
  require_one_of(object, {"radius", "vertices", "component", "within", "selected"});
  RegionSpec region;
  if (object.has("radius")) {
    region.radius = object.number("radius", region.radius);
  } else if (object.has("component")) {
    region.kind = RegionSpec::Kind::Component;
    require_true(object, "component");
  } else {
    region.kind = RegionSpec::Kind::Vertices;
    read_vertices(object, lists, region.vertices, query);
  }
  region.padding = object.number("padding", region.padding);
  region.connect_gap = object.number("connect", region.connect_gap);
  if (object.has("held")) {
    region.held = lists.read(object, "held");
  }
  if (object.has("anchors")) {
    if (!object.has("vertices")) {
      refuse_json(object.where("anchors") + ": kept anchors go with the key vertices only.");
    }
    const JsonObject anchors(object["anchors"], object.where("anchors"), {"vertices", "weights", "depths", "reach"});
    region.anchors.vertices = lists.read(anchors, "vertices");
    region.anchors.weights = anchors.number_list("weights");
    region.anchors.depths = anchors.number_list("depths");
    region.anchors.reach = anchors.number("reach", 0);
  }
  return region;
}

/// Refuses keys that another given key replaces.
void require_alone(const JsonObject& object, const char* key, const std::vector<const char*>& others) {
  for (const char* other : others) {
    if (object.has(other)) {
      refuse_json(object.where() + ": has both " + key + " and " + other + "; remove one of the two.");
    }
  }
}

HandleTransform read_transform(const JsonObject& object) {
  HandleTransform transform;
  if (object.has("matrix")) {
    require_alone(object, "matrix", {"translation", "rotation", "scale"});
    const auto numbers = object.numbers<16>("matrix");
    if (numbers.tail<4>() != Eigen::Vector4d(0, 0, 0, 1)) {
      refuse_json(object.where("matrix") + ": the last row (the last four numbers) has to be 0, 0, 0, 1.");
    }
    transform.matrix.emplace(numbers.data());
    return transform;
  }
  if (object.has("translation")) {
    transform.translation = object.numbers<3>("translation");
  }
  if (object.has("rotation")) {
    const JsonObject rotation(object["rotation"], object.where("rotation"), {"axis", "degrees", "center"});
    if (rotation.has("axis")) {
      transform.axis = rotation.numbers<3>("axis");
    }
    transform.degrees = rotation.number("degrees", transform.degrees);
    if (rotation.has("center")) {
      transform.center = rotation.numbers<3>("center");
    }
  }
  transform.scale = object.number("scale", transform.scale);
  return transform;
}

/// The context of the text: its vertex lists, and the folder of file names in it.
struct Source {
  VertexLists& lists;
  const std::string& folder;

  std::string path(const std::string& name) const {
    const std::filesystem::path path(name);
    return path.is_absolute() || folder.empty() ? name : (std::filesystem::path(folder) / path).string();
  }
};

HandleGroup read_landmark_keys(const JsonObject& object, const Source& source) {
  const JsonObject files(object["landmarks"], object.where("landmarks"), {"from", "to"});
  const std::string &from = files.text("from"), &to = files.text("to");
  try {
    return load_landmarks(source.path(from), source.path(to));
  } catch (const EditError& refusal) {
    throw EditError(refusal.cause(), files.where() + ": " + refusal.what());
  }
}

/// Reads targets of points or of vertices.
void read_targets(const JsonObject& object, HandleGroup& handle) {
  require_alone(object, "targets", {"translation", "rotation", "scale", "matrix"});
  handle.targets = object.point_list("targets", "points");
  if (handle.query.within || handle.query.selected) {
    refuse_json(object.where("targets") + ": goes with points or vertices only, since each target needs its vertex.");
  }
  const std::size_t points = handle.query.points.size();
  if (points > 0 && points != handle.targets.size()) {
    refuse_json(object.where("targets") + ": " + std::to_string(handle.targets.size()) + " targets are given for " +
                std::to_string(points) + " points; give one for each, in the same order.");
  }
  for (std::size_t k = 0; k < points; ++k) {
    handle.names.push_back(object.where("points") + "[" + std::to_string(k) + "]");
  }
}

HandleGroup read_handle(const JsonObject& object, const Source& source) {
  require_one_of(object, {"vertices", "points", "within", "selected", "landmarks"});
  HandleGroup handle;
  if (object.has("landmarks")) {
    require_alone(object, "landmarks", {"targets", "translation", "rotation", "scale", "matrix"});
    handle = read_landmark_keys(object, source);
  } else {
    read_vertices(object, source.lists, handle.vertices, handle.query);
  }
  if (object.has("weights")) {
    handle.weights = object.number_list("weights");
    if (handle.query.within || handle.query.selected) {
      refuse_json(object.where("weights") + ": goes with vertices, points or landmarks only.");
    }
    if (!handle.query.points.empty() && handle.weights.size() != handle.query.points.size()) {
      refuse_json(object.where("weights") + ": holds " + std::to_string(handle.weights.size()) + " numbers for " +
                  std::to_string(handle.query.points.size()) + " points; give one for each, in the same order.");
    }
  }
  if (object.has("targets")) {
    read_targets(object, handle);
  } else if (!object.has("landmarks")) {
    handle.transform = read_transform(object);
  }
  return handle;
}

VertexPositions read_positions(const JsonObject& object, VertexLists& lists) {
  VertexPositions positions = {lists.read(object, "vertices"), object.point_list("points", "points")};
  if (positions.points.size() != positions.vertices.size()) {
    refuse_json(object.where("points") + ": holds " + std::to_string(positions.points.size()) + " positions of " +
                std::to_string(positions.vertices.size()) + " vertices; give one for each, in the same order.");
  }
  for (std::size_t k = 1; k < positions.vertices.size(); ++k) {
    if (positions.vertices[k] <= positions.vertices[k - 1]) {
      refuse_json(object.where("vertices") + ": vertex " + std::to_string(positions.vertices[k]) + " comes after " +
                  std::to_string(positions.vertices[k - 1]) + "; put them in ascending order, each once.");
    }
  }
  return positions;
}

void read_setting(const JsonObject& object, const Setting& setting, EditSettings& settings) {
  if (object.has(setting.key) && !setting.applies(settings.method)) {
    refuse_json(object.where(setting.key) + ": has no meaning with the method " + name(settings.method) +
                "; remove it, or use the method " + name(*setting.only) + ".");
  }
  const double absent = setting.get(settings);
  switch (setting.kind) {
    case Setting::Kind::Choice:
      return setting.set(settings, object.choice(setting.key, setting.choices, static_cast<int>(absent)));
    case Setting::Kind::Whole:
      return setting.set(settings, object.integer(setting.key, static_cast<int>(absent)));
    default:
      return setting.set(settings, object.number(setting.key, absent));
  }
}

EditStep read_step(const Json& value, const std::string& where, const Source& source) {
  std::vector<const char*> keys = {"region", "handles", "mirror"};
  for (const Setting& setting : settings_table()) {
    keys.push_back(setting.key);
  }
  const JsonObject object(value, where, keys);
  EditStep step;
  if (!object.has("region")) {
    object.refuse_key("region", "an object");
  }
  const JsonObject region(
      object["region"], object.where("region"),
      {"radius", "vertices", "component", "within", "selected", "padding", "anchors", "held", "connect"});
  step.region = read_region(region, source.lists, step.region_query);
  const Json& handles = object.filled_list("handles", "handle groups");
  for (std::size_t i = 0; i < handles.size(); ++i) {
    const JsonObject handle(handles[i], object.where("handles") + "[" + std::to_string(i) + "]",
                            {"vertices", "points", "within", "selected", "landmarks", "weights", "targets",
                             "translation", "rotation", "scale", "matrix"});
    step.handles.push_back(read_handle(handle, source));
  }
  if (object.has("mirror")) {
    const JsonObject mirror(object["mirror"], object.where("mirror"), {"point", "normal"});
    step.mirror = MirrorPlane{mirror.numbers<3>("point"), mirror.numbers<3>("normal")};
  }
  for (const Setting& setting : settings_table()) {
    read_setting(object, setting, step.settings);
  }
  return step;
}

/// Refuses numbers that are not finite; whole ones become integers, so that they are written as "0" and not "0.0".
void tidy(Json& json) {
  constexpr double kLargestWhole = 9007199254740992;  // 2^53
  if (json.is_structured()) {
    std::for_each(json.begin(), json.end(), tidy);
  } else if (json.is_number_float()) {
    const auto value = json.get<double>();
    if (!std::isfinite(value)) {
      throw EditError(ErrorCause::NotFinite, "The edit cannot be written: one of its numbers is NaN or infinite.");
    }
    if (value == std::floor(value) && std::abs(value) <= kLargestWhole) {
      json = static_cast<std::int64_t>(value);
    }
  }
}

Json json_of(const Vector3& vector) {
  return {vector[0], vector[1], vector[2]};
}

Json json_of(const std::vector<Vector3>& points) {
  Json list = Json::array();
  for (const Vector3& point : points) {
    list.push_back(json_of(point));
  }
  return list;
}

/// Writes consecutive numbers as ranges.
Json json_of(const std::vector<int>& vertices) {
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

/// Writes what read_vertices() reads.
void write_vertices(const std::vector<int>& vertices, const VertexQuery& query, Json& json) {
  if (!query.points.empty()) {
    json["points"] = json_of(query.points);
  } else if (query.within) {
    json["within"] = {{"point", json_of(query.within->point)}, {"radius", query.within->radius}};
  } else if (query.selected) {
    json["selected"] = true;
  } else {
    json["vertices"] = json_of(vertices);
  }
}

Json json_of(const RegionSpec& region, const VertexQuery& query) {
  Json json;
  if (region.kind == RegionSpec::Kind::Component) {
    json["component"] = true;
  } else if (region.kind == RegionSpec::Kind::Radius) {
    json["radius"] = region.radius;
  } else {
    write_vertices(region.vertices, query, json);
  }
  if (region.kind != RegionSpec::Kind::Component) {
    json["padding"] = region.padding;
  }
  if (region.connect_gap != 0) {
    json["connect"] = region.connect_gap;
  }
  if (!region.held.empty()) {
    json["held"] = json_of(region.held);
  }
  if (region.kind == RegionSpec::Kind::Vertices && !region.anchors.empty()) {
    json["anchors"] = {{"vertices", json_of(region.anchors.vertices)},
                       {"weights", region.anchors.weights},
                       {"depths", region.anchors.depths},
                       {"reach", region.anchors.reach}};
  }
  return json;
}

Json json_of(const HandleGroup& handle) {
  const HandleTransform& t = handle.transform;
  Json json;
  write_vertices(handle.vertices, handle.query, json);
  if (!handle.weights.empty()) {
    json["weights"] = handle.weights;
  }
  if (!handle.targets.empty()) {
    json["targets"] = json_of(handle.targets);
    return json;
  }
  if (t.matrix) {
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
    matrix.topRows<3>() = *t.matrix;
    json["matrix"] = std::vector<double>(matrix.data(), matrix.data() + 16);
    return json;
  }
  json["translation"] = json_of(t.translation);
  json["rotation"] = {{"axis", json_of(t.axis)}, {"degrees", t.degrees}};
  if (t.center) {
    json["rotation"]["center"] = json_of(*t.center);
  }
  json["scale"] = t.scale;
  return json;
}

Json json_of(const Setting& setting, double value) {
  if (setting.kind != Setting::Kind::Choice) {
    return value;
  }
  const bool known = value >= setting.low && value <= setting.high;
  return known ? Json(setting.choices[static_cast<std::size_t>(value)]) : Json();
}

Json json_of(const EditStep& step) {
  Json json = {{"region", json_of(step.region, step.region_query)}, {"handles", Json::array()}};
  for (const HandleGroup& handle : step.handles) {
    json["handles"].push_back(json_of(handle));
  }
  if (step.mirror) {
    json["mirror"] = {{"point", json_of(step.mirror->point)}, {"normal", json_of(step.mirror->normal)}};
  }
  for (const Setting& setting : settings_table()) {
    if (setting.applies(step.settings.method)) {
      json[setting.key] = json_of(setting, setting.get(step.settings));
    }
  }
  return json;
}

Json json_of(const Edit& edit) {
  Json json = {{"laplacian_edit", kVersion}}, mesh;
  if (edit.mesh_vertices) {
    mesh["vertices"] = *edit.mesh_vertices;
  }
  if (edit.mesh_faces) {
    mesh["faces"] = *edit.mesh_faces;
  }
  if (!edit.connectivity.empty()) {
    mesh["connectivity"] = edit.connectivity;
  }
  if (!edit.positions.vertices.empty()) {
    mesh["positions"] = {{"vertices", json_of(edit.positions.vertices)}, {"points", json_of(edit.positions.points)}};
  }
  if (!mesh.is_null()) {
    json["mesh"] = std::move(mesh);
  }
  json["steps"] = Json::array();
  for (const EditStep& step : edit.steps) {
    json["steps"].push_back(json_of(step));
  }
  return json;
}

}  // namespace

Edit read_edit(const std::string& json, const std::string& folder) {
  const Json root = parse_json(json);
  const auto version = root.find("laplacian_edit");
  // The version is checked first, since another version may have other keys.
  if (version == root.end() || *version != kVersion) {
    refuse_json("laplacian_edit: expected the number " + std::to_string(kVersion) + ", the version of this format, " +
                (version == root.end() ? "but the key is missing" : "found " + describe(*version)) + ".");
  }
  const JsonObject object(root, "edit", {"laplacian_edit", "mesh", "steps"});
  Edit edit;
  if (object.has("mesh")) {
    const JsonObject mesh(object["mesh"], "mesh", {"vertices", "faces", "connectivity", "positions"});
    if (mesh.has("vertices")) {
      edit.mesh_vertices = mesh.integer("vertices", 0);
    }
    if (mesh.has("faces")) {
      edit.mesh_faces = mesh.integer("faces", 0);
    }
    if (mesh.has("connectivity")) {
      edit.connectivity = mesh.text("connectivity");
      if (edit.connectivity.size() != 16 ||
          edit.connectivity.find_first_not_of("0123456789abcdef") != std::string::npos) {
        mesh.refuse_key("connectivity", "a checksum of 16 digits from 0 to 9 and a to f");
      }
    }
  }
  VertexLists lists(edit.mesh_vertices);
  const Source source = {lists, folder};
  if (object.has("mesh") && object["mesh"].contains("positions")) {
    edit.positions =
        read_positions(JsonObject(object["mesh"]["positions"], "mesh.positions", {"vertices", "points"}), lists);
  }
  const Json& steps = object.filled_list("steps", "steps");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    edit.steps.push_back(read_step(steps[i], "steps[" + std::to_string(i) + "]", source));
  }
  return edit;
}

Edit load_edit(const std::string& text_or_path) {
  namespace fs = std::filesystem;
  const std::string text = trimmed(text_or_path);
  if (text.compare(0, 1, "{") == 0 || text.compare(0, 3, "\xEF\xBB\xBF") == 0) {
    return read_edit(text);
  }
  if (text.empty()) {
    refuse_json("No edit is given; give JSON text that begins with {, or the path of a .json file.");
  }
  std::error_code error;
  if (!fs::is_regular_file(text, error)) {
    refuse_json(quoted_text(text) + " is neither JSON text, which begins with {, nor the path of a file.");
  }
  const std::string json = read_text_file(text);
  try {
    return read_edit(json, fs::path(text).parent_path().string());
  } catch (const EditError& refusal) {
    throw EditError(refusal.cause(), quoted_text(text) + ": " + refusal.what());
  }
}

std::string write_edit(const Edit& edit) {
  Json json = json_of(edit);
  tidy(json);
  std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  read_edit(text);  // refuses text that could not be read again, with the same message
  return text;
}

}  // namespace lapedit
