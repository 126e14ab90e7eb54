// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <functional>

/// Files that appear in their place all at once, when they are complete. Until then they are in a folder of their own
/// beside it, under the names that they will have, so that they can refer to each other.
class OutputFiles {
 public:
  /// Checks that the places can be written to, as far as that can be seen; nothing is made yet.
  /// @param places  absolute paths; links are followed
  /// @throws Failure (Unwritable)
  explicit OutputFiles(const QStringList& places);
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// @param made  is told the folder before anything is in it
  /// @throws Failure (Unwritable)
  void begin(const std::function<void(const QString&)>& made);

  /// Where to write output number k. Other files beside it come along.
  QString path(int k) const;

  /// Brings all files to the disk and then to their places. @throws Failure (Unwritable)
  void commit();

 private:
  void place(const QString& name);

  QString folder_, scratch_;
  QStringList names_;
};
