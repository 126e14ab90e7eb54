// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <csignal>
#include <functional>
#include <string>

#include "files/scratch_folder.h"

/// Files that replace their targets together, when all are complete. Until then they are in a folder next to the
/// targets, under their final names (or plain ones where those are no UTF-8), so that they can refer to each other.
class OutputFiles {
 public:
  /// Checks that the targets can be written, as far as possible; creates nothing. @param what name in messages:
  /// "output" or "report" @param places absolute paths; links are followed, also if they lead to no file
  /// @throws Failure (Unwritable)
  OutputFiles(const std::string& what, const QStringList& places);
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Creates the folder, unless it exists.
  /// @param made  called with the folder before anything is in it
  /// @throws Failure (Unwritable)
  void begin(const std::function<void(const std::string&)>& made);

  /// Returns where to write output number k. Other files in its folder are moved with it.
  QString path(int k) const;
  /// Returns a path in that folder.
  QString beside(const QString& name) const;

  /// Flushes all files to the disk. @throws Failure (Unwritable)
  void synchronise();

  /// Moves the files to their targets, one after the other. Owner, group and permissions of a replaced file are kept as
  /// far as permitted, but no setuid or setgid bit.
  /// @throws Failure (Unwritable)
  void place();

 private:
  [[noreturn]] void refuse(const QString& place, const std::string& why) const;

  std::string what_;
  QString folder_;
  QStringList names_, staged_;  ///< final paths, and paths until then
  QStringList others_;          ///< other files in the folder
  ScratchFolder scratch_;
};

/// Blocks requests to stop during its lifetime, so that either all targets are replaced or none.
class NoInterruption {
 public:
  NoInterruption();
  /// Blocks requests until the end of the process, since no work is left to stop.
  void forGood() { for_good_ = true; }
  ~NoInterruption();
  NoInterruption(const NoInterruption&) = delete;
  NoInterruption& operator=(const NoInterruption&) = delete;

 private:
  sigset_t before_;
  bool for_good_ = false;
};
