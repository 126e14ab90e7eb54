// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QHash>
#include <QJsonArray>
#include <QString>
#include <array>
#include <string>

#include "options.h"

/// The result of a job of a list.
struct JobEnd {
  int code = 0;          ///< exit code of the same job as a single call
  std::string sentence;  ///< the last line on its standard error
  double began = 0;      ///< seconds since 1970
  double seconds = 0;
  qint64 mostMemory = 0;  ///< bytes, of its largest process
};

/// Size and time of the mesh and the edit that a job reads, at its start.
using InputState = std::array<QByteArray, 4>;
InputState inputState(const Options& job);

/// A file that gets a line of JSON for each finished job. Only one run at a time uses it.
class JobLog {
 public:
  /// @param path  created if it does not exist; empty: no log
  /// @throws Failure (Unwritable; WrongUsage if the file is something else)
  explicit JobLog(const QString& path);
  ~JobLog();
  JobLog(const JobLog&) = delete;
  JobLog& operator=(const JobLog&) = delete;

  /// Returns a message with the lines that are no entries; empty if all are.
  const std::string& complaint() const { return complaint_; }

  /// Returns whether the job was done, its inputs are unchanged, and all its files still exist with their sizes.
  bool isDone(const Options& job) const;

  /// @throws Failure (Unwritable)
  void add(int line, const Options& job, const InputState& before, const JobEnd& end);

 private:
  struct Known {
    InputState state;
    QJsonArray sizes;  // of the outputs
  };

  void read();
  void append(const QByteArray& text);

  QString path_;
  int file_ = -1;
  QHash<QByteArray, Known> done_;  // finished jobs with the states of their inputs
  std::string complaint_;
};
