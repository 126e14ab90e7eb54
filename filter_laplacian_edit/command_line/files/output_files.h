// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <csignal>
#include <functional>
#include <string>

#include "files/scratch_folder.h"

/// Files that appear in their place all at once, when they are complete. Until then they are in a folder of their own
/// beside it, under the names that they will have (or plain ones, where those are no UTF-8), so that they can refer to
/// each other.
class OutputFiles {
 public:
  /// Checks that the places can be written to, as far as that can be seen; nothing is made yet.
  /// @param what    as it is called in messages: "output" or "report"
  /// @param places  absolute paths; links are followed, also where nothing is at their end
  /// @throws Failure (Unwritable)
  OutputFiles(const std::string& what, const QStringList& places);
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Makes the folder, unless it is there.
  /// @param made  called with the folder before anything is in it
  /// @throws Failure (Unwritable)
  void begin(const std::function<void(const std::string&)>& made);

  /// Where to write output number k. Other files beside it come along.
  QString path(int k) const;
  /// A path beside them.
  QString beside(const QString& name) const;

  /// Brings all files to the disk. @throws Failure (Unwritable)
  void synchronise();

  /// Brings them to their places, one after the other. A file that was there hands down owner, group and permissions as
  /// far as the right exists, but never the right to run as another user.
  /// @throws Failure (Unwritable)
  void place();

 private:
  [[noreturn]] void refuse(const QString& place, const std::string& why) const;

  std::string what_;
  QString folder_;
  QStringList names_, staged_;  ///< in their places, and until then
  QStringList others_;          ///< those that came along
  ScratchFolder scratch_;
};

/// While it lives, a request to stop waits: either all files are in their places or none.
class NoInterruption {
 public:
  NoInterruption();
  /// From here on it waits for the process's end: there is nothing left to be stopped.
  void forGood() { for_good_ = true; }
  ~NoInterruption();
  NoInterruption(const NoInterruption&) = delete;
  NoInterruption& operator=(const NoInterruption&) = delete;

 private:
  sigset_t before_;
  bool for_good_ = false;
};
