// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <QMouseEvent>
#include <QString>
#include <QWheelEvent>
#include <optional>
#include <string>
#include <vector>

class CMeshO;
class GLArea;
class MeshModel;
class MLSceneGLSharedDataContext;

namespace lapedit::host {

/// The layer of a tool. Valid until the next event.
struct Layer {
  int id = -1;
  QString name;
  QString file;  ///< where it was opened from or saved to last, absolute; empty if nowhere
  CMeshO* mesh = nullptr;
  bool visible = true;
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();  ///< layer to world coordinates
};

/// The services of MeshLab's view for its tool, for all versions of MeshLab.
class HostView {
 public:
  /// @param title  of the tool, begins the lines of the log
  explicit HostView(QString title) : title_(std::move(title)) {}
  void attach(GLArea* area, MLSceneGLSharedDataContext* shared) {
    area_ = area;
    shared_ = shared;
  }

  QWidget& viewport();  ///< the OpenGL widget
  /// Returns the owner of the layers: ids are unique in it, and it signals its destruction. Null while there is none.
  QObject* document();
  std::optional<Layer> currentLayer();
  std::optional<Layer> layer(int id);
  std::vector<Layer> layers();
  bool suspended();  ///< the tool is shown, but MeshLab handles mouse and keys
  bool loading();    ///< MeshLab is reading a mesh, so that no layer can be used

  /// Uploads the layer's changed positions and normals to the graphics card. Not while drawing.
  void uploadGeometry(int layer);
  void markModified(int layer);
  void repaint();
  /// Returns the largest depth around a pixel of the viewport in the picture that is or was drawn last: 0 to 1, 1 for
  /// the background.
  double depthAt(const QPointF& pixel, int around);

  void log(const std::string& line);

  /// Passes an event to MeshLab's navigation, as if this button had been used.
  void navigate(const QMouseEvent& event, Qt::MouseButton as);
  void navigate(const QWheelEvent& event);

  /// Ends the tool after the current event.
  void endTool();

 private:
  MeshModel* find(int id);
  std::optional<Layer> seen(MeshModel& model);
  void pass(QEvent& event);

  QString title_;
  GLArea* area_ = nullptr;
  MLSceneGLSharedDataContext* shared_ = nullptr;
};

}  // namespace lapedit::host
