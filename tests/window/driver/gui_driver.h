// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QList>
#include <QLocalServer>
#include <QLocalSocket>
#include <QPointer>

#include "commands.h"
#include "driver_host.h"

/// Lets a test drive MeshLab's window from inside: one JSON object per line comes in through a local socket, one goes
/// out. It offers MeshLab nothing, and does nothing unless the environment variable LAPEDIT_GUI_SOCKET names the
/// socket.
class GuiDriver : public gui_driver::DriverPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID "laplacian_edit.test.GuiDriver")

 public:
  GuiDriver();

 private:
  void listen(const QString& path);
  void receive();
  void handleNext();
  gui_driver::Answer batch(const QJsonObject& request);
  void send(const QJsonObject& reply);

  gui_driver::Commands commands_;
  QLocalServer server_;
  QPointer<QLocalSocket> client_;
  QList<QByteArray> lines_;
};
