// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QApplication>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QTemporaryDir>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fuzz.h"
#include "host/batch_host.h"

/// Leaks that are not ours.
extern "C" inline __attribute__((used, visibility("default"))) const char* __lsan_default_suppressions() {
  return "leak:libfontconfig\nleak:libmeshlab-common\nleak:libio_base\nleak:ImporterOBJ\nleak:libQt5\n";
}

/// What the targets on MeshLab's library share: the program's own host, with MeshLab's common formats and none of its
/// filters.
namespace lapedit::fuzz {

class Host {
 public:
  static Host& instance() {
    static Host host;
    return host;
  }

  QString plugins() const { return folder_.path() + "/plugins"; }
  QString file(const QString& name) const { return folder_.path() + "/" + name; }

  QString write(const QString& name, const std::string& bytes) const {
    QFile out(file(name));
    require(out.open(QIODevice::WriteOnly) &&
                out.write(bytes.data(), static_cast<qint64>(bytes.size())) == static_cast<qint64>(bytes.size()),
            "the scratch folder takes a file");
    return out.fileName();
  }

 private:
  /// In memory, where there is such a folder: a file is written per input.
  static QString scratch() {
    const QString memory = "/dev/shm";
    return (QFileInfo(memory).isWritable() ? memory : QDir::tempPath()) + "/lapedit_fuzz_XXXXXX";
  }

  Host() {
    qputenv("QT_QPA_PLATFORM", "offscreen");
    qInstallMessageHandler([](QtMsgType, const QMessageLogContext&, const QString&) {});
    static int count = 1;
    static char name[] = "fuzz";
    static char* arguments[] = {name, nullptr};
    application_ = std::make_unique<QApplication>(count, arguments);
    std::setlocale(LC_NUMERIC, "C");
    require(QDir(folder_.path()).mkdir("plugins") &&
                QFile::link(LAPEDIT_MESHLAB_PLUGINS "/libio_base.so", plugins() + "/libio_base.so"),
            "MeshLab's plugin for the common formats is linked");
    // MeshLab's readers print.
    if (std::freopen("/dev/null", "w", stdout) == nullptr) {
      std::abort();
    }
  }

  QTemporaryDir folder_{scratch()};
  std::unique_ptr<QApplication> application_;
};

inline bool is_sentence(const char* text) {
  const std::size_t length = std::strlen(text);
  return length > 10 && length < 20000;
}

}  // namespace lapedit::fuzz
