// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <QKeyEvent>
#include <QKeySequence>
#include <QMouseEvent>
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

/// What an interactive tool is, in the terms of no particular MeshLab version; the adapter of the host at hand
/// (api_<generation>/edit_tool_plugin.h) presents it to MeshLab.
namespace lapedit::host {

/// A layer as a tool sees it. Valid until the next event.
struct Layer {
  int id = -1;
  QString name;
  QString file;  ///< where it was opened from or saved to last, absolute; empty if nowhere
  CMeshO* mesh = nullptr;
  bool visible = true;
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();  ///< layer to world coordinates
};

/// What a tool may ask of the view that it works in. One per view.
class HostWindow {
 public:
  virtual ~HostWindow() = default;

  virtual QWidget& canvas() = 0;  ///< the OpenGL widget
  virtual QMainWindow* mainWindow() = 0;
  /// What the layers belong to: ids are unique in it, it tells when it is destroyed. Null while there is none.
  virtual QObject* document() = 0;
  virtual std::optional<Layer> currentLayer() = 0;
  virtual std::optional<Layer> layer(int id) = 0;
  virtual std::vector<Layer> layers() = 0;
  virtual void setCurrentLayer(int id) = 0;  ///< once the present event is over
  virtual bool suspended() = 0;              ///< the tool is shown, but mouse and keys are the host's

  /// The layer's positions and normals have changed: brings them to the graphics card. Not while drawing.
  virtual void uploadGeometry(int layer) = 0;
  virtual void markModified(int layer) = 0;
  virtual void repaint() = 0;

  virtual void log(const std::string& line) = 0;

  /// Lets the host's own navigation have an event, as if this button had been used.
  virtual void navigate(const QMouseEvent& event, Qt::MouseButton as) = 0;
  virtual void navigate(const QWheelEvent& event) = 0;

  /// Ends the tool, once the present event is over.
  virtual void endTool() = 0;

  /// Appends a filter to the document's history, if the host keeps one. @param edit  its parameter of that name
  virtual void appendToHistory(const QString& filter, const QString& edit, double fraction) = 0;
  /// Takes the last entry of the history away if it is this one. @return whether it was
  virtual bool removeFromHistory(const QString& filter, const QString& edit) = 0;
};

/// A tool in one view. Functions may throw std::exception: the adapter logs it.
class InteractiveTool {
 public:
  virtual ~InteractiveTool() = default;

  /// The tool is switched on, or the current layer has changed while it is on. @return false: not on this layer
  virtual bool start() = 0;
  /// The tool is switched off, or the current layer changes. The layer of before may be gone.
  virtual void end() = 0;

  /// Over the drawn scene. The modelview matrix is that of the world.
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
