// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <QKeyEvent>
#include <QKeySequence>
#include <QMouseEvent>
#include <QPointF>
#include <QString>
#include <QWheelEvent>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class CMeshO;
class QMainWindow;
class QWidget;

/// Describes an interactive tool independently of MeshLab's version. The adapter of the version
/// (api_<generation>/edit_tool_plugin.h) presents it to MeshLab.
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

/// The services of a view for its tool. One per view.
class HostWindow {
 public:
  virtual ~HostWindow() = default;

  virtual QWidget& viewport() = 0;  ///< the OpenGL widget
  virtual QMainWindow* mainWindow() = 0;
  /// The owner of the layers: ids are unique in it, and it signals its destruction. Null while there is none.
  virtual QObject* document() = 0;
  virtual std::optional<Layer> currentLayer() = 0;
  virtual std::optional<Layer> layer(int id) = 0;
  virtual std::vector<Layer> layers() = 0;
  virtual void setCurrentLayer(int id) = 0;  ///< after the current event
  virtual bool suspended() = 0;              ///< the tool is shown, but MeshLab handles mouse and keys
  virtual bool loading() = 0;                ///< MeshLab is reading a mesh, so that no layer can be used

  /// Uploads the layer's changed positions and normals to the graphics card. Not while drawing.
  virtual void uploadGeometry(int layer) = 0;
  virtual void markModified(int layer) = 0;
  virtual void repaint() = 0;
  /// Returns the largest depth around a pixel of the viewport in the picture that is or was drawn last: 0 to 1, 1 for
  /// the background.
  virtual double depthAt(const QPointF& pixel, int around) = 0;

  virtual void log(const std::string& line) = 0;

  /// Passes an event to MeshLab's navigation, as if this button had been used.
  virtual void navigate(const QMouseEvent& event, Qt::MouseButton as) = 0;
  virtual void navigate(const QWheelEvent& event) = 0;

  /// Rotates the view so that a direction of the world points at the viewer.
  virtual void turnTo(const Eigen::Vector3d& direction) = 0;

  /// Ends the tool after the current event.
  virtual void endTool() = 0;

  /// Adds a filter to the document's history, if MeshLab keeps one. @param edit  its parameter of that name
  /// @param position  in the history; -1: at its end
  virtual void addToHistory(const QString& filter, const QString& edit, double fraction, int position) = 0;
  /// Removes the last such entry of the history. @return its position; -1: it was not there
  virtual int removeFromHistory(const QString& filter, const QString& edit) = 0;
};

/// A tool in one view. Functions may throw std::exception: the adapter logs it.
class InteractiveTool {
 public:
  virtual ~InteractiveTool() = default;

  /// Called when the tool is switched on, or the current layer changes while it is on. @return false if it cannot
  /// edit this layer
  virtual bool start() = 0;
  /// Called when the tool is switched off, or the current layer changes. The previous layer may be deleted.
  virtual void end() = 0;

  /// Draws over the scene. The modelview matrix is that of the world.
  virtual void draw() = 0;
  virtual void mousePress(QMouseEvent& event) = 0;  ///< also the second press of a double click
  virtual void mouseMove(QMouseEvent& event) = 0;
  virtual void mouseRelease(QMouseEvent& event) = 0;
  virtual void wheel(QWheelEvent& event) = 0;
  virtual void keyPress(QKeyEvent& event) = 0;
  virtual void keyRelease(QKeyEvent& event) = 0;
};

struct EditToolAction {
  QString title;  ///< in menus and over the picture
  QString description;
  QString icon;  ///< resource path
  QKeySequence shortcut;
  std::function<std::unique_ptr<InteractiveTool>(HostWindow&)> make;  ///< the window outlives the tool
};

}  // namespace lapedit::host
