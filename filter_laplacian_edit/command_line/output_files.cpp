// SPDX-License-Identifier: GPL-3.0-or-later
#include "output_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "batch_host.h"
#include "failure.h"

using lapedit::host::quoted_path;

namespace {

[[noreturn]] void refuse(const QString& path, const std::string& why) {
  throw Failure(Unwritable, "The output " + quoted_path(path) + " cannot be written: " + why + ".");
}

std::string lastError() {
  return std::strerror(errno);
}

/// Waits until a file or folder is on the disk. Some errors of writing show here only.
bool synchronise(const QString& path) {
  const int file = ::open(QFile::encodeName(path).constData(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return false;
  }
  // Some file systems cannot do it for folders.
  const bool done = ::fsync(file) == 0 || errno == EINVAL;
  ::close(file);
  return done;
}

/// While it lives, a request to stop waits: either all files are in their places or none.
class NoInterruption {
 public:
  NoInterruption() {
    sigset_t requests;
    sigemptyset(&requests);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      sigaddset(&requests, signal);
    }
    sigprocmask(SIG_BLOCK, &requests, &before_);
  }
  ~NoInterruption() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  NoInterruption(const NoInterruption&) = delete;
  NoInterruption& operator=(const NoInterruption&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

OutputFiles::OutputFiles(const QStringList& places) {
  for (const QString& place : places) {
    const QFileInfo link(place);
    const QFileInfo file(link.exists() ? link.canonicalFilePath() : place);
    const QFileInfo folder(file.absolutePath());
    if (file.fileName().isEmpty() || file.isDir()) {
      refuse(place, "it is a folder");
    }
    if (file.exists() && !file.isFile()) {
      refuse(place, "it is not an ordinary file");
    }
    if (!folder.isDir()) {
      refuse(place, "its folder does not exist");
    }
    if (!folder.isWritable()) {
      refuse(place, "its folder does not let itself be written to");
    }
    if (!folder_.isEmpty() && folder_ != folder.canonicalFilePath()) {
      refuse(place, "it is a link to another folder than the output before it");
    }
    folder_ = folder.canonicalFilePath();
    names_ << file.fileName();
  }
}

OutputFiles::~OutputFiles() {
  if (!scratch_.isEmpty()) {
    QDir(scratch_).removeRecursively();
  }
}

void OutputFiles::begin(const std::function<void(const QString&)>& made) {
  QByteArray pattern = QFile::encodeName(folder_ + "/.laplacian-edit-XXXXXX");
  if (::mkdtemp(pattern.data()) == nullptr) {
    refuse(folder_ + "/" + names_.first(), lastError());
  }
  scratch_ = QFile::decodeName(pattern);
  made(scratch_);
}

QString OutputFiles::path(int k) const {
  return scratch_ + "/" + names_.at(k);
}

void OutputFiles::place(const QString& name) {
  const QByteArray from = QFile::encodeName(scratch_ + "/" + name), to = QFile::encodeName(folder_ + "/" + name);
  struct stat before = {};
  if (::stat(to.constData(), &before) == 0) {
    ::chmod(from.constData(), before.st_mode & 07777);
  }
  if (::rename(from.constData(), to.constData()) != 0) {
    refuse(folder_ + "/" + name, lastError());
  }
}

void OutputFiles::commit() {
  QStringList others;
  for (const QString& name : QDir(scratch_).entryList(QDir::Files | QDir::Hidden)) {
    if (!synchronise(scratch_ + "/" + name)) {
      refuse(folder_ + "/" + name, lastError());
    }
    if (!names_.contains(name)) {
      others << name;
    }
  }
  const NoInterruption uninterrupted;
  for (const QString& name : others + names_) {
    place(name);
  }
  synchronise(folder_);
}
