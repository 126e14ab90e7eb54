// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/solver_thread.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/session/background_task.h"

namespace lapedit {
namespace {

using Clock = std::chrono::steady_clock;

/// Limits of the pause after which the solver thread completes the last pose and reports on it: twice the time between
/// the last two requests.
constexpr std::chrono::milliseconds kPause{50}, kLongestPause{1000};

/// Region size, in vertices, from which previews exist; the preparation of smaller regions is fast enough.
constexpr int kPreviewFrom = 12000;

/// Runs `work`. @return its error message for the user; empty if it succeeds
template <class Function>
std::string message_of(const Function& work) {
  try {
    work();
  } catch (const std::bad_alloc&) {
    return "There is not enough memory for this region: choose a smaller one.";
  } catch (const std::exception& exception) {
    return exception.what();
  }
  return {};
}

/// Requests of the window.
struct Request {
  bool quit = false;
  std::unique_ptr<PrepareTask> prepare;
  std::unique_ptr<ApplyTask> apply;
  bool has_region = false;  ///< prepared or requested
  bool solve = false;
  bool shown = false;              ///< the cells alone have responded to the newest solve
  std::vector<HandleMotion> maps;  ///< of the newest solve, as the next members are
  bool last = false;
  int serial = 0;
  Clock::time_point at;
  Clock::duration apart{};  ///< time since the previous one
};

/// Results that the window has not taken yet.
struct Response {
  SolverUpdate update;
  SolverPose pose;
};

/// The work that remains for the last pose while no request comes.
enum class Remaining {
  Nothing,
  Report,  ///< the pose is full
  Pose,    ///< the pose is a preview: passes and the full pose follow after a pause
  Passes   ///< the pause is over: the next pass follows at once
};

/// Data that only the solver thread uses.
struct Work {
  std::shared_ptr<StepSolver> solver;
  int generation = -1;                            ///< of the solver
  std::shared_ptr<const LaplacianSystem> system;  ///< the newest, to be reused
  std::vector<HandleMotion> maps;
  int serial = 0;
  SolverPose pose;
};

}  // namespace

struct SolverThread::Impl {
  std::function<void()> wake;
  mutable std::mutex mutex;
  std::condition_variable requested;  // wakes the solver thread
  std::condition_variable responded;  // wakes wait()
  std::thread thread;

  // Guarded by mutex.
  Request request;
  Response response;
  bool working = false;
  bool preparing = false;  // the background works on the newest request
  Remaining remaining = Remaining::Nothing;
  std::string stage;

  std::atomic<int> newest{0};      // serial number, read by a running solve
  std::atomic<int> generation{0};  // counts requests that discard all earlier ones
  std::atomic<double> progress{0};

  Work work;
  BackgroundTask<std::shared_ptr<const LaplacianSystem>> background{[this] {  // makes the systems of large regions
    {
      const std::lock_guard<std::mutex> lock(mutex);  // prevents a lost wake-up
    }
    requested.notify_all();
  }};

  bool current() const { return work.solver && work.generation == generation; }
  bool usable() const { return current() && work.solver->system(); }
  bool has_frames() const { return current() && work.solver->has_frames(); }
  bool is_preview() const { return remaining == Remaining::Pose || remaining == Remaining::Passes; }
  bool answerable() const { return request.solve && (usable() || (has_frames() && !(request.last && request.shown))); }
  bool is_stale() const { return (work.solver || work.system) && !current() && !request.prepare; }
  bool is_busy() const { return working || is_preview() || preparing || request.prepare || request.apply; }
  bool has_work() const {
    return request.quit || request.prepare || request.apply || background.ready() || is_stale() || answerable();
  }

  /// Discards earlier requests; `change` sets the new one.
  template <class Change>
  void replace_request(const Change& change) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      discard();
      change(request);
    }
    requested.notify_all();
  }

  /// Discards all earlier requests. Call it under the mutex.
  void discard() {
    ++generation;
    request.prepare.reset();
    request.apply.reset();
    request.solve = request.has_region = false;
    remaining = Remaining::Nothing;
    preparing = false;
    response.update = SolverUpdate();
    progress = 0;
    stage = "";
  }

  template <class Change>
  void publish(int mine, const Change& change) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (generation != mine) {
        return;
      }
      change();
    }
    responded.notify_all();
    if (wake) {
      wake();
    }
  }

  Progress progress_of(int mine) {
    return [this, mine](double fraction, const char* name) {
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (generation != mine) {
          return false;
        }
        if (progress == fraction && stage == name) {
          return true;
        }
        progress = fraction;
        stage = name;
      }
      if (wake) {
        wake();
      }
      return true;
    };
  }

  void publish_ready(int mine) {
    work.system = work.solver->system();
    publish(mine, [&] {
      SolverUpdate& update = response.update;
      update.preview = update.ready = true;
      update.full_frames = !has_frames();
    });
  }

  /// Makes the cells. Ignores an error if only frames need cells, since poses are possible without them.
  void make_cells(StepSolver& solver) {
    try {
      solver.make_cells();
    } catch (const EditError& error) {
      if (error.cause() == ErrorCause::Cancelled || solver.settings().method == EditMethod::Default) {
        throw;
      }
    }
  }

  /// Makes a region and its cells. The background thread makes the system of a large region.
  void prepare(const PrepareTask& task, int mine) {
    const Progress progress_here = progress_of(mine);
    const ProgressScope scope(progress_here);
    background.cancel();
    validate(task.settings);
    report_progress(0, "region");
    const FoundRegion found = find_region(*task.mesh, *task.adjacency, task.region, task.groups, task.weights);
    publish(mine, [&] { response.update.region = found.region; });
    const auto solver =
        std::make_shared<StepSolver>(*task.mesh, found, task.settings, StepOptions{task.scalar, task.mirror});
    const bool is_large = found.region->size() >= kPreviewFrom;
    if (is_large || task.settings.method == EditMethod::Linear) {
      make_cells(*solver);
    }
    if (!is_large) {
      solver->prepare(*task.mesh, work.system.get());
      work.solver = solver;
      work.generation = mine;
      publish_ready(mine);
      return;
    }
    work.solver = solver;
    work.generation = mine;
    if (solver->has_frames()) {
      publish(mine, [&] { response.update.preview = true; });
    }
    {
      const std::lock_guard<std::mutex> lock(mutex);
      preparing = generation == mine;
    }
    background.start([this, mine, solver, mesh = task.mesh, previous = std::move(work.system)] {
      const Progress progress_there = progress_of(mine);
      const ProgressScope progress_scope(progress_there);
      return solver->make_system(*mesh, previous.get());
    });
  }

  /// Takes the background's result; later frames use it.
  void take_prepared(std::unique_lock<std::mutex>& lock) {
    const int mine = work.generation;
    lock.unlock();
    std::shared_ptr<const LaplacianSystem> system;
    const std::string error = message_of([&] { system = background.take().value_or(nullptr); });
    if (generation == mine && system) {
      work.solver->take(system);
      publish_ready(mine);
    } else if (generation == mine && !error.empty()) {
      publish(mine, [&] { response.update.error = error; });
      work.solver.reset();
    }
    lock.lock();
    if (generation == mine) {
      preparing = false;
      if (!error.empty()) {
        request.solve = request.has_region = false;
        remaining = Remaining::Nothing;
      }
    }
  }

  void publish_pose(int mine, int serial, Remaining then, const std::shared_ptr<const EditReport>& report = nullptr) {
    work.pose.serial = serial;
    publish(mine, [&] {
      remaining = then;
      std::swap(response.pose, work.pose);
      response.update.pose = true;
      response.update.report = report ? report : response.update.report;
    });
  }

  /// Publishes the exact pose with its report, or a frame, whose error is invisible. A newer request does not end it;
  /// otherwise requests that come faster than poses would leave none.
  /// @param exactly  false: there is no system yet, and frames are poses of the cells. In response to a final request
  /// such a pose has the serial number before that of the request, so that it does not count as the final pose
  void solve(int mine, bool last, bool exactly) {
    const Progress keep_going = [this, mine](double, const char*) { return generation == mine; };
    const bool full = last && exactly;
    bool is_frame = !full && has_frames();
    try {
      if (is_frame) {
        work.solver->frame(work.maps, work.pose.positions);
      }
    } catch (const EditError& error) {  // a full pose reports it, too
      if (exactly ? error.cause() != ErrorCause::NotFinite : !last) {
        throw;
      }
      if (!exactly) {
        return;
      }
      is_frame = false;
    }
    const ProgressScope scope(keep_going);
    if (!is_frame) {
      work.pose.positions = work.solver->pose(work.maps);
    }
    const auto report = full ? std::make_shared<const EditReport>(work.solver->report()) : nullptr;
    const Remaining then = is_frame ? Remaining::Pose : full ? Remaining::Nothing : Remaining::Report;
    publish_pose(mine, last && !exactly ? work.serial - 1 : work.serial, then, report);
  }

  /// Waits until there is work. @return false if no request came during the pause, so that the last pose can be
  /// completed
  bool wait_for_work(std::unique_lock<std::mutex>& lock) {
    const auto ready = [this] { return has_work(); };
    if (remaining != Remaining::Nothing && usable()) {
      const Clock::duration pause = remaining == Remaining::Passes
                                        ? Clock::duration()
                                        : std::clamp<Clock::duration>(2 * request.apart, kPause, kLongestPause);
      return requested.wait_for(lock, pause, ready);
    }
    requested.wait(lock, ready);
    return true;
  }

  /// Completes the last pose, one stage per call: its passes, the last of which is the full pose, then, after another
  /// pause, its report.
  void settle(std::unique_lock<std::mutex>& lock) {
    const int mine = generation;
    const bool is_frame = is_preview();
    lock.unlock();
    const Progress keep_going = [this, mine](double, const char*) {
      return generation == mine && newest == work.serial;  // the mouse moves again
    };
    bool failed = false;
    const std::string error = message_of([&] {
      const ProgressScope scope(keep_going);
      if (!is_frame) {
        const auto report = std::make_shared<const EditReport>(work.solver->report());
        publish(mine, [&] {
          remaining = Remaining::Nothing;
          response.update.report = report;
        });
      } else if (work.solver->refine(work.pose.positions)) {
        publish_pose(mine, work.serial, work.solver->settled() ? Remaining::Report : Remaining::Passes);
      } else {
        failed = true;
      }
    });
    failed = failed || !error.empty();
    lock.lock();
    if (failed && generation == mine) {
      remaining = Remaining::Nothing;  // the frame has reported the error, or the mouse moves again
    }
    working = failed;  // run() has to wake callers of busy(), since nothing was published
  }

  void answer_next(std::unique_lock<std::mutex>& lock) {
    const int mine = generation;
    const std::unique_ptr<PrepareTask> prepare_task = std::move(request.prepare);
    const std::unique_ptr<ApplyTask> apply_task = std::move(request.apply);
    const bool solving = !prepare_task && !apply_task;
    const bool last = request.last, exactly = usable();
    if (solving) {
      work.maps = request.maps;
      work.serial = request.serial;
      request.shown = true;
      request.solve = last && !exactly;  // the pose of the cells is not final
    }
    lock.unlock();
    const std::string error = message_of([&] {
      if (prepare_task) {
        prepare(*prepare_task, mine);
      } else if (apply_task) {
        const auto results = std::make_shared<const std::vector<EditResult>>(apply_steps(
            *apply_task->mesh, *apply_task->adjacency, apply_task->edit, apply_task->scalar, progress_of(mine)));
        publish(mine, [&] { response.update.applied = results; });
      } else {
        solve(mine, last, exactly);
      }
    });
    if (!error.empty()) {
      publish(mine, [&] { (solving ? response.update.pose_error : response.update.error) = error; });
    }
    lock.lock();
    if (!error.empty() && !solving && generation == mine) {
      request.solve = request.has_region = false;
    }
  }

  void run() {
    std::unique_lock<std::mutex> lock(mutex);
    while (true) {
      if (std::exchange(working, false) && wake) {
        lock.unlock();
        wake();  // wakes callers of busy()
        lock.lock();
      }
      responded.notify_all();
      const bool has_any = wait_for_work(lock);
      if (request.quit) {
        return;
      }
      if (!has_any) {
        settle(lock);
      } else if (background.ready()) {
        working = true;
        take_prepared(lock);
      } else if (is_stale()) {
        // Free the discarded system now, since a large factor takes time. A requested preparation would reuse it.
        working = true;
        lock.unlock();
        work.solver.reset();
        work.system.reset();
        lock.lock();
      } else {
        working = true;
        answer_next(lock);
      }
    }
  }
};

SolverThread::SolverThread(std::function<void()> wake) : impl_(std::make_unique<Impl>()) {
  impl_->wake = std::move(wake);
  try {
    impl_->thread = std::thread([this] { impl_->run(); });
  } catch (const std::system_error&) {
    throw std::runtime_error("The system allows no more threads: end some programs, or raise the limit (ulimit -u).");
  }
}

SolverThread::~SolverThread() {
  impl_->replace_request([](Request& request) { request.quit = true; });
  impl_->thread.join();
}

void SolverThread::prepare(PrepareTask task) {
  impl_->replace_request([&task](Request& request) {
    request.prepare = std::make_unique<PrepareTask>(std::move(task));
    request.has_region = true;
  });
}

void SolverThread::apply(ApplyTask task) {
  impl_->replace_request([&task](Request& request) { request.apply = std::make_unique<ApplyTask>(std::move(task)); });
}

void SolverThread::cancel() {
  impl_->replace_request([](Request&) {});
}

int SolverThread::solve(const std::vector<HandleMotion>& maps, bool last) {
  int serial = 0;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->request.maps = maps;
    impl_->request.last = last;
    impl_->request.shown = false;
    impl_->request.solve = impl_->request.has_region;
    serial = ++impl_->request.serial;
    impl_->newest = serial;
    const Clock::time_point now = Clock::now();
    impl_->request.apart = now - impl_->request.at;
    impl_->request.at = now;
  }
  impl_->requested.notify_all();
  return serial;
}

SolverUpdate SolverThread::poll(SolverPose& pose) {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  SolverUpdate update = std::exchange(impl_->response.update, SolverUpdate());
  if (update.pose) {
    std::swap(pose, impl_->response.pose);
  }
  return update;
}

bool SolverThread::wait(std::chrono::milliseconds longest) {
  std::unique_lock<std::mutex> lock(impl_->mutex);
  Impl& s = *impl_;
  s.responded.wait_for(lock, longest, [&s] {
    // usable() may read the solver only while the solver thread is idle. The thread is busy again for a moment if it
    // has yet to free discarded data.
    return s.response.update.any() ||
           !(s.is_busy() || (s.request.solve && s.usable()) || s.background.busy() || s.is_stale());
  });
  return s.response.update.any();
}

bool SolverThread::busy() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->is_busy() || impl_->request.solve || impl_->response.update.any();
}

double SolverThread::progress() const {
  return impl_->progress;
}

std::string SolverThread::stage() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->stage;
}

}  // namespace lapedit
