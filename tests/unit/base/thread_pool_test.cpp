// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/thread_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "allocation_watch.h"
#include "base_support.h"
#include "no_threads.h"

namespace lapedit::thread_pool_test {
namespace {

using Pieces = std::vector<std::pair<int, int>>;

/// Whether that comes true; a time limit tells what never will.
template <class What>
bool waited_for(const What& what, std::chrono::milliseconds limit = std::chrono::seconds(20)) {
  const auto start = std::chrono::steady_clock::now();
  while (!what()) {
    if (std::chrono::steady_clock::now() - start > limit) {
      return false;
    }
    std::this_thread::yield();
  }
  return true;
}

/// Whether two threads are at a job at the same time, sooner or later.
bool is_shared(ThreadPool& pool) {
  return waited_for([&] {
    std::atomic<int> arrived{0};
    std::atomic<bool> together{false};
    pool.each(2, [&](int) {
      ++arrived;
      if (waited_for([&] { return arrived == 2; }, std::chrono::milliseconds(100))) {
        together = true;
      }
    });
    return together.load();
  });
}

TEST(ThreadPool, HasAsManyThreadsAsItSays) {
  EXPECT_EQ(ThreadPool(1).threads(), 1);
  EXPECT_EQ(ThreadPool(4).threads(), 4);
  EXPECT_GE(ThreadPool(0).threads(), 1);
  ThreadPool pool(3);
  std::atomic<int> arrived{0}, together{0};  // each piece waits for the others
  pool.each(3, [&](int) {
    ++arrived;
    together += waited_for([&] { return arrived == 3; }) ? 1 : 0;
  });
  EXPECT_EQ(together, 3);
}

TEST(ThreadPool, DoesEachPieceOnceForJobAfterJob) {
  const auto caller = std::this_thread::get_id();
  for (const int threads : {1, 2, 3, 4, 9}) {
    ThreadPool pool(threads);
    std::vector<int> last_job(1000, 0), times(1000, 0);
    std::vector<int> expected(1000, 0);
    std::atomic<long> helped{0};
    for (int job = 1; job <= 3000; ++job) {
      // Few pieces, some of them held up: helpers come late, when the next job is being set up.
      const int pieces = job % 100 == 0 ? 1000 : job % 7;
      pool.each(pieces, [&, job](int piece) {
        if ((piece + job) % 5 == 0) {
          std::this_thread::yield();
        }
        helped += std::this_thread::get_id() != caller ? 1 : 0;
        last_job[piece] = job;
        ++times[piece];
      });
      for (int piece = 0; piece < 1000; ++piece) {
        expected[piece] += piece < pieces ? 1 : 0;
        ASSERT_EQ(times[piece], expected[piece]) << threads << " threads, piece " << piece << " of " << pieces;
        ASSERT_EQ(last_job[piece] == job, piece < pieces) << threads << " threads, piece " << piece;
      }
    }
    EXPECT_EQ(helped > 0, threads > 1) << threads << " threads: otherwise this says nothing";
  }
}

TEST(ThreadPool, WakesUpAfterAPause) {
  ThreadPool pool(2);
  for (int job = 0; job < 20; ++job) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ASSERT_TRUE(is_shared(pool)) << "job " << job;
  }
}

TEST(ThreadPool, NoPieceIsNoCall) {
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    int calls = 0;
    pool.each(0, [&](int) { ++calls; });
    in_pieces(pool, 0, 8, [&](int, int) { ++calls; });
    EXPECT_EQ(calls, 0);
    const auto caller = std::this_thread::get_id();
    int by_caller = 0;
    for (int job = 0; job < 2000; ++job) {
      pool.each(1, [&](int piece) {
        std::this_thread::yield();
        calls += 1 + piece;
        by_caller += std::this_thread::get_id() == caller ? 1 : 0;
      });
    }
    EXPECT_EQ(calls, 2000);
    EXPECT_EQ(by_caller, 2000) << "a single piece is not worth another thread";
  }
}

TEST(ThreadPool, AllocatesNothingPerCall) {
  const long before_all = allocations;
  ThreadPool pool(3);
  ASSERT_GT(allocations.load(), before_all);  // or the count does not count
  // A sanitizer allocates for a thread that starts: all have to be there.
  std::atomic<int> started{0};
  pool.each(pool.threads(), [&](int) {
    for (++started; started < pool.threads();) std::this_thread::yield();
  });
  std::vector<int> seen(100, 0);
  pool.each(100, [&](int piece) { ++seen[piece]; });
  const long before = allocations;
  for (int job = 0; job < 200; ++job) {
    pool.each(100, [&](int piece) { ++seen[piece]; });
    in_pieces(pool, 100, 8, [&](int first, int last) { seen[first] += last > 0 ? 1 : 0; });
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_EQ(seen[99], 201);
}

/// Hangs or crashes if helpers that are starting, working, waiting or asleep are not brought to an end.
TEST(ThreadPool, ComesAndGoesQuickly) {
  for (int round = 0; round < 150; ++round) {
    ThreadPool unused(1 + round % 4);
    auto pool = std::make_unique<ThreadPool>(4);
    std::atomic<int> done{0};
    if (round % 3 > 0) {
      pool->each(round % 3 == 1 ? 2 : 30, [&](int) { ++done; });
      EXPECT_EQ(done, round % 3 == 1 ? 2 : 30);
    }
    if (round % 10 == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

/// The pieces of a range, which cover it without gaps, and have about the size of the grain.
Pieces pieces_of(int threads, int count, int grain) {
  ThreadPool pool(threads);
  Pieces made(static_cast<std::size_t>(count / grain) + 1, {-1, -1});
  in_pieces(pool, count, grain, [&](int first, int last) {
    made[static_cast<std::size_t>(first) / grain] = {first, last};
  });
  made.erase(std::remove(made.begin(), made.end(), std::pair(-1, -1)), made.end());
  int end = 0;
  for (const auto& [first, last] : made) {
    EXPECT_EQ(first, end) << count << " in pieces of " << grain;
    EXPECT_LE(last - first, 2 * grain);
    EXPECT_GE(last - first, std::min(grain, count));
    end = last;
  }
  EXPECT_EQ(end, count);
  return made;
}

TEST(ThreadPool, PiecesCoverTheRangeAndDoNotDependOnTheThreads) {
  for (const int count : {1, 2, 7, 8, 63, 64, 65, 1000, 4099}) {
    for (const int grain : {1, 8, 64, 5000}) {
      const Pieces expected = pieces_of(1, count, grain);
      for (const int threads : {2, 3, 5}) {
        EXPECT_EQ(pieces_of(threads, count, grain), expected) << threads << " threads";
      }
    }
  }
  pieces_of(2, 2000000000, 2000000);  // the product of count and piece is beyond 2^31
}

TEST(ThreadPool, WhatAPieceThrowsReachesTheCallerWhenTheOthersAreDone) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    for (int round = 0; round < 50; ++round) {
      std::atomic<int> done{0};
      try {
        pool.each(20, [&](int piece) {
          if (piece == 7) {
            throw std::runtime_error("seven");
          }
          ++done;
        });
        ADD_FAILURE() << "nothing was thrown";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "seven");
      }
      EXPECT_EQ(done, 19);
      done = 0;
      pool.each(20, [&](int) { ++done; });  // as good as before
      EXPECT_EQ(done, 20);
    }
  }
}

TEST(ThreadPool, CallsTheProgressFunctionOnTheCallersThreadAlone) {
  ThreadPool pool(2), inner(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<int> calls{0};
  std::set<std::string> stages;
  const Progress progress = [&](double fraction, const char* stage) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_GE(fraction, 0.25);
    stages.insert(stage);
    ++calls;
    return true;
  };
  const ProgressScope scope(progress);
  report_progress(0.25, "whole");
  std::atomic<bool> helped{false};
  pool.each(2, [&](int) {
    if (std::this_thread::get_id() == caller) {
      waited_for([&] { return helped.load(); });
      return;
    }
    helped = true;
    report_progress(0.5, "helper");
    inner.each(2, [&](int) {
      const int before = calls;
      EXPECT_TRUE(waited_for([&] {
        checkpoint();
        return calls > before;
      }));
    });
  });
  EXPECT_TRUE(helped);
  EXPECT_EQ(stages.count("helper"), 1U);
}

TEST(ThreadPool, CancellationEndsThePiecesOfAllThreads) {
  for (const bool throws : {false, true}) {
    for (const int threads : {1, 2, 4}) {
      ThreadPool pool(threads);
      int calls = 0;
      const Progress progress = [&](double, const char*) {
        if (++calls == 3 && throws) {
          throw std::runtime_error("a host's own");
        }
        return calls < 3;
      };
      const ProgressScope scope(progress);
      std::atomic<int> begun{0};
      support::expect_refusal(ErrorCause::Cancelled, [&] {
        pool.each(100, [&](int) {
          ++begun;
          waited_for([] {
            checkpoint();
            return false;
          });
        });
      });
      EXPECT_LE(begun, threads);
      EXPECT_EQ(calls, 3);
      support::expect_refusal(ErrorCause::Cancelled, [&] { pool.each(1, [&](int) { ++calls; }); });
      EXPECT_EQ(calls, 3);
    }
  }
}

TEST(Progress, ScopesAreNestedAndEmptyOnesKeepTheOuter) {
  std::vector<std::string> heard;
  const Progress outer = [&heard](double fraction, const char* stage) {
    heard.push_back(std::string(stage) + (fraction == 0.75 ? " 0.75" : ""));
    checkpoint();
    return true;
  };
  const Progress empty, stop = [](double, const char*) { return false; };
  checkpoint();
  {
    const ProgressScope scope(outer);
    const ProgressScope same(empty);
    {
      const ProgressPart part(1, 2), of_part(0, 2);
      report_progress(1, "first");
    }
    report_progress(0.5, "second");  // fractions do not fall
    {
      const ProgressScope inner(stop);
      support::expect_refusal(ErrorCause::Cancelled, [] { checkpoint(); });
    }
    checkpoint(kWorkPerCall - 1);
    EXPECT_EQ(heard.size(), 2U);
    Checkpoints checkpoints;
    for (int k = 0; k < kWorkPerCall; ++k) {
      checkpoints();
    }
  }
  checkpoint();
  EXPECT_EQ(heard, (std::vector<std::string>{"first 0.75", "second 0.75", "second 0.75"}));
}

/// A helper that gets no processor: fails if anything but the piece that it is at waits for it.
TEST(ThreadPool, HelperThatIsHeldUpHoldsUpNothingButItsPiece) {
  constexpr int kPieces = 100;
  ThreadPool pool(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<int> done{0};
  std::atomic<bool> helped{false}, others_done{false};
  pool.each(kPieces, [&](int) {
    if (std::this_thread::get_id() == caller) {
      waited_for([&] { return helped.load(); });
    } else {
      helped = true;
      others_done = waited_for([&] { return done == kPieces - 1; });
    }
    ++done;
  });
  EXPECT_TRUE(helped);
  EXPECT_TRUE(others_done);
}

/// Fails if who waits computes, or yields, instead of sleeping: compared with sleeping that costs other threads
/// processor time.
TEST(ThreadPool, WaitingTakesNoProcessorTime) {
  ThreadPool pool(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> helped{false};
  const std::clock_t before = std::clock();  // of all threads
  pool.each(2, [&](int) {
    if (std::this_thread::get_id() == caller) {
      while (!helped) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    } else {
      helped = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(600));
    }
  });
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 0.05) << "of 0.6 that it waited";
}

#ifdef LAPEDIT_HAVE_NO_THREADS
/// Fails if it ends, or waits for threads that there are not.
TEST(ThreadPool, MakesDoWithTheThreadsThatItCanHave) {
  auto none = std::make_unique<support::NoThreads>();
  ThreadPool pool(4);
  none.reset();
  EXPECT_EQ(pool.threads(), 1);
  int done = 0;
  pool.each(10, [&](int) { ++done; });
  EXPECT_EQ(done, 10);
}
#endif

}  // namespace
}  // namespace lapedit::thread_pool_test
