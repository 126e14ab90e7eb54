// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>

/// Some of the host's plugins open a dialog and wait for an answer, which nobody can give here. While this lives, each
/// is turned down at once, and what it said is kept.
class DialogWatch : public QObject {
 public:
  DialogWatch();

  /// What the first dialog since the last call said; null if there was none.
  QString take();

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  QString said_;
};
