// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>

/// Declines dialogs: some of MeshLab's plugins open one and wait for an answer, which is impossible here. During the
/// lifetime of this object each is declined at once, and its text is kept.
class DialogWatch : public QObject {
 public:
  DialogWatch();

  /// Returns the text of the first dialog since the last call; null if there was none.
  QString take();

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  QString said_;
};
