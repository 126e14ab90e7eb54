// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <csignal>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "lists/job_log.h"
#include "processes/supervisor.h"

/// Jobs that run side by side, each in a supervised process of its own: whatever happens to one happens to no other.
/// For a process without threads, of which there is one pool at a time. Requests to stop are passed on to all jobs.
class JobPool {
 public:
  JobPool();
  /// To be called when no job runs any more.
  ~JobPool();
  JobPool(const JobPool&) = delete;
  JobPool& operator=(const JobPool&) = delete;

  int running() const { return static_cast<int>(jobs_.size()); }

  /// The request to stop that has arrived (SIGINT, SIGTERM or SIGHUP), 0 if none has.
  int stopped() const { return stopped_; }

  /// Starts a job.
  /// @param number   identifies it
  /// @param threads  how many it should use
  /// @return false if no process can be started now
  bool start(int number, int threads, const std::function<int(Notes&)>& work);

  /// Waits for the next job to end. @return its number and its end
  std::pair<int, JobEnd> wait();

 private:
  struct Running {
    int number = 0;
    int errors = -1;  // what it writes to its standard error can be read here
    std::string text;
    double began = 0;
  };

  void readErrors(Running& job);
  std::optional<std::pair<int, JobEnd>> reap();

  std::map<pid_t, Running> jobs_;
  int signals_ = -1;
  int stopped_ = 0;
  sigset_t before_ = {};
};

/// Processors that this process may use.
int processors();
