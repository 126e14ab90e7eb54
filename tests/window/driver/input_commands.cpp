// SPDX-License-Identifier: GPL-3.0-or-later
#include <QEnterEvent>
#include <QJsonArray>
#include <QKeyEvent>
#include <QKeySequence>
#include <QMouseEvent>
#include <QPointer>
#include <QWheelEvent>
#include <initializer_list>

#include "commands.h"
#include "driver_host.h"

namespace gui_driver {
namespace {

Qt::MouseButtons held_buttons;  // by the mouse commands so far

Qt::KeyboardModifiers modifiers(const QJsonObject& arguments) {
  static const std::map<QString, Qt::KeyboardModifier> modifiers = {
      {"ctrl", Qt::ControlModifier}, {"shift", Qt::ShiftModifier}, {"alt", Qt::AltModifier}};
  Qt::KeyboardModifiers result;
  for (const QJsonValue name : arguments["modifiers"].toArray()) result |= modifiers.at(name.toString());
  return result;
}

/// "x" and "y", pixels of the view; from the vertex of the current layer if there is a "vertex".
QPointF position_of(const QJsonObject& arguments) {
  const QPointF by(arguments["x"].toDouble(), arguments["y"].toDouble());
  return arguments.contains("vertex") ? by + vertex_pixel(arguments["vertex"].toInt()) : by;
}

Answer mouse(const QJsonObject& arguments) {
  static const std::map<QString, QEvent::Type> types = {{"move", QEvent::MouseMove},
                                                        {"press", QEvent::MouseButtonPress},
                                                        {"release", QEvent::MouseButtonRelease},
                                                        {"double", QEvent::MouseButtonDblClick}};
  static const std::map<QString, Qt::MouseButton> buttons = {
      {"left", Qt::LeftButton}, {"middle", Qt::MiddleButton}, {"right", Qt::RightButton}};
  const QEvent::Type type = types.at(arguments["type"].toString());
  const bool moves = type == QEvent::MouseMove;
  const Qt::MouseButton changed = moves ? Qt::NoButton : buttons.at(arguments["button"].toString());
  if (!moves) held_buttons.setFlag(changed, type != QEvent::MouseButtonRelease);
  const QPointF position = position_of(arguments);
  QMouseEvent event(type, position, position, position + gl_area().mapToGlobal(QPoint(0, 0)), changed, held_buttons,
                    modifiers(arguments));
  expect_frame();
  QCoreApplication::sendEvent(&gl_area(), &event);
  return {};
}

Answer wheel(const QJsonObject& arguments) {
  const QPointF position = position_of(arguments);
  const QPoint angle(0, arguments["delta"].toInt());
  QWheelEvent event(position, position + gl_area().mapToGlobal(QPoint(0, 0)), QPoint(), angle, held_buttons,
                    modifiers(arguments), Qt::NoScrollPhase, false);
  QCoreApplication::sendEvent(&gl_area(), &event);
  return {};
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
  if (!list && arguments["list"].toBool()) return {};
  const QPointer<QWidget> target = list && list->focusWidget() ? list->focusWidget()
                                   : list                      ? list.data()
                                                               : QApplication::focusWidget();
  for (const auto type : {QEvent::ShortcutOverride, QEvent::KeyPress, QEvent::KeyRelease}) {
    if (target) send_key(*target, arguments, {type});  // a key may close the list
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
