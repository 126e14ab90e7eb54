// SPDX-License-Identifier: GPL-3.0-or-later
#include "host/dialog_watch.h"

#include <QApplication>
#include <QDialog>
#include <QEvent>
#include <QLabel>
#include <QMessageBox>
#include <QTimer>
#include <utility>

namespace {

QString textOf(const QDialog& dialog) {
  QStringList texts = {dialog.windowTitle()};
  if (const auto* const box = qobject_cast<const QMessageBox*>(&dialog)) {
    texts << box->text() << box->informativeText();
  } else {
    for (const QLabel* label : dialog.findChildren<QLabel*>()) {
      texts << label->text();
    }
  }
  texts.removeAll(QString());
  return texts.isEmpty() ? QString("a dialog without text") : texts.join(": ").simplified();
}

}  // namespace

DialogWatch::DialogWatch() {
  qApp->installEventFilter(this);
}

QString DialogWatch::take() {
  return std::exchange(said_, QString());
}

bool DialogWatch::eventFilter(QObject* object, QEvent* event) {
  auto* const dialog = event->type() == QEvent::Show ? qobject_cast<QDialog*>(object) : nullptr;
  if (dialog != nullptr && dialog->isModal()) {
    if (said_.isEmpty()) {
      said_ = textOf(*dialog);
    }
    // Only after the dialog waits: a dialog that is closed before waits for ever.
    QTimer::singleShot(0, dialog, &QDialog::reject);
  }
  return false;
}
