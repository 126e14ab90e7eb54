// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "lapedit/base/compiler.h"
#include "lapedit/base/progress.h"

namespace lapedit {

/// Lets threads wait for each other: they spin for a moment, then sleep. They do not yield, which would give a whole
/// time slice to another process although the awaited work takes microseconds.
class Gate {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns when ready() is true; ready() reads atomics and is called often.
  /// @param limit  0: none; otherwise it returns about after this time in any case
  template <class Ready>
  void wait(const Ready& ready, Clock::duration limit = {}) {
    // About the cost of waking a sleeping thread.
    constexpr std::chrono::microseconds kPatience{50};
    constexpr int kLooks = 32;
    const Clock::time_point start = Clock::now();
    Clock::time_point now = start;
    do {
      for (int look = 0; look < kLooks; ++look) {
        if (ready()) {
          return;
        }
        pause_processor();
      }
      now = Clock::now();
    } while (now - start < kPatience);
    std::unique_lock<std::mutex> lock(mutex_);
    ++asleep_;  // Before ready() is called, so that open() in another thread sees it: prevents a lost wake-up.
    if (limit > Clock::duration()) {
      wake_.wait_for(lock, limit, ready);
    } else {
      wake_.wait(lock, ready);
    }
    --asleep_;
  }

  /// Wakes sleeping threads. Callers call it after each change that may make a thread ready. Costs one atomic read
  /// while no thread sleeps.
  void open() {
    if (asleep_.load() > 0) {
      { const std::lock_guard<std::mutex> lock(mutex_); }
      wake_.notify_all();
    }
  }

 private:
  std::atomic<int> asleep_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
};

/// Returns the number of threads to use for a requested number (0: all of the machine's), within the limit.
int thread_count(int threads);

/// Limits thread_count() in the whole process from now on, for one of several processes that share a machine.
void limit_threads(int most);

/// Divides loops among helper threads that live as long as the pool. A call starts no thread and allocates nothing, so
/// the pool suits repeated work of fractions of a millisecond. Each idle thread takes the next piece, so a thread that
/// loses its processor delays one piece only.
///
/// Helpers work for the ProgressScope of the caller. Only the caller's thread calls the progress function, also while
/// it waits for helpers; after a cancellation no further piece begins.
class ThreadPool {
 public:
  /// If the system refuses threads there are fewer, at worst only the caller's own.
  /// @param threads  0: as many as the machine has; 1: only the caller's own
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const { return 1 + static_cast<int>(helpers_.size()); }

  /// Calls work(piece) once for each piece of [0, pieces), and returns when all are done. One caller at a time. Which
  /// thread gets which piece is not determined, and one may get all. An exception of a piece is rethrown to the caller
  /// when all other pieces are done; if several pieces throw, one of the exceptions is.
  template <class Work>
  void each(int pieces, const Work& work) {
    run(
        pieces, [](const void* context, int piece) { (*static_cast<const Work*>(context))(piece); }, &work);
  }

  /// Waits as Gate::wait() does, for pieces that depend on each other.
  /// @throws EditError (Cancelled)
  template <class Ready>
  void wait(Gate& gate, const Ready& ready) {
    constexpr std::chrono::milliseconds kBetweenCalls{5};
    const bool may_end = ProgressScope::current() != nullptr;
    do {
      gate.wait(ready, may_end ? kBetweenCalls : Gate::Clock::duration());
      checkpoint(may_end && !ready() ? kWorkPerCall : 0);
    } while (!ready());
  }

 private:
  using Function = void (*)(const void*, int);
  void run(int pieces, Function function, const void* context);
  void rethrow();
  bool take(std::uint64_t number, int& piece);
  void work(Function function, const void* context, int piece) noexcept;
  void keep_error() noexcept;
  bool has_pieces() const;
  void help();

  // A job's number (upper half) and its next piece (lower half) change together, so that a piece taken belongs to the
  // job whose function is read after.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<int> pieces_{0};
  std::atomic<int> done_{0};
  std::atomic<Function> function_{nullptr};
  std::atomic<const void*> context_{nullptr};
  std::atomic<ProgressScope*> scope_{nullptr};
  std::atomic<bool> quit_{false};
  Gate for_work_, for_the_end_;
  std::mutex mutex_;
  std::exception_ptr error_;  // guarded by mutex_ until all pieces are done
  std::vector<std::thread> helpers_;
};

/// Calls body(first, last) on pieces of [0, count) of about grain; the pieces do not depend on the number of threads.
/// If the body writes only results of its own indices, neither do the results.
template <class Body>
void in_pieces(ThreadPool& pool, int count, int grain, const Body& body) {
  const int pieces = count / grain > 0 ? count / grain : (count > 0 ? 1 : 0);
  pool.each(pieces, [&](int piece) {
    const auto first = static_cast<int>(static_cast<std::int64_t>(count) * piece / pieces);
    const auto last = static_cast<int>(static_cast<std::int64_t>(count) * (piece + 1) / pieces);
    body(first, last);
    checkpoint(last - first);
  });
}

/// Calls body(index) for each index of [0, count), in such pieces.
template <class Body>
void for_indices(ThreadPool& pool, int count, int grain, const Body& body) {
  in_pieces(pool, count, grain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      body(i);
    }
  });
}

/// Calls body(chunk, first, last) for `chunks` chunks of [0, count), whose number does not depend on that of threads,
/// so that sums have a fixed order.
template <class Body>
void in_chunks(ThreadPool& pool, int chunks, std::int64_t count, const Body& body) {
  pool.each(chunks, [&](int chunk) {
    body(chunk, count * chunk / chunks, count * (chunk + 1) / chunks);
    checkpoint(static_cast<int>(count / chunks));
  });
}

}  // namespace lapedit
