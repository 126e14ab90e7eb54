// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/edit_script.h"

#include <QFile>
#include <QFileInfo>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/json/json_object.h"

namespace lapedit {
namespace {

constexpr int kVersion = 1;
constexpr qint64 kMostListedVertices = 100000000;  // in all lists of an edit together

/// Reads vertex lists, counting what they expand to before memory is taken for it.
class VertexLists {
 public:
  explicit VertexLists(const std::optional<int>& mesh_vertices) : mesh_vertices_(mesh_vertices) {}

  std::vector<int> read(const JsonObject& object, const char* key) {
    const std::string where = object.where(key) + ": ";
    const QByteArray text = object.text(key).toUtf8();
    std::vector<std::pair<int, int>> ranges;
    qint64 count = 0;
    const char* at = text.begin();
    for (bool more = true; more;) {
      const char* const piece = at;
      int first = 0, last = 0;
      bool good = number(at, text.end(), first);
      last = first;
      if (good && at != text.end() && *at == '-') {
        good = number(++at, text.end(), last);
      }
      if (!good || (at != text.end() && *at != ',')) {
        refuse_json(where + offender(piece, text.end()) +
                    " is no vertex number or range; write them as in \"12-40,77\", from 0 to " +
                    std::to_string(std::numeric_limits<int>::max()) + ".");
      }
      if (last < first) {
        refuse_json(where + offender(piece, text.end()) + " is a range from high to low; put the lower vertex first.");
      }
      if (mesh_vertices_ && last >= *mesh_vertices_) {
        refuse_json(where + "vertex " + std::to_string(last) + " is outside the edit's mesh, which has " +
                    std::to_string(*mesh_vertices_) + " vertices, counted from 0.");
      }
      count += static_cast<qint64>(last) - first + 1;
      check(where, count);
      ranges.emplace_back(first, last);
      more = at != text.end();
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
    return quoted(QString::fromUtf8(piece, static_cast<int>(std::find(piece, end, ',') - piece)));
  }

  void check(const std::string& where, qint64 count) const {
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
  qint64 total_ = 0;
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
    if (object["component"] != QJsonValue(true)) {
      object.refuse_key("component", "true");
    }
  }
  region.padding = object.number("padding", region.padding);
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

HandleTransform read_transform(const JsonObject& object) {
  HandleTransform transform;
  if (object.has("matrix")) {
    for (const char* other : {"translation", "rotation", "scale"}) {
      if (object.has(other)) {
        refuse_json(object.where() + ": has both matrix and " + other + "; a matrix says all, drop one of the two.");
      }
    }
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

EditStep read_step(const QJsonValue& value, const std::string& where, VertexLists& lists) {
  std::vector<const char*> keys = {"region", "handles"};
  for (const Setting& setting : settings_table()) {
    keys.push_back(setting.key);
  }
  const JsonObject object(value, where, keys);
  EditStep step;
  if (!object.has("region")) {
    object.refuse_key("region", "an object");
  }
  const JsonObject region(object["region"], object.where("region"),
                          {"radius", "vertices", "component", "padding", "anchors"});
  step.region = read_region(region, lists);
  const QJsonArray handles = object.filled_list("handles", "handle groups");
  for (int i = 0; i < handles.size(); ++i) {
    const JsonObject handle(handles[i], object.where("handles") + "[" + std::to_string(i) + "]",
                            {"vertices", "translation", "rotation", "scale", "matrix"});
    step.handles.push_back({lists.read(handle, "vertices"), read_transform(handle)});
  }
  for (const Setting& setting : settings_table()) {
    read_setting(object, setting, step.settings);
  }
  return step;
}

QByteArray written(double value) {
  if (!std::isfinite(value)) {
    throw EditError(ErrorCause::NotFinite, "The edit cannot be written: one of its numbers is NaN or infinite.");
  }
  return to_json(QJsonValue(value));
}

QByteArray written(const double* values, int count) {
  QByteArray list;
  for (int i = 0; i < count; ++i) {
    list += (i == 0 ? "[" : ",") + written(values[i]);
  }
  return list + "]";
}

/// Consecutive numbers become ranges.
QByteArray written(const std::vector<int>& vertices) {
  QByteArray text = "\"";
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t first = i;
    while (i + 1 < vertices.size() && vertices[i] < vertices[i + 1] && vertices[i] + 1 == vertices[i + 1]) {
      ++i;
    }
    text += (first == 0 ? "" : ",") + QByteArray::number(vertices[first]);
    if (i > first) {
      text += "-" + QByteArray::number(vertices[i]);
    }
  }
  return text + "\"";
}

QByteArray written(const Setting& setting, const EditSettings& settings) {
  const double value = setting.get(settings);
  const QByteArray key = QByteArray("\"") + setting.key + "\": ";
  if (setting.kind != Setting::Kind::Choice) {
    return key + written(value);
  }
  const bool known = value >= 0 && value < static_cast<double>(setting.choices.size());
  return key + (known ? QByteArray("\"") + setting.choices[static_cast<std::size_t>(value)] + "\"" : "null");
}

QByteArray written(const KeptAnchors& anchors) {
  return "{\"vertices\": " + written(anchors.vertices) +
         ", \"weights\": " + written(anchors.weights.data(), static_cast<int>(anchors.weights.size())) +
         ", \"depths\": " + written(anchors.depths.data(), static_cast<int>(anchors.depths.size())) +
         ", \"reach\": " + written(anchors.reach) + "}";
}

QByteArray written(const RegionSpec& region) {
  switch (region.kind) {
    case RegionSpec::Kind::Component:
      return "{\"component\": true}";
    case RegionSpec::Kind::Vertices:
      return "{\"vertices\": " + written(region.vertices) + ", \"padding\": " + written(region.padding) +
             (region.anchors.empty() ? QByteArray() : ",\n    \"anchors\": " + written(region.anchors)) + "}";
    case RegionSpec::Kind::Radius:
      break;
  }
  return "{\"radius\": " + written(region.radius) + ", \"padding\": " + written(region.padding) + "}";
}

QByteArray written(const HandleGroup& handle) {
  const HandleTransform& t = handle.transform;
  const QByteArray vertices = "{\"vertices\": " + written(handle.vertices);
  if (t.matrix) {
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
    matrix.topRows<3>() = *t.matrix;
    return vertices + ", \"matrix\": " + written(matrix.data(), 16) + "}";
  }
  return vertices + ", \"translation\": " + written(t.translation.data(), 3) +
         ", \"rotation\": {\"axis\": " + written(t.axis.data(), 3) + ", \"degrees\": " + written(t.degrees) +
         (t.center ? ", \"center\": " + written(t.center->data(), 3) : QByteArray()) +
         "}, \"scale\": " + written(t.scale) + "}";
}

QByteArray written(const EditStep& step) {
  QByteArray handles;
  for (const HandleGroup& handle : step.handles) {
    handles += (handles.isEmpty() ? "" : ",\n               ") + written(handle);
  }
  QByteArray settings;
  for (const Setting& setting : settings_table()) {
    settings += (settings.isEmpty() ? "" : ", ") + written(setting, step.settings);
  }
  return "{\n   \"region\": " + written(step.region) + ",\n   \"handles\": [" + handles + "],\n   " + settings + "}";
}

}  // namespace

Edit read_edit(const QByteArray& json) {
  const QJsonObject root = parse_json(json);
  const QJsonValue version = root[QLatin1String("laplacian_edit")];
  if (version != QJsonValue(kVersion)) {  // first of all: another version may well have other keys
    refuse_json("laplacian_edit: expected the number " + std::to_string(kVersion) +
                ", the version that is read here, " +
                (version.isUndefined() ? "but the key is missing" : "found " + describe(version)) + ".");
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
      edit.connectivity = mesh.text("connectivity").toStdString();
      if (edit.connectivity.size() != 16 ||
          edit.connectivity.find_first_not_of("0123456789abcdef") != std::string::npos) {
        mesh.refuse_key("connectivity", "a checksum of 16 digits from 0 to 9 and a to f");
      }
    }
  }
  VertexLists lists(edit.mesh_vertices);
  const QJsonArray steps = object.filled_list("steps", "steps");
  for (int i = 0; i < steps.size(); ++i) {
    edit.steps.push_back(read_step(steps[i], "steps[" + std::to_string(i) + "]", lists));
  }
  return edit;
}

Edit load_edit(const QString& text_or_path) {
  const QString text = text_or_path.trimmed();
  if (text.startsWith(QLatin1Char('{')) || text.startsWith(QChar(QChar::ByteOrderMark))) {
    return read_edit(text.toUtf8());
  }
  if (text.isEmpty()) {
    refuse_json("No edit is given; give JSON text that begins with {, or the path of a .json file.");
  }
  const QFileInfo info(text);
  if (!info.isFile()) {
    refuse_json(quoted(text) + " is neither JSON text, which begins with {, nor the path of a file.");
  }
  if (info.size() > kLargestJson) {
    refuse_json(quoted(text) + " is a file of " + std::to_string(info.size()) + " bytes; the limit for an edit is " +
                std::to_string(kLargestJson) + ".");
  }
  QFile file(text);
  if (!file.open(QIODevice::ReadOnly)) {
    refuse_json(quoted(text) + " cannot be read: " + file.errorString().toStdString() + ".");
  }
  const QByteArray json = file.read(kLargestJson + 1);
  if (file.error() != QFileDevice::NoError) {
    refuse_json(quoted(text) + " cannot be read: " + file.errorString().toStdString() + ".");
  }
  try {
    return read_edit(json);
  } catch (const EditError& error) {
    throw EditError(error.cause(), quoted(text) + ": " + error.what());
  }
}

QByteArray write_edit(const Edit& edit) {
  QByteArray mesh;
  const auto add = [&mesh](const char* key, const QByteArray& value) {
    mesh += (mesh.isEmpty() ? "\"" : ", \"") + QByteArray(key) + "\": " + value;
  };
  if (edit.mesh_vertices) {
    add("vertices", QByteArray::number(*edit.mesh_vertices));
  }
  if (edit.mesh_faces) {
    add("faces", QByteArray::number(*edit.mesh_faces));
  }
  if (!edit.connectivity.empty()) {
    add("connectivity", to_json(QJsonValue(QString::fromStdString(edit.connectivity))));
  }
  QByteArray steps;
  for (const EditStep& step : edit.steps) {
    steps += (steps.isEmpty() ? "" : ", ") + written(step);
  }
  QByteArray json = "{\"laplacian_edit\": " + QByteArray::number(kVersion) + ",\n" +
                    (mesh.isEmpty() ? QByteArray() : " \"mesh\": {" + mesh + "},\n") + " \"steps\": [" + steps + "]}\n";
  read_edit(json);  // what cannot be read again is refused now, with the same sentence
  return json;
}

}  // namespace lapedit
