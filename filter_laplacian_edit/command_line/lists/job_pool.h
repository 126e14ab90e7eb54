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

/// Runs jobs concurrently, each in a supervised process of its own, so that no failure affects other jobs. For a
/// process without threads, with one pool at a time. Requests to stop are passed on to all jobs.
class JobPool {
 public:
  JobPool();
  /// To be called when no job runs.
  ~JobPool();
  JobPool(const JobPool&) = delete;
  JobPool& operator=(const JobPool&) = delete;

  int running() const { return static_cast<int>(jobs_.size()); }

  /// Returns the request to stop that has arrived (SIGINT, SIGTERM or SIGHUP), 0 if none has.
  int stopped() const { return stopped_; }

  /// Starts a job.
  /// @param number   identifies it
  /// @param threads  number of threads to use
  /// @return false if the system starts no further process
  bool start(int number, int threads, const std::function<int(Notes&)>& work);

  /// Waits for the next job to end. @return its number and its end
  std::pair<int, JobEnd> wait();

 private:
  struct Running {
    int number = 0;
    int errors = -1;  // its standard error
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

/// Returns the number of processors that this process may use.
int processors();
