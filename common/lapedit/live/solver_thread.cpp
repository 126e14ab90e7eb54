// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/live/solver_thread.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/joined_thread.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/live/drag_frames.h"

namespace lapedit {
namespace {

using Clock = std::chrono::steady_clock;

/// After this time without a request, and twice the time between the last two, the last one is answered in full, with a
/// report.
constexpr std::chrono::milliseconds kPause{50}, kLongestPause{1000};

/// Smaller regions are prepared fast enough without previews.
constexpr int kHandFrom = 12000;

constexpr const char* kNoMemory = "There is not enough memory for this region: choose a smaller one.";

/// Requests of the window.
struct Asked {
  bool quit = false;
  std::unique_ptr<PrepareTask> prepare;
  std::unique_ptr<ApplyTask> apply;
  bool has_region = false;  ///< prepared or requested
  bool solve = false;
  bool shown = false;              ///< the newest solve has been answered by the cells alone
  std::vector<HandleMotion> maps;  ///< of the newest solve, as the next members are
  bool last = false;
  int serial = 0;
  Clock::time_point at;
  Clock::duration apart{};  ///< time since the previous one
};

/// Results that the window has not taken yet.
struct Answered {
  bool has_news = false;
  SolverNews news;
  SolverPose pose;
};

/// The next or current job of the background thread.
struct Job {
  PrepareTask task;
  FoundRegion found;
  std::shared_ptr<CellModel> cells;
  Stopwatch watch;
  int generation = -1;
};

/// Data of the solver thread only.
struct AtWork {
  std::unique_ptr<StepRunner> runner;
  int generation = -1;  ///< of the runner
  std::unique_ptr<DragFrames> frames;
  int frames_generation = -1;
  std::shared_ptr<Job> job, next_job;         ///< the background's
  StoredScalar scalar = StoredScalar::Float;  ///< of what was prepared last
  std::vector<HandleMotion> maps;
  int serial = 0;
  SolverPose pose;
  bool preview = false;     ///< the last pose was a preview; the full one is still to be computed
  bool refines = false;     ///< the mouse rests, and further passes are made
  bool report_due = false;  ///< the last pose has no report yet
};

enum class Answer {
  Preview,  ///< a frame of a drag, with an invisible error
  Full,     ///< as at a release
  Last      ///< the same with its report
};

}  // namespace

struct SolverThread::Impl {
  std::function<void()> wake;
  mutable std::mutex mutex;
  std::condition_variable question;  // for the thread
  std::condition_variable answer;    // for wait()
  std::thread thread;

  // Guarded by mutex.
  Asked asked;
  Answered answered;
  bool working = false;
  bool preparing = false;  // the background works on the newest request

  std::atomic<int> newest{0};          // serial number, read by a running solve
  std::atomic<bool> unsettled{false};  // the last pose was a preview, and is still to be solved for in full
  std::atomic<int> generation{0};      // counts requests that discard all earlier ones
  std::atomic<double> progress{0};
  std::atomic<const char*> stage{""};

  AtWork own;
  std::atomic<bool> prepared{false};                    // the background has made a runner, or failed
  std::future<std::unique_ptr<StepRunner>> background;  // valid until its result is taken
  JoinedThread background_thread;

  void drop();
  template <class Change>
  void ask(const Change& change);
  void run();
  bool usable() const { return own.runner && own.generation == generation; }
  bool has_frames() const { return own.frames && own.frames_generation == generation; }
  bool answerable() const { return asked.solve && (usable() || (has_frames() && !(asked.last && asked.shown))); }
  bool has_work() const {
    return asked.quit || asked.prepare || asked.apply || prepared || (own.runner && !usable()) || answerable();
  }
  bool wait_for_work(std::unique_lock<std::mutex>& lock);
  void settle(std::unique_lock<std::mutex>& lock);
  void answer_next(std::unique_lock<std::mutex>& lock);
  Progress progress_of(int mine);

  // Preparing.
  void prepare(const PrepareTask& task, int mine);
  void prepare_in_background();
  void take_prepared(std::unique_lock<std::mutex>& lock);
  void make_frames(const PrepareTask& task, const FoundRegion& found, int mine);
  void publish_ready(int mine, double prepare_ms, bool in_hand);
  void apply(const ApplyTask& task, int mine);

  // Posing.
  void pose_cells(int mine, bool last);
  bool pose_frame();
  bool refine_frame();
  void solve(int mine, Answer kind);
  void publish_pose(int mine, int serial, const std::shared_ptr<const EditReport>& report);
  template <class Change>
  void publish(int mine, const Change& change);
};

/// Discards earlier requests; `change` sets the new one in `asked`.
template <class Change>
void SolverThread::Impl::ask(const Change& change) {
  {
    const std::lock_guard<std::mutex> lock(mutex);
    drop();
    change(asked);
  }
  question.notify_all();
}

/// Discards all earlier requests. Call it under the mutex.
void SolverThread::Impl::drop() {
  ++generation;
  asked.prepare.reset();
  asked.apply.reset();
  asked.solve = asked.has_region = false;
  unsettled = preparing = false;
  answered.news = SolverNews();
  answered.has_news = false;
  progress = 0;
  stage = "";
}

template <class Change>
void SolverThread::Impl::publish(int mine, const Change& change) {
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (generation != mine) {
      return;
    }
    change();
    answered.has_news = true;
  }
  answer.notify_all();
  if (wake) {
    wake();
  }
}

Progress SolverThread::Impl::progress_of(int mine) {
  return [this, mine](double fraction, const char* name) {
    progress = fraction;
    stage = name;
    if (generation != mine) {
      return false;
    }
    if (wake) {
      wake();
    }
    return true;
  };
}

void SolverThread::Impl::publish_ready(int mine, double prepare_ms, bool in_hand) {
  own.report_due = own.refines = false;
  unsettled = false;
  if (has_frames()) {
    own.frames->correct_with(&own.runner->editor());
  }
  publish(mine, [&] {
    SolverNews& news = answered.news;
    news.ready = true;
    news.prepare_ms = prepare_ms;
    news.taken_over = own.runner->taken_over();
    news.full_frames = !has_frames() || !DragFrames::has_frames(own.runner->editor().system().settings);
    if (!in_hand) {
      news.in_hand = true;
      news.in_hand_ms = prepare_ms;
    }
  });
}

/// If there are no cells, the editor works without them or reports the error.
void SolverThread::Impl::make_frames(const PrepareTask& task, const FoundRegion& found, int mine) {
  try {
    const std::shared_ptr<CellModel> made = usable() ? own.runner->editor().cells() : nullptr;
    own.frames = made ? std::make_unique<DragFrames>(made, task.settings)
                      : std::make_unique<DragFrames>(*task.mesh, found.region, task.settings, progress_of(mine));
    own.frames_generation = mine;
  } catch (const EditError& error) {
    if (error.cause() == ErrorCause::Cancelled) {
      throw;
    }
  }
}

/// Makes a region and its cells; the background does the rest for a large one.
void SolverThread::Impl::prepare(const PrepareTask& task, int mine) {
  const auto job = std::make_shared<Job>();
  job->task = task;
  job->generation = mine;
  own.scalar = task.scalar;
  const Progress progress_here = progress_of(mine);
  const StepProblem problem = task.problem();
  own.frames.reset();
  own.next_job.reset();
  job->found = find_region(problem, progress_here);
  publish(mine, [&] { answered.news.region = job->found.region; });
  if (job->found.region->size() < kHandFrom) {
    own.runner = std::make_unique<StepRunner>(job->found, problem, progress_here, std::move(own.runner));
    own.generation = mine;
    if (DragFrames::has_frames(task.settings)) {
      make_frames(task, job->found, mine);
    }
    publish_ready(mine, job->watch.elapsed(), false);
    return;
  }
  make_frames(task, job->found, mine);
  if (own.frames) {
    job->cells = own.frames->cells();
    publish(mine, [&] {
      answered.news.in_hand = true;
      answered.news.in_hand_ms = job->watch.elapsed();
    });
  }
  own.next_job = job;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    preparing = generation == mine;
  }
  prepare_in_background();
}

/// Gives the background its next job as soon as it is idle.
void SolverThread::Impl::prepare_in_background() {
  if (own.next_job && own.next_job->generation != generation) {
    own.next_job.reset();  // discarded meanwhile
  }
  if (background.valid() || !own.next_job) {
    return;
  }
  own.job = std::exchange(own.next_job, nullptr);
  const auto previous = std::make_shared<std::unique_ptr<StepRunner>>(std::move(own.runner));
  const auto make = [this, job = own.job, previous] {
    return std::make_unique<StepRunner>(job->found, job->task.problem(), progress_of(job->generation),
                                        std::move(*previous), job->cells);
  };
  try {
    std::packaged_task<std::unique_ptr<StepRunner>()> task([this, make] {
      struct Announce {
        ~Announce() {
          {
            const std::lock_guard<std::mutex> lock(thread.mutex);  // Prevents a lost wake-up.
            thread.prepared = true;
          }
          thread.question.notify_all();
        }
        Impl& thread;
      } const announce{*this};
      return make();
    });
    std::future<std::unique_ptr<StepRunner>> result = task.get_future();
    background_thread = JoinedThread(std::move(task));
    background = std::move(result);
  } catch (const std::system_error&) {  // no thread is available: take_prepared() does the work on this one
    background = std::async(std::launch::deferred, make);
    prepared = true;
  }
}

/// Takes the background's result; later frames are corrected with it.
void SolverThread::Impl::take_prepared(std::unique_lock<std::mutex>& lock) {
  const std::shared_ptr<Job> job = std::move(own.job);
  const int mine = job->generation;
  prepared = false;
  lock.unlock();
  std::string error;
  try {
    std::unique_ptr<StepRunner> made = background.get();
    if (generation == mine || !own.runner) {
      own.runner = std::move(made);
      own.generation = mine;
    }
  } catch (const std::bad_alloc&) {
    error = kNoMemory;
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (generation == mine) {
    if (error.empty()) {
      const bool shown = own.preview;
      publish_ready(mine, job->watch.elapsed(), has_frames());
      own.report_due = own.preview = own.refines = shown;
      unsettled = shown;
    } else {
      publish(mine, [&] { answered.news.error = error; });
      own.frames.reset();
    }
  }
  prepare_in_background();
  lock.lock();
  if (generation == mine) {
    preparing = false;
    if (!error.empty()) {
      asked.solve = asked.has_region = false;
      unsettled = false;
    }
  }
}

void SolverThread::Impl::apply(const ApplyTask& task, int mine) {
  require_same_mesh(*task.mesh, task.edit);
  auto results = std::make_shared<std::vector<EditResult>>();
  apply_steps(*task.mesh, *task.adjacency, task.edit, 1, task.scalar, progress_of(mine),
              [&results](EditResult&& result) { results->push_back(std::move(result)); });
  publish(mine, [&] { answered.news.applied = results; });
}

void SolverThread::Impl::publish_pose(int mine, int serial, const std::shared_ptr<const EditReport>& report) {
  own.pose.serial = serial;
  publish(mine, [&] {
    std::swap(answered.pose, own.pose);
    answered.news.pose = true;
    answered.news.report = report ? report : answered.news.report;
  });
}

/// Before the region is prepared: a pose has the serial number before that of a final one, so that it is not taken for
/// it.
void SolverThread::Impl::pose_cells(int mine, bool last) {
  const Stopwatch watch;
  try {
    own.pose.positions = own.frames->pose(own.maps);
    round_to(own.scalar, own.pose.positions);
  } catch (const std::exception&) {
    if (last) {
      return;  // the editor will report it
    }
    throw;
  }
  own.pose.solve_ms = watch.elapsed();
  own.preview = own.report_due = true;
  unsettled = true;
  publish_pose(mine, last ? own.serial - 1 : own.serial, nullptr);
}

/// @return whether there is a frame for these motions that is not a full solution
bool SolverThread::Impl::pose_frame() {
  if (!has_frames() || !DragFrames::has_frames(own.runner->editor().system().settings)) {
    return false;
  }
  try {
    own.pose.positions = own.frames->pose(own.maps);
  } catch (const EditError& error) {
    if (error.cause() != ErrorCause::NotFinite) {
      throw;
    }
    return false;  // coordinates are too large: the editor will report it
  }
  own.runner->finish(own.pose.positions);
  return true;
}

/// Makes further passes while the mouse rests. The first pose after the cells' has no passes yet.
bool SolverThread::Impl::refine_frame() {
  if (!has_frames()) {
    return false;
  }
  const Stopwatch watch;
  if (!own.frames->corrected()) {
    own.frames->pose(own.maps);
  } else if (!own.frames->refine()) {
    return false;
  }
  own.pose.positions = own.frames->positions();
  own.runner->finish(own.pose.positions);
  own.pose.solve_ms = watch.elapsed();
  return true;
}

void SolverThread::Impl::solve(int mine, Answer kind) {
  const Stopwatch watch;
  const auto go_on = [this, mine](double, const char*) { return generation == mine && newest == own.serial; };
  const bool is_frame = kind == Answer::Preview && pose_frame();
  if (!is_frame) {
    own.runner->solve(own.maps, own.pose.positions, kind == Answer::Full ? Progress(go_on) : Progress());
  }
  own.pose.solve_ms = watch.elapsed();
  const auto report = kind == Answer::Last ? std::make_shared<const EditReport>(own.runner->report(false)) : nullptr;
  own.report_due = kind != Answer::Last;
  own.refines = false;
  unsettled = own.preview = is_frame;
  publish_pose(mine, own.serial, report);
}

/// Waits until there is work. @return false: the mouse rests, so the last pose can be completed
bool SolverThread::Impl::wait_for_work(std::unique_lock<std::mutex>& lock) {
  const auto ready = [this] { return has_work(); };
  if (own.report_due && usable()) {
    const Clock::duration pause =
        own.refines ? Clock::duration() : std::clamp<Clock::duration>(2 * asked.apart, kPause, kLongestPause);
    return question.wait_for(lock, pause, ready);
  }
  question.wait(lock, ready);
  return true;
}

/// First the pose's further passes, each a frame, then the full pose, then, after another pause, its report.
void SolverThread::Impl::settle(std::unique_lock<std::mutex>& lock) {
  const int mine = generation;
  bool failed = false;
  lock.unlock();
  try {
    if (own.preview && refine_frame()) {
      own.refines = true;
      publish_pose(mine, own.serial, nullptr);
      lock.lock();
      return;
    }
    own.refines = false;
    if (std::exchange(own.preview, false)) {
      solve(mine, Answer::Full);
    } else {
      own.report_due = false;
      const auto report = std::make_shared<const EditReport>(own.runner->report(false));
      publish(mine, [&] { answered.news.report = report; });
    }
  } catch (const std::exception&) {
    own.report_due = own.preview = own.refines = false;  // the frame has reported the error, or the mouse moves again
    failed = true;
  }
  unsettled = false;
  lock.lock();
  working = failed;  // nothing was published, but callers of busy() must be woken
}

void SolverThread::Impl::answer_next(std::unique_lock<std::mutex>& lock) {
  const int mine = generation;
  const std::unique_ptr<PrepareTask> prepare_task = std::move(asked.prepare);
  const std::unique_ptr<ApplyTask> apply_task = std::move(asked.apply);
  const bool solving = !prepare_task && !apply_task;
  const bool last = asked.last, exactly = usable();
  if (solving) {
    own.maps = asked.maps;
    own.serial = asked.serial;
    asked.shown = true;
    asked.solve = last && !exactly;  // the pose of the cells is not final
  }
  lock.unlock();
  std::string error;
  try {
    if (prepare_task) {
      prepare(*prepare_task, mine);
    } else if (apply_task) {
      apply(*apply_task, mine);
    } else if (exactly) {
      solve(mine, last ? Answer::Last : Answer::Preview);
    } else {
      pose_cells(mine, last);
    }
  } catch (const std::bad_alloc&) {
    error = kNoMemory;
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (!error.empty()) {
    publish(mine, [&] { (solving ? answered.news.pose_error : answered.news.error) = error; });
  }
  lock.lock();
  if (!error.empty() && !solving && generation == mine) {
    asked.solve = asked.has_region = false;
  }
}

void SolverThread::Impl::run() {
  std::unique_lock<std::mutex> lock(mutex);
  while (true) {
    if (std::exchange(working, false) && wake) {
      lock.unlock();
      wake();  // wakes callers of busy()
      lock.lock();
    }
    answer.notify_all();
    const bool has_any = wait_for_work(lock);
    if (asked.quit) {
      return;
    }
    if (!has_any) {
      settle(lock);
    } else if (prepared) {
      working = true;
      take_prepared(lock);
    } else if (own.runner && !usable() && !asked.prepare) {
      // Freeing a large factor takes time as well. The next preparation reuses it.
      working = true;
      std::unique_ptr<StepRunner> dropped = std::move(own.runner);
      own.report_due = unsettled = false;
      lock.unlock();
      dropped.reset();
      lock.lock();
    } else {
      working = true;
      answer_next(lock);
    }
  }
}

SolverThread::SolverThread(std::function<void()> wake) : impl_(std::make_unique<Impl>()) {
  impl_->wake = std::move(wake);
  try {
    impl_->thread = std::thread([this] { impl_->run(); });
  } catch (const std::system_error&) {
    throw std::runtime_error("The system allows no more threads: end some programs, or raise the limit (ulimit -u).");
  }
}

SolverThread::~SolverThread() {
  impl_->ask([](Asked& asked) { asked.quit = true; });
  impl_->thread.join();
}

void SolverThread::prepare(PrepareTask task) {
  impl_->ask([&task](Asked& asked) {
    asked.prepare = std::make_unique<PrepareTask>(std::move(task));
    asked.has_region = true;
  });
}

void SolverThread::apply(ApplyTask task) {
  impl_->ask([&task](Asked& asked) { asked.apply = std::make_unique<ApplyTask>(std::move(task)); });
}

void SolverThread::cancel() {
  impl_->ask([](Asked&) {});
}

int SolverThread::solve(const std::vector<HandleMotion>& maps, bool last) {
  int serial = 0;
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->asked.maps = maps;
    impl_->asked.last = last;
    impl_->asked.shown = false;
    impl_->asked.solve = impl_->asked.has_region;
    serial = ++impl_->asked.serial;
    impl_->newest = serial;
    const Clock::time_point now = Clock::now();
    impl_->asked.apart = now - impl_->asked.at;
    impl_->asked.at = now;
  }
  impl_->question.notify_all();
  return serial;
}

SolverNews SolverThread::poll(SolverPose& pose) {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  SolverNews news = std::exchange(impl_->answered.news, SolverNews());
  impl_->answered.has_news = false;
  if (news.pose) {
    std::swap(pose, impl_->answered.pose);
  }
  return news;
}

bool SolverThread::wait() {
  std::unique_lock<std::mutex> lock(impl_->mutex);
  Impl& s = *impl_;
  s.answer.wait(lock, [&s] {
    // The runner may only be read while the worker is idle.
    return s.answered.has_news || (!s.working && !s.unsettled && !s.preparing && !s.asked.prepare && !s.asked.apply &&
                                   !(s.asked.solve && s.usable()));
  });
  return s.answered.has_news;
}

bool SolverThread::busy() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->working || impl_->unsettled || impl_->preparing || impl_->asked.prepare || impl_->asked.apply ||
         impl_->asked.solve || impl_->answered.has_news;
}

double SolverThread::progress() const {
  return impl_->progress;
}

const char* SolverThread::stage() const {
  return impl_->stage;
}

}  // namespace lapedit
