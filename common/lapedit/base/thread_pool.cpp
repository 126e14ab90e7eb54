// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/thread_pool.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace lapedit {
namespace {

using Clock = std::chrono::steady_clock;

/// Waking a sleeper costs about as much as this: a helper looks for the next stage of the same frame for so long.
constexpr std::chrono::microseconds kPatience{60};

std::atomic<int> most_threads{std::numeric_limits<int>::max()};

constexpr std::uint64_t number_of(std::uint64_t ticket) {
  return ticket >> 32;
}

}  // namespace

int thread_count(int threads) {
  const int wanted = threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min(wanted, most_threads.load());
}

void limit_threads(int most) {
  most_threads = std::max(1, most);
}

ThreadPool::ThreadPool(int threads) {
  const int helpers = thread_count(threads) - 1;
  helpers_.reserve(helpers);
  for (int i = 0; i < helpers; ++i) {
    helpers_.emplace_back([this] { help(); });
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    quit_ = true;
  }
  wake_.notify_all();
  for (std::thread& helper : helpers_) {
    helper.join();
  }
}

/// Takes the next piece of a job, if it has one.
bool ThreadPool::take(std::uint64_t number, int& piece) {
  std::uint64_t ticket = ticket_.load();
  // Of another job's ticket the count may be another's as well; the exchange then fails.
  while (number_of(ticket) == number && static_cast<int>(ticket & 0xffffffffU) < pieces_.load()) {
    if (ticket_.compare_exchange_weak(ticket, ticket + 1)) {
      piece = static_cast<int>(ticket & 0xffffffffU);
      return true;
    }
  }
  return false;
}

void ThreadPool::work(Function function, const void* context, int piece) noexcept {
  try {
    function(context, piece);
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    error_ = std::current_exception();
  }
}

void ThreadPool::run(int pieces, Function function, const void* context) {
  if (helpers_.empty() || pieces <= 1) {
    for (int piece = 0; piece < pieces; ++piece) {
      function(context, piece);
    }
    return;
  }
  const std::uint64_t number = number_of(ticket_.load()) + 1;
  pieces_ = 0;  // nobody takes a piece until all is in place
  ticket_ = number << 32;
  done_ = 0;
  function_ = function;
  context_ = context;
  pieces_ = pieces;
  if (asleep_.load() > 0) {
    { const std::lock_guard<std::mutex> lock(mutex_); }
    wake_.notify_all();
  }
  int piece = 0;
  while (take(number, piece)) {
    work(function, context, piece);
    ++done_;
  }
  while (done_.load() < pieces) {
    std::this_thread::yield();
  }
  if (error_) {
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
}

void ThreadPool::help() {
  Clock::time_point idle_since = Clock::now();
  while (!quit_) {
    int piece = 0;
    bool worked = false;
    while (take(number_of(ticket_.load()), piece)) {
      work(function_.load(), context_.load(), piece);
      ++done_;
      worked = true;
    }
    if (worked) {
      idle_since = Clock::now();
    } else if (Clock::now() - idle_since < kPatience) {
      std::this_thread::yield();
    } else {
      std::unique_lock<std::mutex> lock(mutex_);
      ++asleep_;
      wake_.wait(lock, [this] { return quit_ || static_cast<int>(ticket_.load() & 0xffffffffU) < pieces_.load(); });
      --asleep_;
      idle_since = Clock::now();
    }
  }
}

}  // namespace lapedit
