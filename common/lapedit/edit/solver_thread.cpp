// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/solver_thread.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/stopwatch.h"

namespace lapedit {
namespace {

using Clock = std::chrono::steady_clock;

/// After this long without a question, and twice as long as the last two were apart, the last one is answered in full,
/// and reported on.
constexpr std::chrono::milliseconds kPause{50}, kLongestPause{1000};

/// What the window wants.
struct Asked {
  bool quit = false;
  std::unique_ptr<PrepareTask> prepare;
  std::unique_ptr<ApplyTask> apply;
  bool has_region = false;  ///< prepared, or still to be
  bool solve = false;
  std::vector<Affine> maps;  ///< of the newest solve, with what follows
  bool last = false;
  int serial = 0;
  Clock::time_point at;
  Clock::duration apart{};  ///< from the one before
};

/// What the window has not taken yet.
struct Answered {
  bool has_news = false;
  SolverNews news;
  SolverPose pose;
};

/// The thread's own.
struct AtWork {
  std::unique_ptr<StepRunner> runner;
  int generation = -1;  ///< of the runner
  std::vector<Affine> maps;
  int serial = 0;
  SolverPose pose;
  bool preview = false;     ///< the last pose was one, and is still to be solved for in full
  bool report_due = false;  ///< the last pose has no report yet
};

enum class Answer {
  Preview,  ///< a picture of a drag: may be off by what nobody sees
  Full,     ///< as a release would leave it
  Last      ///< the same with its report
};

}  // namespace

struct SolverThread::State {
  std::function<void()> wake;
  mutable std::mutex mutex;
  std::condition_variable question;  // for the thread
  std::condition_variable answer;    // for wait()
  std::thread thread;

  // Guarded by mutex.
  Asked asked;
  Answered answered;
  bool working = false;

  std::atomic<int> newest{0};          // serial, for a solve at work to look at
  std::atomic<bool> unsettled{false};  // the last pose was a preview, and is still to be solved for in full
  std::atomic<int> generation{0};      // counts what drops all that was asked before
  std::atomic<double> progress{0};
  std::atomic<const char*> stage{""};

  AtWork own;

  void drop();
  void run();
  bool usable() const { return own.runner && own.generation == generation; }
  bool has_work() const {
    return asked.quit || asked.prepare || asked.apply || (own.runner && !usable()) || (asked.solve && usable());
  }
  bool wait_for_work(std::unique_lock<std::mutex>& lock);
  void settle(std::unique_lock<std::mutex>& lock);
  void answer_next(std::unique_lock<std::mutex>& lock);
  Progress progress_of(int mine);
  void prepare(const PrepareTask& task, int mine);
  void apply(const ApplyTask& task, int mine);
  void solve(int mine, Answer kind);
  template <class Change>
  void publish(int mine, const Change& change);
};

/// Under the mutex: nothing asked before counts any more.
void SolverThread::State::drop() {
  ++generation;
  asked.prepare.reset();
  asked.apply.reset();
  asked.solve = asked.has_region = false;
  unsettled = false;
  answered.news = SolverNews();
  answered.has_news = false;
  progress = 0;
  stage = "";
}

template <class Change>
void SolverThread::State::publish(int mine, const Change& change) {
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

Progress SolverThread::State::progress_of(int mine) {
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

void SolverThread::State::prepare(const PrepareTask& task, int mine) {
  const Stopwatch watch;
  const auto show = [this, mine](const Region& region) {
    const auto shown = std::make_shared<const Region>(region);
    publish(mine, [&] { answered.news.region = shown; });
  };
  own.runner = std::make_unique<StepRunner>(
      StepProblem{*task.mesh, *task.adjacency, task.region, task.groups, task.settings, task.scalar}, progress_of(mine),
      show, std::move(own.runner));
  own.generation = mine;
  own.report_due = unsettled = false;
  const double prepare_ms = watch.elapsed();
  publish(mine, [&] {
    answered.news.ready = true;
    answered.news.prepare_ms = prepare_ms;
  });
}

void SolverThread::State::apply(const ApplyTask& task, int mine) {
  require_same_mesh(*task.mesh, task.edit);
  auto results = std::make_shared<std::vector<EditResult>>();
  apply_steps(*task.mesh, *task.adjacency, task.edit, 1, task.scalar, progress_of(mine),
              [&results](EditResult&& result) { results->push_back(std::move(result)); });
  publish(mine, [&] { answered.news.applied = results; });
}

void SolverThread::State::solve(int mine, Answer kind) {
  const Stopwatch watch;
  own.pose.serial = own.serial;
  const auto go_on = [this, mine](double, const char*) { return generation == mine && newest == own.serial; };
  if (kind == Answer::Preview) {
    own.runner->preview(own.maps, own.pose.positions);
  } else {
    own.runner->solve(own.maps, own.pose.positions, kind == Answer::Full ? Progress(go_on) : Progress());
  }
  own.pose.solve_ms = watch.elapsed();
  const auto report = kind == Answer::Last ? std::make_shared<const EditReport>(own.runner->report()) : nullptr;
  own.report_due = kind != Answer::Last;
  unsettled = own.preview = kind == Answer::Preview && own.runner->has_preview();
  publish(mine, [&] {
    std::swap(answered.pose, own.pose);
    answered.news.pose = true;
    answered.news.report = report ? report : answered.news.report;
  });
}

/// Until there is something to do. @return false if the mouse has paused: the last pose is to be settled
bool SolverThread::State::wait_for_work(std::unique_lock<std::mutex>& lock) {
  if (own.report_due && usable()) {
    const Clock::duration pause = std::clamp<Clock::duration>(2 * asked.apart, kPause, kLongestPause);
    return question.wait_for(lock, pause, [this] { return has_work(); });
  }
  question.wait(lock, [this] { return has_work(); });
  return true;
}

/// First the pose in full, then, after another pause, what there is to report on it.
void SolverThread::State::settle(std::unique_lock<std::mutex>& lock) {
  const int mine = generation;
  const bool in_full = std::exchange(own.preview, false);
  own.report_due = in_full;
  bool failed = false;
  lock.unlock();
  try {
    if (in_full) {
      solve(mine, Answer::Full);
    } else {
      const auto report = std::make_shared<const EditReport>(own.runner->report());
      publish(mine, [&] { answered.news.report = report; });
    }
  } catch (const std::exception&) {
    own.report_due = false;  // the preview has said what there is to say, or the mouse goes on
    failed = true;
  }
  unsettled = false;
  lock.lock();
  working = failed;  // nothing was published, but whoever asks busy() is to learn that it is over
}

void SolverThread::State::answer_next(std::unique_lock<std::mutex>& lock) {
  const int mine = generation;
  const std::unique_ptr<PrepareTask> prepare_task = std::move(asked.prepare);
  const std::unique_ptr<ApplyTask> apply_task = std::move(asked.apply);
  const bool solving = !prepare_task && !apply_task;
  const Answer kind = asked.last ? Answer::Last : Answer::Preview;
  if (solving) {
    own.maps = asked.maps;
    own.serial = asked.serial;
    asked.solve = false;
  }
  lock.unlock();
  std::string error;
  try {
    if (prepare_task) {
      prepare(*prepare_task, mine);
    } else if (apply_task) {
      apply(*apply_task, mine);
    } else {
      solve(mine, kind);
    }
  } catch (const std::bad_alloc&) {
    error = "There is not enough memory for this region: choose a smaller one.";
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

void SolverThread::State::run() {
  std::unique_lock<std::mutex> lock(mutex);
  while (true) {
    if (std::exchange(working, false) && wake) {
      lock.unlock();
      wake();  // whoever asks busy() now learns that it is over
      lock.lock();
    }
    answer.notify_all();
    if (!wait_for_work(lock)) {
      settle(lock);
      continue;
    }
    if (asked.quit) {
      return;
    }
    working = true;
    if (own.runner && !usable() && !asked.prepare) {
      // Freeing a large factor takes its time, too. What is prepared next goes on from it.
      std::unique_ptr<StepRunner> dropped = std::move(own.runner);
      own.report_due = unsettled = false;
      lock.unlock();
      dropped.reset();
      lock.lock();
      continue;
    }
    answer_next(lock);
  }
}

SolverThread::SolverThread(std::function<void()> wake) : state_(std::make_unique<State>()) {
  state_->wake = std::move(wake);
  state_->thread = std::thread([this] { state_->run(); });
}

SolverThread::~SolverThread() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
    state_->asked.quit = true;
  }
  state_->question.notify_all();
  state_->thread.join();
}

void SolverThread::prepare(PrepareTask task) {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
    state_->asked.prepare = std::make_unique<PrepareTask>(std::move(task));
    state_->asked.has_region = true;
  }
  state_->question.notify_all();
}

void SolverThread::apply(ApplyTask task) {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
    state_->asked.apply = std::make_unique<ApplyTask>(std::move(task));
  }
  state_->question.notify_all();
}

void SolverThread::cancel() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
  }
  state_->question.notify_all();
}

int SolverThread::solve(const std::vector<Affine>& maps, bool last) {
  int serial = 0;
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->asked.maps = maps;
    state_->asked.last = last;
    state_->asked.solve = state_->asked.has_region;
    serial = ++state_->asked.serial;
    state_->newest = serial;
    const Clock::time_point now = Clock::now();
    state_->asked.apart = now - state_->asked.at;
    state_->asked.at = now;
  }
  state_->question.notify_all();
  return serial;
}

SolverNews SolverThread::poll(SolverPose& pose) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  SolverNews news = std::exchange(state_->answered.news, SolverNews());
  state_->answered.has_news = false;
  if (news.pose) {
    std::swap(pose, state_->answered.pose);
  }
  return news;
}

bool SolverThread::wait() {
  std::unique_lock<std::mutex> lock(state_->mutex);
  State& s = *state_;
  s.answer.wait(lock, [&s] {
    // The runner may be looked at while the worker is not at work only.
    return s.answered.has_news ||
           (!s.working && !s.unsettled && !s.asked.prepare && !s.asked.apply && !(s.asked.solve && s.usable()));
  });
  return s.answered.has_news;
}

bool SolverThread::busy() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->working || state_->unsettled || state_->asked.prepare || state_->asked.apply || state_->asked.solve ||
         state_->answered.has_news;
}

double SolverThread::progress() const {
  return state_->progress;
}

const char* SolverThread::stage() const {
  return state_->stage;
}

}  // namespace lapedit
