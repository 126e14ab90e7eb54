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

}  // namespace

struct SolverThread::State {
  std::function<void()> wake;
  mutable std::mutex mutex;
  std::condition_variable asked;     // for the worker
  std::condition_variable answered;  // for wait()
  std::thread thread;

  // Guarded by mutex.
  bool quit = false;
  std::unique_ptr<PrepareTask> to_prepare;
  std::unique_ptr<ApplyTask> to_apply;
  std::vector<Affine> maps;  // of the newest solve
  int serial = 0;
  Clock::time_point asked_at;  // the newest solve
  Clock::duration apart{};     // from the one before
  bool last = false;
  bool to_solve = false;
  bool has_region = false;  // prepared, or still to be
  bool working = false;
  bool has_news = false;
  SolverNews news;
  SolverPose front;

  std::atomic<int> newest{0};          // serial, for a solve at work to look at
  std::atomic<bool> unsettled{false};  // the last pose was a preview, and is still to be solved for in full
  std::atomic<int> generation{0};      // counts what drops all that was asked before
  std::atomic<double> progress{0};
  std::atomic<const char*> stage{""};

  // The worker's own.
  std::unique_ptr<LaplacianEditor> editor;
  int editor_generation = -1;
  StoredScalar scalar = StoredScalar::Float;
  double region_ms = 0;
  bool report_due = false;
  bool unsettled_here = false;  // as unsettled, but not for others to change
  std::vector<Affine> current_maps;
  int current_serial = 0;
  SolverPose back;

  void drop();
  void run();
  Progress progress_of(int mine);
  void do_prepare(const PrepareTask& task, int mine);
  void do_apply(const ApplyTask& task, int mine);
  enum class Answer {
    Preview,  // a picture of a drag: may be off by what nobody sees
    Full,     // as a release would leave it
    Last      // the same with its report
  };
  void do_solve(int mine, Answer answer);
  std::shared_ptr<const EditReport> make_report() const;
  template <class Change>
  void publish(int mine, const Change& change);
};

/// Under the mutex: nothing asked before counts any more.
void SolverThread::State::drop() {
  ++generation;
  to_prepare.reset();
  to_apply.reset();
  to_solve = has_region = false;
  unsettled = false;
  news = SolverNews();
  has_news = false;
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
    has_news = true;
  }
  answered.notify_all();
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

void SolverThread::State::do_prepare(const PrepareTask& task, int mine) {
  const Stopwatch watch;
  const Progress go_on = progress_of(mine);
  go_on(0, "region");
  Region region = build_region(*task.mesh, *task.adjacency, task.region, task.groups);
  region_ms = watch.elapsed();
  const auto shown = std::make_shared<const Region>(region);
  publish(mine, [&] { news.region = shown; });
  editor = std::make_unique<LaplacianEditor>(*task.mesh, std::move(region), task.settings, go_on, std::move(editor));
  editor_generation = mine;
  scalar = task.scalar;
  report_due = unsettled = false;
  const double prepare_ms = watch.elapsed();
  publish(mine, [&] {
    news.ready = true;
    news.prepare_ms = prepare_ms;
  });
}

void SolverThread::State::do_apply(const ApplyTask& task, int mine) {
  const Progress go_on = progress_of(mine);
  require_same_mesh(*task.mesh, task.edit);
  auto results = std::make_shared<std::vector<EditResult>>();
  apply_steps(*task.mesh, *task.adjacency, task.edit, 1, task.scalar, go_on,
              [&results](EditResult&& result) { results->push_back(std::move(result)); });
  publish(mine, [&] { news.applied = results; });
}

std::shared_ptr<const EditReport> SolverThread::State::make_report() const {
  auto report = std::make_shared<EditReport>(editor->report());
  report->region_ms = region_ms;
  return report;
}

void SolverThread::State::do_solve(int mine, Answer answer) {
  const Stopwatch watch;
  back.serial = current_serial;
  const auto go_on = [this, mine](double, const char*) { return generation == mine && newest == current_serial; };
  back.positions = answer == Answer::Preview ? editor->preview(current_maps)
                   : answer == Answer::Full  ? editor->solve(current_maps, Affine::Identity(), go_on)
                                             : editor->solve(current_maps);
  round_to(scalar, back.positions);
  back.solve_ms = watch.elapsed();
  const auto report = answer == Answer::Last ? make_report() : nullptr;
  report_due = answer != Answer::Last;
  unsettled = unsettled_here = answer == Answer::Preview && editor->has_preview();
  publish(mine, [&] {
    std::swap(front, back);
    news.pose = true;
    news.report = report ? report : news.report;
  });
}

void SolverThread::State::run() {
  std::unique_lock<std::mutex> lock(mutex);
  while (true) {
    const auto usable = [this] { return editor && editor_generation == generation; };
    const auto has_work = [this, &usable] {
      return quit || to_prepare || to_apply || (editor && !usable()) || (to_solve && usable());
    };
    if (std::exchange(working, false) && wake) {
      lock.unlock();
      wake();  // whoever asks busy() now learns that it is over
      lock.lock();
    }
    answered.notify_all();
    if (report_due && usable()) {
      const Clock::duration pause = std::clamp<Clock::duration>(2 * apart, kPause, kLongestPause);
      if (!asked.wait_for(lock, pause, has_work)) {
        // First the pose in full, then, after another pause, what there is to report on it.
        const int mine = generation;
        const bool settle = std::exchange(unsettled_here, false);
        report_due = settle;
        bool failed = false;
        lock.unlock();
        try {
          if (settle) {
            do_solve(mine, Answer::Full);
          } else {
            const auto report = make_report();
            publish(mine, [&] { news.report = report; });
          }
        } catch (const std::exception&) {
          report_due = false;  // the preview has said what there is to say, or the mouse goes on
          failed = true;
        }
        unsettled = false;
        lock.lock();
        working = failed;  // nothing was published, but whoever asks busy() is to learn that it is over
        continue;
      }
    } else {
      asked.wait(lock, has_work);
    }
    if (quit) {
      return;
    }
    working = true;
    if (editor && !usable() && !to_prepare) {
      // Freeing a large factor takes its time, too. What is prepared next goes on from it.
      const std::unique_ptr<LaplacianEditor> dropped = std::move(editor);
      report_due = unsettled = false;
      lock.unlock();
    }
    if (!lock.owns_lock()) {
      lock.lock();
      continue;
    }
    const int mine = generation;
    const std::unique_ptr<PrepareTask> prepare_task = std::move(to_prepare);
    const std::unique_ptr<ApplyTask> apply_task = std::move(to_apply);
    const bool solving = !prepare_task && !apply_task;
    const Answer answer = last ? Answer::Last : Answer::Preview;
    if (solving) {
      current_maps = maps;
      current_serial = serial;
      to_solve = false;
    }
    lock.unlock();
    std::string error;
    try {
      if (prepare_task) {
        do_prepare(*prepare_task, mine);
      } else if (apply_task) {
        do_apply(*apply_task, mine);
      } else {
        do_solve(mine, answer);
      }
    } catch (const std::bad_alloc&) {
      error = "There is not enough memory for this region: choose a smaller one.";
    } catch (const std::exception& exception) {
      error = exception.what();
    }
    if (!error.empty()) {
      publish(mine, [&] { (solving ? news.pose_error : news.error) = error; });
    }
    lock.lock();
    if (!error.empty() && !solving && generation == mine) {
      to_solve = has_region = false;
    }
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
    state_->quit = true;
  }
  state_->asked.notify_all();
  state_->thread.join();
}

void SolverThread::prepare(PrepareTask task) {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
    state_->to_prepare = std::make_unique<PrepareTask>(std::move(task));
    state_->has_region = true;
  }
  state_->asked.notify_all();
}

void SolverThread::apply(ApplyTask task) {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
    state_->to_apply = std::make_unique<ApplyTask>(std::move(task));
  }
  state_->asked.notify_all();
}

void SolverThread::cancel() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->drop();
  }
  state_->asked.notify_all();
}

int SolverThread::solve(const std::vector<Affine>& maps, bool last) {
  int serial = 0;
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->maps = maps;
    state_->last = last;
    state_->to_solve = state_->has_region;
    serial = ++state_->serial;
    state_->newest = serial;
    const Clock::time_point now = Clock::now();
    state_->apart = now - state_->asked_at;
    state_->asked_at = now;
  }
  state_->asked.notify_all();
  return serial;
}

SolverNews SolverThread::poll(SolverPose& pose) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  SolverNews news = std::exchange(state_->news, SolverNews());
  state_->has_news = false;
  if (news.pose) {
    std::swap(pose, state_->front);
  }
  return news;
}

bool SolverThread::wait() {
  std::unique_lock<std::mutex> lock(state_->mutex);
  State& s = *state_;
  s.answered.wait(lock, [&s] {
    // The editor may be looked at while the worker is not at work only.
    return s.has_news || (!s.working && !s.unsettled && !s.to_prepare && !s.to_apply &&
                          !(s.to_solve && s.editor && s.editor_generation == s.generation));
  });
  return s.has_news;
}

bool SolverThread::busy() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->working || state_->unsettled || state_->to_prepare || state_->to_apply || state_->to_solve ||
         state_->has_news;
}

double SolverThread::progress() const {
  return state_->progress;
}

const char* SolverThread::stage() const {
  return state_->stage;
}

}  // namespace lapedit
