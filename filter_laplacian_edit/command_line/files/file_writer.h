// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QString>
#include <cstdio>
#include <memory>
#include <string>

/// Why a file cannot be written, and what to do, as the end of a sentence without a full stop. @param error  errno
std::string whyNotWritten(int error);

/// A file that is written, and looks whether its bytes arrive. All functions throw std::system_error.
class FileWriter {
 public:
  explicit FileWriter(const QString& path);
  void write(const QByteArray& bytes);
  void close();

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};
