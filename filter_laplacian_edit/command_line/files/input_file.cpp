// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <QFile>
#include <cerrno>
#include <system_error>
#include <utility>

InputFile::InputFile(const QString& path) : file_(::open(QFile::encodeName(path).constData(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0) {
    throw std::system_error(errno, std::generic_category());
  }
}

InputFile::~InputFile() {
  ::close(file_);
}

QByteArray InputFile::read(int most) {
  QByteArray bytes(most, Qt::Uninitialized);
  ssize_t count = -1;
  do {
    count = ::read(file_, bytes.data(), static_cast<std::size_t>(most));
  } while (count < 0 && errno == EINTR);
  if (count < 0) {
    throw std::system_error(errno, std::generic_category());
  }
  bytes.truncate(static_cast<int>(count));
  return bytes;
}

QByteArray InputFile::readLine(int most) {
  constexpr int kPart = 1 << 16;
  QByteArray line;
  for (;;) {
    const int end = ahead_.indexOf('\n', begin_);
    line += ahead_.mid(begin_, end < 0 ? -1 : end + 1 - begin_);
    if (line.size() > most) {
      throw std::system_error(EMSGSIZE, std::generic_category());
    }
    if (end >= 0) {
      begin_ = end + 1;
      return line;
    }
    ahead_ = read(kPart);
    begin_ = 0;
    if (ahead_.isEmpty()) {
      return line;
    }
  }
}
