// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QHash>
#include <QJsonArray>
#include <QString>
#include <array>
#include <string>

#include "options.h"

/// How a job of a list ended.
struct JobEnd {
  int code = 0;          ///< as the program would have ended with
  std::string sentence;  ///< the last one on its standard error
  double began = 0;      ///< seconds since 1970
  double seconds = 0;
  qint64 mostMemory = 0;  ///< bytes, of its largest process
};

/// Size and time of the mesh and of the edit that a job reads, as they were when the job began.
using InputState = std::array<QByteArray, 4>;
InputState inputState(const Options& job);

/// A file to which a line of JSON is added whenever a job has ended. One run at a time has it.
class JobLog {
 public:
  /// @param path  made if it does not exist; empty: nothing is logged
  /// @throws Failure (Unwritable; WrongUsage if the file is something else)
  explicit JobLog(const QString& path);
  ~JobLog();
  JobLog(const JobLog&) = delete;
  JobLog& operator=(const JobLog&) = delete;

  /// Which lines are no entries, in a sentence; empty if all are.
  const std::string& complaint() const { return complaint_; }

  /// Whether it was done, what it read is as it was, and all its files are still there and have their sizes.
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
  QHash<QByteArray, Known> done_;  // what was done, and of which inputs
  std::string complaint_;
};
