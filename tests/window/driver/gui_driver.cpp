// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui_driver.h"

#include <QApplication>
#include <QJsonArray>
#include <QJsonDocument>
#include <QTimer>
#include <exception>
#include <utility>

GuiDriver::GuiDriver() {
  const QString path = qEnvironmentVariable("LAPEDIT_GUI_SOCKET");
  if (path.isEmpty()) return;
  // Qt's own dialogs can be answered from inside.
  QCoreApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
  gui_driver::add_input_commands(commands_);
  gui_driver::add_window_commands(commands_);
  gui_driver::add_scene_commands(commands_);
  commands_["batch"] = [this](const QJsonObject& request) { return batch(request); };
  // The main window loads plugins while it is being made: it is there once events are handled.
  QTimer::singleShot(0, this, [this, path] { listen(path); });
}

void GuiDriver::listen(const QString& path) {
  // MeshLab 2022 and later make a second object, after one that they only look at.
  static bool listening = false;
  if (std::exchange(listening, true)) return;
  if (!server_.listen(path)) {
    qCritical("gui_driver: %s: %s", qUtf8Printable(path), qUtf8Printable(server_.errorString()));
    return;
  }
  connect(&server_, &QLocalServer::newConnection, this, [this] {
    client_ = server_.nextPendingConnection();
    connect(client_, &QLocalSocket::readyRead, this, &GuiDriver::receive);
  });
}

void GuiDriver::receive() {
  while (client_ && client_->canReadLine()) {
    lines_ += client_->readLine();
    // Not from here: this signal is not sent again while a command keeps a dialog open, and the next line may be the
    // one that answers it.
    QMetaObject::invokeMethod(this, &GuiDriver::handleNext, Qt::QueuedConnection);
  }
}

/// The "requests" one after the other, without a word between them. None of them may open a dialog.
gui_driver::Answer GuiDriver::batch(const QJsonObject& request) {
  QJsonArray errors;  // of those that could not be done: number, why
  int number = 0;
  for (const QJsonValue one : request["requests"].toArray()) {
    try {
      const gui_driver::Answer answer = commands_.at(one["command"].toString())(one.toObject());
      if (answer.then) answer.then();
    } catch (const std::exception& error) {
      errors += QJsonArray{number, error.what()};
    }
    ++number;
  }
  return {{{"errors", errors}}};
}

void GuiDriver::handleNext() {
  const QJsonObject request = QJsonDocument::fromJson(lines_.takeFirst()).object();
  const QString name = request["command"].toString();
  try {
    gui_driver::require(commands_.count(name) > 0, "no such command");
    const gui_driver::Answer answer = commands_[name](request);
    send(answer.reply);
    if (answer.then) answer.then();
  } catch (const std::exception& error) {
    send({{"error", name + ": " + error.what()}});
  }
}

void GuiDriver::send(const QJsonObject& reply) {
  if (client_) {
    client_->write(QJsonDocument(reply).toJson(QJsonDocument::Compact) + '\n');
    client_->flush();
  }
}
