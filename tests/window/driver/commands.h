// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QApplication>
#include <QJsonObject>
#include <QPointF>
#include <QString>
#include <QWidget>
#include <functional>
#include <map>
#include <stdexcept>

class GLArea;
class MeshDocument;
class MeshModel;
class QMainWindow;

/// What the driver can be asked to do; the Python client tests/window/gui.py has one method for each command.
namespace gui_driver {

struct Answer {
  QJsonObject reply;
  std::function<void()> then = {};  ///< done after the reply is sent: for what may open a dialog and so not return
};

using Command = std::function<Answer(const QJsonObject&)>;
using Commands = std::map<QString, Command>;

/// @throws std::runtime_error
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error(what);
}

/// The last widget of a type for which a condition holds, null if there is none.
template <class Widget, class Condition>
Widget* find_widget(const Condition& holds) {
  Widget* result = nullptr;
  for (QWidget* candidate : QApplication::allWidgets()) {
    auto* const found = qobject_cast<Widget*>(candidate);
    result = found && holds(*found) ? found : result;
  }
  return result;
}

void add_input_commands(Commands& commands);   ///< mouse, wheel, keys
void add_window_commands(Commands& commands);  ///< menus, widgets, dialogs, pictures, output
void add_scene_commands(Commands& commands);   ///< layers, vertices, camera, history

/// All of these throw std::runtime_error if there is no such thing.
QMainWindow& main_window();
GLArea& gl_area();  ///< the current view of the current project
MeshDocument& document();
MeshModel& layer(const QJsonObject& arguments);  ///< the one of "layer", the current one if that is absent
QPointF vertex_pixel(int vertex);                ///< where a vertex of the current layer is on the view

/// A mouse event is being sent: idle can wait for the next frame of the drag.
void expect_frame();

}  // namespace gui_driver
