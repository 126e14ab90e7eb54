// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QString>

/// A file or a pipe that is read to its end. Streams of C++ and Qt report a read error as the end; this class throws.
/// All functions throw std::system_error.
class InputFile {
 public:
  explicit InputFile(const QString& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Returns the next bytes, at most this many; empty at the end.
  QByteArray read(int most);

  /// Returns the next line with its line break, which the last one may lack; empty at the end.
  /// @param most  bytes; a longer line throws (EMSGSIZE)
  QByteArray readLine(int most = 1 << 20);

 private:
  int file_ = -1;
  QByteArray ahead_;  // read but not returned yet, from begin_ on
  int begin_ = 0;
};
