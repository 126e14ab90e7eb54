// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/file_writer.h"

#include <QFile>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace {

void require(bool done) {
  if (!done) {
    throw std::system_error(errno, std::generic_category());
  }
}

}  // namespace

std::string whyNotWritten(int error) {
  switch (error) {
    case ENOSPC:
      return "the disk is full: free some space, or write to another disk";
    case EDQUOT:
      return "your share of the disk (quota) is used up: free some space, or write to another disk";
    case EFBIG:
      return "it is larger than a file may be here: raise the limit (ulimit -f), or write to another disk";
    case EROFS:
      return "the disk is read-only: write to another one";
    case ENOENT:
      return "its folder was moved or removed: run it again";
    default:
      return std::strerror(error);
  }
}

FileWriter::FileWriter(const QString& path)
    : file_(std::fopen(QFile::encodeName(path).constData(), "wbe"), std::fclose) {
  require(file_ != nullptr);
}

void FileWriter::write(const QByteArray& bytes) {
  const auto size = static_cast<std::size_t>(bytes.size());
  require(std::fwrite(bytes.constData(), 1, size, file_.get()) == size);
}

void FileWriter::close() {
  require(std::fclose(file_.release()) == 0);
}
