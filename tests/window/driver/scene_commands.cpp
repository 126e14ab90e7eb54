// SPDX-License-Identifier: GPL-3.0-or-later
#include <QFile>
#include <QJsonArray>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "commands.h"
#include "driver_host.h"

namespace gui_driver {
namespace {

QMdiArea& projects() {
  auto* const found = find_widget<QMdiArea>([](const QMdiArea&) { return true; });
  require(found, "there is no window of projects");
  return *found;
}

/// Views of the current project, the oldest first.
std::vector<GLArea*> views() {
  const QWidget* const project = projects().currentSubWindow();  // a second project has views of its own
  std::vector<GLArea*> found;
  for (QWidget* candidate : QApplication::allWidgets()) {
    // MeshLab exports no GLArea for qobject_cast to compare with.
    const bool is_view = candidate->inherits("GLArea") && project && project->isAncestorOf(candidate);
    if (is_view) found.push_back(static_cast<GLArea*>(candidate));
  }
  std::sort(found.begin(), found.end(), [](GLArea* a, GLArea* b) { return a->getId() < b->getId(); });
  return found;
}

GLArea* find_gl_area() {
  const std::vector<GLArea*> all = views();
  const auto current = std::find_if(all.begin(), all.end(), [](GLArea* area) { return area->isCurrent(); });
  return current != all.end() ? *current : all.empty() ? nullptr : all.front();
}

/// Makes a project, then one of its views the current one, as a click on them does.
Answer view(const QJsonObject& arguments) {
  if (arguments.contains("project")) {
    projects().setActiveSubWindow(projects().subWindowList().at(arguments["project"].toInt()));
  }
  const std::vector<GLArea*> all = views();
  if (arguments.contains("index")) {
    GLArea* const area = all.at(static_cast<std::size_t>(arguments["index"].toInt()));
    QMetaObject::invokeMethod(area, "currentViewerChanged", Q_ARG(int, area->getId()));
  }
  const auto current = std::find(all.begin(), all.end(), find_gl_area());
  return {{{"views", static_cast<int>(all.size())}, {"current", static_cast<int>(current - all.begin())}}};
}

template <class Matrix>
QJsonArray numbers(const Matrix& matrix) {
  QJsonArray result;
  for (int i = 0; i < 16; ++i) result += static_cast<double>(matrix.V()[i]);
  return result;
}

Answer layers(const QJsonObject&) {
  MeshDocument& md = document();
  GLArea& area = gl_area();
  QJsonArray result;
  for (const MeshModel* mesh : all_layers(md)) {
    result += QJsonObject{{"id", mesh->id()},
                          {"visible", area.meshVisibilityMap.value(mesh->id())},
                          {"current", mesh == md.mm()},
                          {"vertices", mesh->cm.vn},
                          {"faces", mesh->cm.fn},
                          {"matrix", numbers(mesh->cm.Tr)},
                          {"modified", mesh->meshModified()}};
  }
  return {{{"layers", result}}};
}

/// As the button Shading: Vert of the layer's panel.
void shade_smoothly(GLArea& area, int id) {
  MLSceneGLSharedDataContext* shared = area.getSceneGLSharedContext();
  MLRenderingData data;
  shared->getRenderInfoPerMeshView(id, area.context(), data);
  MLRenderingData::RendAtts attributes;
  data.get(MLRenderingData::PR_SOLID, attributes);
  attributes[MLRenderingData::ATT_NAMES::ATT_VERTNORMAL] = true;
  attributes[MLRenderingData::ATT_NAMES::ATT_FACENORMAL] = false;
  data.set(MLRenderingData::PR_SOLID, attributes);
  shared->setRenderingDataPerMeshView(id, area.context(), data);
  shared->manageBuffers(id);
}

/// Selects those of a list. @return whether there is a list
template <class Elements>
bool select(Elements& elements, const QJsonValue& list) {
  if (!list.isArray()) return false;
  for (auto& element : elements) element.ClearS();
  for (const QJsonValue number : list.toArray()) elements.at(number.toInt()).SetS();
  return true;
}

/// Any of: current, visible, smooth, matrix (16 numbers by rows), selected_faces, selected_vertices (lists), remove.
Answer change_layer(const QJsonObject& arguments) {
  MeshDocument& md = document();
  GLArea& area = gl_area();
  MeshModel& mesh = layer(arguments);
  const int id = mesh.id();
  if (arguments["current"].toBool()) md.setCurrentMesh(id);
  if (arguments.contains("visible")) {
    // GLArea::meshSetVisibility() is not exported.
    const bool visible = arguments["visible"].toBool();
    show_layer(mesh, visible);
    area.meshVisibilityMap[id] = visible;
  }
  if (arguments["smooth"].toBool()) shade_smoothly(area, id);
  const QJsonArray matrix = arguments["matrix"].toArray();
  for (int i = 0; i < matrix.size(); ++i) mesh.cm.Tr.V()[i] = static_cast<Scalarm>(matrix[i].toDouble());
  if (select(mesh.cm.face, arguments["selected_faces"])) area.updateSelection(id, false, true);
  if (select(mesh.cm.vert, arguments["selected_vertices"])) area.updateSelection(id, true, false);
  if (arguments["remove"].toBool()) remove_layer(md, mesh);
  area.update();
  return {};
}

/// Collects raw memory of the mesh, so that all bits can be compared.
class Dump {
 public:
  template <class Elements, class Get>
  void add(const char* name, const Elements& elements, Get get) {
    const int begin = data_.size();
    for (const auto& element : elements) {
      if (element.IsD()) continue;
      const auto value = get(element);
      data_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
    index_[name] = QJsonArray{begin, data_.size() - begin};
  }

  QJsonObject write(const QString& path) const {
    QFile file(path);
    require(file.open(QFile::WriteOnly) && file.write(data_) == data_.size(), "the file cannot be written");
    return index_;
  }

 private:
  QByteArray data_;
  QJsonObject index_;  // name -> begin, length
};

/// Writes all that can be told of a layer's vertices and faces to the file "path".
Answer dump(const QJsonObject& arguments) {
  const CMeshO& mesh = layer(arguments).cm;
  Dump result;
  result.add("positions", mesh.vert, [](const auto& v) { return v.cP(); });
  result.add("normals", mesh.vert, [](const auto& v) { return v.cN(); });
  result.add("vertex_flags", mesh.vert, [](const auto& v) { return v.cFlags(); });
  result.add("vertex_colors", mesh.vert, [](const auto& v) { return v.cC(); });
  result.add("vertex_quality", mesh.vert, [](const auto& v) { return v.cQ(); });
  result.add("face_normals", mesh.face, [](const auto& f) { return f.cN(); });
  result.add("face_flags", mesh.face, [](const auto& f) { return f.cFlags(); });
  result.add("faces", mesh.face, [&](const auto& f) {
    std::array<int, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = static_cast<int>(vcg::tri::Index(mesh, f.cV(k)));
    return corners;
  });
  QJsonArray box;
  for (const Point3m& corner : {mesh.bbox.min, mesh.bbox.max}) {
    for (int k = 0; k < 3; ++k) box += static_cast<double>(corner[k]);
  }
  return {{{"arrays", result.write(arguments["path"].toString())}, {"box", box}}};
}

/// From the scene to eye coordinates, as GLArea::setView() and the trackball have it, without asking OpenGL.
vcg::Matrix44d eye_matrix(const GLArea& area) {
  vcg::Matrix44d away, to_center, from_center;
  const double distance = area.fov <= 5 ? 8 : 1.75 / std::tan(vcg::math::ToRad(area.fov * 0.5));
  const auto center = vcg::Point3d::Construct(area.trackball.center);
  away.SetTranslate(0, 0, -distance);
  from_center.SetTranslate(center);
  to_center.SetTranslate(-center);
  return away * from_center * vcg::Matrix44d::Construct(area.trackball.track.Matrix()) * to_center;
}

vcg::Point2d pixel(const GLArea& area, const vcg::Point3d& eye) {
  const double aspect = static_cast<double>(area.width()) / area.height();
  const double half_height =
      area.fov <= 5 ? 1.75 : -eye[2] * std::tan(vcg::math::ToRad(static_cast<double>(area.fov)) / 2);
  return {(eye[0] / (half_height * aspect) + 1) * area.width() / 2, (1 - eye[1] / half_height) * area.height() / 2};
}

/// Where vertices (list) of a layer, or points (flat list, layer coordinates), are on the view, in pixels; and the
/// view.
Answer project(const QJsonObject& arguments) {
  const GLArea& area = gl_area();
  const CMeshO& mesh = layer(arguments).cm;
  std::vector<vcg::Point3d> points;
  for (const QJsonValue vertex : arguments["vertices"].toArray()) {
    points.push_back(vcg::Point3d::Construct(mesh.vert.at(vertex.toInt()).cP()));
  }
  const QJsonArray list = arguments["points"].toArray();
  for (int i = 0; i + 2 < list.size(); i += 3) {
    points.emplace_back(list[i].toDouble(), list[i + 1].toDouble(), list[i + 2].toDouble());
  }
  QJsonArray pixels;
  for (const vcg::Point3d& point : points) {
    const vcg::Point2d position = pixel(area, eye_matrix(area) * vcg::Matrix44d::Construct(mesh.Tr) * point);
    pixels += QJsonArray{position[0], position[1]};
  }
  const QPoint corner = area.mapToGlobal(QPoint(0, 0));
  return {{{"pixels", pixels},
           {"corner", QJsonArray{corner.x(), corner.y()}},
           {"width", area.width()},
           {"height", area.height()}}};
}

Answer camera(const QJsonObject&) {
  return {{{"matrix", numbers(eye_matrix(gl_area()))}, {"fov", static_cast<double>(gl_area().fov)}}};
}

/// What the line over the picture says, which the tool leaves with its view when it draws.
Answer on_screen(const QJsonObject&) {
  constexpr int kAttempts = 20;  // the tool skips pictures while a pose is coming
  GLArea& area = gl_area();
  QString text;
  area.setProperty("laplacian_drag_line", QString());
  for (int k = 0; k < kAttempts && text.isEmpty() && area.getCurrentMeshEditor() && document().mm(); ++k) {
    if (k > 0) QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
    area.repaint();
    text = area.property("laplacian_drag_line").toString();
  }
  return {{{"texts", text.isEmpty() ? QJsonArray() : QJsonArray{text}}}};
}

Answer history(const QJsonObject&) {
  QJsonArray filters;
  for (const FilterNameParameterValuesPair& filter : filter_history(document())) {
    QJsonObject parameters;
    for (const RichParameter& parameter : filter.second) {
      if (parameter.value().isString()) parameters[parameter.name()] = parameter.value().getString();
    }
    filters += QJsonObject{{"name", filter.first}, {"texts", parameters}};
  }
  return {{{"filters", filters}}};
}

Answer tool(const QJsonObject&) {
  GLArea& area = gl_area();
  const QAction* active = area.getCurrentEditAction();
  return {{{"tool", active ? active->text() : QString()},
           {"suspended", area.suspendedEditor},
           {"focus", area.window()->focusWidget() == &area},
           {"cursor", static_cast<int>(area.cursor().shape())}}};
}

}  // namespace

GLArea& gl_area() {
  GLArea* const found = find_gl_area();
  require(found, "there is no view");
  return *found;
}

MeshDocument& document() {
  MeshDocument* const found = gl_area().md();
  require(found, "there is no document");
  return *found;
}

MeshModel& layer(const QJsonObject& arguments) {
  MeshDocument& md = document();
  MeshModel* const found = arguments.contains("layer") ? md.getMesh(arguments["layer"].toInt()) : md.mm();
  require(found, "there is no such layer");
  return *found;
}

QPointF vertex_pixel(int vertex) {
  const QJsonArray found = project({{"vertices", QJsonArray{vertex}}}).reply["pixels"].toArray()[0].toArray();
  return {found[0].toDouble(), found[1].toDouble()};
}

void add_scene_commands(Commands& commands) {
  commands["layers"] = layers;
  commands["layer"] = change_layer;
  commands["dump"] = dump;
  commands["project"] = project;
  commands["camera"] = camera;
  commands["on_screen"] = on_screen;
  commands["history"] = history;
  commands["tool"] = tool;
  commands["view"] = view;
}

}  // namespace gui_driver
