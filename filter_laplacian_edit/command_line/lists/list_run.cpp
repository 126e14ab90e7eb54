// SPDX-License-Identifier: GPL-3.0-or-later
#include "lists/list_run.h"

#include <QFile>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "job.h"
#include "lists/job_list.h"
#include "lists/job_log.h"
#include "lists/job_pool.h"
#include "processes/error_stream.h"
#include "progress_line.h"

namespace {

/// Loads what each job needs into the process from which all jobs are forked.
void loadBefore(const Options& options, int atOnce) {
  // Some of MeshLab's plugins load a BLAS, which reads its number of threads then.
  setenv("OPENBLAS_NUM_THREADS", std::to_string(std::max(1, processors() / atOnce)).c_str(), 0);
  try {
    lapedit::host::BatchHost(options.plugins, {}).requireWriter("common.ply");
  } catch (const std::exception&) {
    // The jobs will report it.
  }
}

class ListRun {
 public:
  ListRun(const Options& options, const std::function<int(const Options&, Notes&)>& job)
      : options_(options),
        job_(job),
        jobs_(readJobList(options)),
        log_(options.list.log),
        line_(!options.quiet),
        at_once_(std::clamp(options.list.jobs > 0 ? options.list.jobs : processors(), 1,
                            std::max(1, static_cast<int>(jobs_.size())))) {}

  int run(std::FILE* output) {
    if (!log_.complaint().empty()) {
      std::fprintf(errorStream(), "%s\n", log_.complaint().c_str());
    }
    loadBefore(options_, at_once_);
    std::size_t next = 0;
    std::optional<Failure> failure;
    for (;;) {
      while (!failure && pool_.stopped() == 0 && next < jobs_.size() && pool_.running() < at_once_) {
        if (!begin(next)) {
          break;
        }
        ++next;
      }
      if (pool_.running() == 0) {
        break;
      }
      try {
        end();
      } catch (const Failure& error) {
        failure = error;  // the other running jobs are finished
      }
    }
    line_.clear();
    if (!failure && pool_.stopped() == 0 && next < jobs_.size()) {
      failure = Failure(Unexpected,
                        "No process can be started for a job: use fewer --jobs, or allow more processes or memory "
                        "(ulimit -u, ulimit -v).");
    }
    if (!options_.quiet) {
      printAll(summary() + "\n", output, "what is done is in the job log, if there is one");
    }
    if (failure) {
      throw *std::move(failure);
    }
    return worst_;
  }

  int stopped() const { return pool_.stopped(); }

 private:
  /// @return false if no process can be started now
  bool begin(std::size_t k) {
    const Options job = optionsOf(jobs_[k], options_);
    if (options_.list.resume && log_.isDone(job)) {
      ++done_before_;
      return true;
    }
    InputState state = inputState(job);
    const int threads = std::max(1, processors() / at_once_);
    if (!pool_.start(static_cast<int>(k), threads, [&](Notes& notes) { return job_(job, notes); })) {
      return false;
    }
    states_[static_cast<int>(k)] = std::move(state);
    return true;
  }

  void end() {
    const auto [number, end] = pool_.wait();
    const ListedJob& listed = jobs_[static_cast<std::size_t>(number)];
    const auto state = states_.find(number);
    if (end.code == Done) {
      ++done_;
    } else {
      ++failed_;
      worst_ = std::max(worst_, end.code);
      line_.clear();
      std::fprintf(errorStream(), "Line %d: %s\n", listed.line, end.sentence.c_str());
    }
    log_.add(listed.line, optionsOf(listed, options_), state->second, end);
    states_.erase(state);
    const std::string told = summary();
    line_.show(static_cast<double>(done_ + failed_ + done_before_) / static_cast<double>(jobs_.size()), told.c_str());
  }

  std::string summary() const {
    std::string text = std::to_string(done_ + done_before_) + " of " + std::to_string(jobs_.size()) + " jobs done";
    if (done_before_ > 0) {
      text += " (" + std::to_string(done_before_) + " of them before)";
    }
    return text + ", " + std::to_string(failed_) + " failed.";
  }

  const Options& options_;
  const std::function<int(const Options&, Notes&)>& job_;
  std::vector<ListedJob> jobs_;
  JobLog log_;
  JobPool pool_;
  ProgressLine line_;
  int at_once_;
  std::map<int, InputState> states_;  // of the jobs that run
  int done_ = 0, failed_ = 0, done_before_ = 0, worst_ = Done;
};

}  // namespace

int runList(const Options& options, const std::function<int(const Options&, Notes&)>& job, std::FILE* output) {
  int stopped = 0, code = Done;
  {
    ListRun run(options, job);
    code = run.run(output);
    stopped = run.stopped();
  }
  if (stopped != 0) {
    std::signal(stopped, SIG_DFL);
    std::raise(stopped);
  }
  return code;
}
