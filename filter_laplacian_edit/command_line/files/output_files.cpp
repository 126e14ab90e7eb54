// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/output_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "failure.h"
#include "files/file_names.h"
#include "files/file_writer.h"
#include "files/real_files.h"
#include "host/batch_host.h"

using lapedit::host::quotedPath;

namespace {

/// Waits until a file or folder is on the disk. Some write errors show only here.
bool synchronised(const QString& path) {
  const int file = ::open(QFile::encodeName(path).constData(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return false;
  }
  // Some file systems do not support this for folders.
  const bool done = ::fsync(file) == 0 || errno == EINVAL;
  ::close(file);
  return done;
}

/// Copies owner, group and permissions.
void handDown(const struct stat& from, const char* to) {
  mode_t mode = from.st_mode & 0777;
  if (::chown(to, from.st_uid, from.st_gid) != 0 && ::chown(to, -1, from.st_gid) != 0) {
    // Permissions of one group are not given to another group; it gets those of all users.
    mode &= ~070 | ((mode & 07) << 3);
  }
  ::chmod(to, mode);
}

}  // namespace

OutputFiles::OutputFiles(const std::string& what, const QStringList& places) : what_(what) {
  for (const QString& place : places) {
    QString real = place;
    try {
      real = QFile::decodeName(RealFile(QFile::encodeName(place).toStdString()).path().c_str());
    } catch (const std::system_error& error) {
      refuse(place, error.code().message());
    }
    const QFileInfo file(real);
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
      refuse(place, "its folder is not writable");
    }
    if (!folder_.isEmpty() && folder_ != folder.canonicalFilePath()) {
      refuse(place, "it is a link to another folder than the output before it");
    }
    folder_ = folder.canonicalFilePath();
    names_ << file.fileName();
    staged_ << (isUtf8(file.fileName()) ? file.fileName()
                                        : QString("laplacian-edit-%1.%2").arg(staged_.size()).arg(file.suffix()));
  }
}

void OutputFiles::refuse(const QString& place, const std::string& why) const {
  throw Failure(Unwritable, "The " + what_ + " " + quotedPath(place) + " cannot be written: " + why + ".");
}

void OutputFiles::begin(const std::function<void(const std::string&)>& made) {
  if (!scratch_.path().empty()) {
    return;
  }
  // The process that cleans up after a request to stop must know the folder.
  const NoInterruption uninterrupted;
  try {
    scratch_.make(QFile::encodeName(folder_).toStdString());
  } catch (const std::system_error& error) {
    refuse(folder_ + "/" + names_.first(), whyNotWritten(error.code().value()));
  }
  made(scratch_.path());
}

QString OutputFiles::path(int k) const {
  return beside(staged_.at(k));
}

QString OutputFiles::beside(const QString& name) const {
  return QFile::decodeName(scratch_.path().c_str()) + "/" + name;
}

void OutputFiles::synchronise() {
  others_.clear();
  for (const QString& name : QDir(beside(QString())).entryList(QDir::Files | QDir::Hidden)) {
    if (!synchronised(beside(name))) {
      refuse(folder_ + "/" + name, whyNotWritten(errno));
    }
    if (!staged_.contains(name)) {
      others_ << name;
    }
  }
}

void OutputFiles::place() {
  QList<std::pair<QString, QString>> files;  // from, to
  for (const QString& name : others_) {
    files << std::make_pair(beside(name), folder_ + "/" + name);
  }
  for (int k = 0; k < names_.size(); ++k) {
    files << std::make_pair(path(k), folder_ + "/" + names_[k]);
  }
  // The paths may have changed since they were checked.
  for (const auto& [from, to] : files) {
    if (QFileInfo(to).isDir()) {
      refuse(to, "it has become a folder");
    }
  }
  for (int k = 0; k < files.size(); ++k) {
    const QByteArray from = QFile::encodeName(files[k].first), to = QFile::encodeName(files[k].second);
    struct stat before = {};
    if (::stat(to.constData(), &before) == 0) {
      handDown(before, from.constData());
    }
    if (::rename(from.constData(), to.constData()) != 0) {
      const std::string why = whyNotWritten(errno);
      refuse(files[k].second, k == 0 ? why : why + "; the files before it, " + std::to_string(k) + ", are complete");
    }
  }
  synchronised(folder_);
}

NoInterruption::NoInterruption() {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, &before_);
}

NoInterruption::~NoInterruption() {
  if (!for_good_) {
    sigprocmask(SIG_SETMASK, &before_, nullptr);
  }
}
