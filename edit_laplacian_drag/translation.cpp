// SPDX-License-Identifier: GPL-3.0-or-later
#include "translation.h"

#include <dlfcn.h>

#include <QCoreApplication>
#include <QFileInfo>
#include <QLocale>
#include <QStandardPaths>
#include <QTranslator>

#include "lapedit/base/translate.h"

namespace {

/// Where this plugin was loaded from.
QString ownFolder() {
  Dl_info info;
  return dladdr(reinterpret_cast<void*>(&loadTranslation), &info) != 0
             ? QFileInfo(QString::fromLocal8Bit(info.dli_fname)).canonicalPath()
             : QString();
}

}  // namespace

void loadTranslation() {
  static bool looked = false;
  if (looked) {
    return;
  }
  looked = true;
  auto* const translator = new QTranslator(qApp);
  QStringList folders = QStandardPaths::locateAll(QStandardPaths::GenericDataLocation, "laplacian-edit/translations",
                                                  QStandardPaths::LocateDirectory);
  folders.prepend(ownFolder());
  for (const QString& folder : folders) {
    if (translator->load(QLocale::system(), "laplacian_edit", "_", folder)) {
      QCoreApplication::installTranslator(translator);
      lapedit::set_translator([](const char* sentence) { return core(sentence).toStdString(); });
      return;
    }
  }
  delete translator;
}

QString core(const char* sentence) {
  return QCoreApplication::translate("lapedit", sentence);
}
