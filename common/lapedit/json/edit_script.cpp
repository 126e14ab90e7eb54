// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/edit_script.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/json/json_object.h"

namespace lapedit {
namespace {

constexpr int kVersion = 1;
constexpr std::int64_t kMostListedVertices = 100000000;  // in all lists of an edit together

/// Reads vertex lists, counting what they expand to before memory is taken for it.
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
      vertices.push_back(last);  // apart, since last + 1 may overflow
    }
    return vertices;
  }

 private:
  static bool number(const char*& at, const char* end, int& value) {
    const auto skip_space = [&] {
      while (at != end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r')) ++at;
    };
    skip_space();
    if (at == end || *at < '0' || *at > '9') {  // from_chars would take a minus sign
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

RegionSpec read_region(const JsonObject& object, VertexLists& lists) {
  if (object.has("radius") + object.has("vertices") + object.has("component") != 1) {
    refuse_json(object.where() + ": needs exactly one of the keys radius, vertices and component.");
  }
  RegionSpec region;
  if (object.has("radius")) {
    region.radius = object.number("radius", region.radius);
  } else if (object.has("vertices")) {
    region.kind = RegionSpec::Kind::Vertices;
    region.vertices = lists.read(object, "vertices");
  } else {
    region.kind = RegionSpec::Kind::Component;
    if (object["component"] != true) {
      object.refuse_key("component", "true");
    }
  }
  region.padding = object.number("padding", region.padding);
  region.connect_gap = object.number("connect", region.connect_gap);
  if (object.has("held")) {
    region.held = lists.read(object, "held");
  }
  if (object.has("anchors")) {
    if (region.kind != RegionSpec::Kind::Vertices) {
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

/// Refuses the others beside a key that replaces them.
void require_alone(const JsonObject& object, const char* key, const std::vector<const char*>& others) {
  for (const char* other : others) {
    if (object.has(other)) {
      refuse_json(object.where() + ": has both " + key + " and " + other + "; drop one of the two.");
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

HandleGroup read_handle(const JsonObject& object, VertexLists& lists) {
  HandleGroup handle;
  handle.vertices = lists.read(object, "vertices");
  if (object.has("weights")) {
    handle.weights = object.number_list("weights");
  }
  if (object.has("targets")) {
    require_alone(object, "targets", {"translation", "rotation", "scale", "matrix"});
    handle.targets = object.point_list("targets", "points");
  } else {
    handle.transform = read_transform(object);
  }
  return handle;
}

void read_setting(const JsonObject& object, const Setting& setting, EditSettings& settings) {
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

EditStep read_step(const Json& value, const std::string& where, VertexLists& lists) {
  std::vector<const char*> keys = {"region", "handles", "mirror"};
  for (const Setting& setting : settings_table()) {
    keys.push_back(setting.key);
  }
  const JsonObject object(value, where, keys);
  EditStep step;
  if (!object.has("region")) {
    object.refuse_key("region", "an object");
  }
  const JsonObject region(object["region"], object.where("region"),
                          {"radius", "vertices", "component", "padding", "anchors", "held", "connect"});
  step.region = read_region(region, lists);
  const Json& handles = object.filled_list("handles", "handle groups");
  for (std::size_t i = 0; i < handles.size(); ++i) {
    const JsonObject handle(handles[i], object.where("handles") + "[" + std::to_string(i) + "]",
                            {"vertices", "weights", "targets", "translation", "rotation", "scale", "matrix"});
    step.handles.push_back(read_handle(handle, lists));
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

Json json_of(double value) {
  if (!std::isfinite(value)) {
    throw EditError(ErrorCause::NotFinite, "The edit cannot be written: one of its numbers is NaN or infinite.");
  }
  constexpr double kLargestWhole = 9007199254740992;  // 2^53
  if (value == std::floor(value) && std::abs(value) <= kLargestWhole) {
    return static_cast<std::int64_t>(value);  // "0" and not "0.0"
  }
  return value;
}

Json json_of(const double* values, std::size_t count) {
  Json list = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    list.push_back(json_of(values[i]));
  }
  return list;
}

Json json_of(const std::vector<double>& values) {
  return json_of(values.data(), values.size());
}

Json json_of(const Vector3& vector) {
  return json_of(vector.data(), 3);
}

/// Consecutive numbers become ranges.
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

Json json_of(const KeptAnchors& anchors) {
  return {{"vertices", json_of(anchors.vertices)},
          {"weights", json_of(anchors.weights)},
          {"depths", json_of(anchors.depths)},
          {"reach", json_of(anchors.reach)}};
}

Json json_of(const RegionSpec& region) {
  Json json = Json::object();
  switch (region.kind) {
    case RegionSpec::Kind::Component:
      json["component"] = true;
      break;
    case RegionSpec::Kind::Vertices:
      json["vertices"] = json_of(region.vertices);
      break;
    case RegionSpec::Kind::Radius:
      json["radius"] = json_of(region.radius);
  }
  if (region.kind != RegionSpec::Kind::Component) {
    json["padding"] = json_of(region.padding);
  }
  if (region.connect_gap != 0) {
    json["connect"] = json_of(region.connect_gap);
  }
  if (!region.held.empty()) {
    json["held"] = json_of(region.held);
  }
  if (region.kind == RegionSpec::Kind::Vertices && !region.anchors.empty()) {
    json["anchors"] = json_of(region.anchors);
  }
  return json;
}

Json json_of(const HandleGroup& handle) {
  const HandleTransform& t = handle.transform;
  Json json = {{"vertices", json_of(handle.vertices)}};
  if (!handle.weights.empty()) {
    json["weights"] = json_of(handle.weights);
  }
  if (!handle.targets.empty()) {
    json["targets"] = Json::array();
    for (const Vector3& target : handle.targets) {
      json["targets"].push_back(json_of(target));
    }
    return json;
  }
  if (t.matrix) {
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
    matrix.topRows<3>() = *t.matrix;
    json["matrix"] = json_of(matrix.data(), 16);
    return json;
  }
  json["translation"] = json_of(t.translation);
  json["rotation"] = {{"axis", json_of(t.axis)}, {"degrees", json_of(t.degrees)}};
  if (t.center) {
    json["rotation"]["center"] = json_of(*t.center);
  }
  json["scale"] = json_of(t.scale);
  return json;
}

Json json_of(const Setting& setting, double value) {
  if (setting.kind != Setting::Kind::Choice) {
    return json_of(value);
  }
  const bool known = value >= setting.low && value <= setting.high;
  return known ? Json(setting.choices[static_cast<std::size_t>(value)]) : Json();
}

Json json_of(const EditStep& step) {
  Json json = {{"region", json_of(step.region)}, {"handles", Json::array()}};
  for (const HandleGroup& handle : step.handles) {
    json["handles"].push_back(json_of(handle));
  }
  if (step.mirror) {
    json["mirror"] = {{"point", json_of(step.mirror->point)}, {"normal", json_of(step.mirror->normal)}};
  }
  for (const Setting& setting : settings_table()) {
    json[setting.key] = json_of(setting, setting.get(step.settings));
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
  if (!mesh.is_null()) {
    json["mesh"] = std::move(mesh);
  }
  json["steps"] = Json::array();
  for (const EditStep& step : edit.steps) {
    json["steps"].push_back(json_of(step));
  }
  return json;
}

std::string trimmed(const std::string& text) {
  constexpr const char* kSpace = " \t\n\v\f\r";
  const std::size_t first = text.find_first_not_of(kSpace);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

}  // namespace

Edit read_edit(const std::string& json) {
  const Json root = parse_json(json);
  const auto version = root.find("laplacian_edit");
  // First of all: another version may well have other keys.
  if (version == root.end() || *version != kVersion) {
    refuse_json("laplacian_edit: expected the number " + std::to_string(kVersion) + ", the version of this format, " +
                (version == root.end() ? "but the key is missing" : "found " + describe(*version)) + ".");
  }
  const JsonObject object(root, "edit", {"laplacian_edit", "mesh", "steps"});
  Edit edit;
  if (object.has("mesh")) {
    const JsonObject mesh(object["mesh"], "mesh", {"vertices", "faces", "connectivity"});
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
  const Json& steps = object.filled_list("steps", "steps");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    edit.steps.push_back(read_step(steps[i], "steps[" + std::to_string(i) + "]", lists));
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
  const std::uintmax_t size = fs::file_size(text, error);
  if (!error && size > kLargestJson) {
    refuse_json(quoted_text(text) + " is a file of " + std::to_string(size) + " bytes; the limit for an edit is " +
                std::to_string(kLargestJson) + ".");
  }
  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(text.c_str(), "rb"), std::fclose);
  std::string json;
  if (file) {
    json.resize(static_cast<std::size_t>(size) + 1);  // one more, to see whether it has grown
    json.resize(std::fread(json.data(), 1, json.size(), file.get()));
  }
  if (!file || std::ferror(file.get()) != 0) {
    refuse_json(quoted_text(text) + " cannot be read: " + std::generic_category().message(errno) + ".");
  }
  try {
    return read_edit(json);
  } catch (const EditError& refusal) {
    throw EditError(refusal.cause(), quoted_text(text) + ": " + refusal.what());
  }
}

std::string write_edit(const Edit& edit) {
  std::string json = json_of(edit).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  read_edit(json);  // what cannot be read again is refused now, with the same sentence
  return json;
}

}  // namespace lapedit
