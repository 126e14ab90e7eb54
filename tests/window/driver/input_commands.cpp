// SPDX-License-Identifier: GPL-3.0-or-later
#include <QApplication>
#include <QElapsedTimer>
#include <QEnterEvent>
#include <QJsonArray>
#include <QKeyEvent>
#include <QKeySequence>
#include <QMouseEvent>
#include <QPointer>
#include <QWheelEvent>
#include <initializer_list>
#include <stdexcept>

#include "commands.h"
#include "driver_host.h"

namespace gui_driver {
namespace {

Qt::MouseButtons held_buttons;  // by the mouse commands so far

Qt::KeyboardModifiers modifiers(const QJsonObject& arguments) {
  Qt::KeyboardModifiers result;
  for (const QJsonValue name : arguments["modifiers"].toArray()) {
    if (name == "ctrl") {
      result |= Qt::ControlModifier;
    } else if (name == "shift") {
      result |= Qt::ShiftModifier;
    } else if (name == "alt") {
      result |= Qt::AltModifier;
    } else {
      throw std::runtime_error("no such modifier");
    }
  }
  return result;
}

Qt::MouseButton button(const QString& name) {
  if (name == "left") {
    return Qt::LeftButton;
  }
  if (name == "middle") {
    return Qt::MiddleButton;
  }
  if (name == "right") {
    return Qt::RightButton;
  }
  throw std::runtime_error("no such button");
}

/// "x" and "y", pixels of the view; from the vertex of the current layer if there is a "vertex".
QPointF position_of(const QJsonObject& arguments) {
  const QPointF by(arguments["x"].toDouble(), arguments["y"].toDouble());
  return arguments.contains("vertex") ? by + vertex_pixel(arguments["vertex"].toInt()) : by;
}

/// Sends an event and tells how long the window handled it.
Answer timed(QWidget& area, QEvent& event) {
  QElapsedTimer timer;
  timer.start();
  QCoreApplication::sendEvent(&area, &event);
  return {{{"milliseconds", static_cast<double>(timer.nsecsElapsed()) * 1e-6}}};
}

Answer mouse(const QJsonObject& arguments) {
  const QString type = arguments["type"].toString();
  QEvent::Type event_type = QEvent::MouseMove;
  Qt::MouseButton changed = Qt::NoButton;
  if (type != "move") {
    changed = button(arguments["button"].toString());
    event_type = type == "press"     ? QEvent::MouseButtonPress
                 : type == "release" ? QEvent::MouseButtonRelease
                                     : QEvent::MouseButtonDblClick;
    held_buttons.setFlag(changed, type != "release");
  }
  GLArea& area = gl_area();
  const QPointF position = position_of(arguments);
  const QPointF global = position + area.mapToGlobal(QPoint(0, 0));
  QMouseEvent event(event_type, position, position, global, changed, held_buttons, modifiers(arguments));
  expect_frame();
  return timed(area, event);
}

Answer wheel(const QJsonObject& arguments) {
  GLArea& area = gl_area();
  const QPointF position = position_of(arguments);
  const QPoint angle(0, arguments["delta"].toInt());
  QWheelEvent event(position, position + area.mapToGlobal(QPoint(0, 0)), QPoint(), angle, held_buttons,
                    modifiers(arguments), Qt::NoScrollPhase, false);
  return timed(area, event);
}

void send_key(QWidget& target, const QJsonObject& arguments, std::initializer_list<QEvent::Type> types) {
  const QString name = arguments["key"].toString();
  const int code = QKeySequence(name)[0] & ~static_cast<int>(Qt::KeyboardModifierMask);
  const QString text = name.size() == 1 ? name : name == "Return" ? "\r" : name == "Backspace" ? "\b" : "";
  for (const auto type : types) {
    QKeyEvent event(type, code, modifiers(arguments), text);
    QCoreApplication::sendEvent(&target, &event);
  }
}

Answer key(const QJsonObject& arguments) {
  send_key(gl_area(), arguments, {QEvent::KeyPress, QEvent::KeyRelease});
  return {};
}

/// To the list that is open, or else to the widget that has the keyboard; without both to none. list: only to a list.
Answer key_anywhere(const QJsonObject& arguments) {
  const QPointer<QWidget> list = QApplication::activePopupWidget();
  if (!list && arguments["list"].toBool()) {
    return {};
  }
  const QPointer<QWidget> target = list && list->focusWidget() ? list->focusWidget()
                                   : list                      ? list.data()
                                                               : QApplication::focusWidget();
  for (const auto type : {QEvent::ShortcutOverride, QEvent::KeyPress, QEvent::KeyRelease}) {
    if (target) {  // a key may close the list
      send_key(*target, arguments, {type});
    }
  }
  return {};
}

/// The mouse enters the view or leaves it.
Answer cross(const QJsonObject& arguments) {
  const QPointF position = position_of(arguments);
  QEnterEvent enter(position, position, position + gl_area().mapToGlobal(QPoint(0, 0)));
  QEvent leave(QEvent::Leave);
  QCoreApplication::sendEvent(&gl_area(), arguments["enters"].toBool() ? static_cast<QEvent*>(&enter) : &leave);
  return {};
}

}  // namespace

void add_input_commands(Commands& commands) {
  commands["mouse"] = mouse;
  commands["wheel"] = wheel;
  commands["key"] = key;
  commands["key_anywhere"] = key_anywhere;
  commands["cross"] = cross;
}

}  // namespace gui_driver
