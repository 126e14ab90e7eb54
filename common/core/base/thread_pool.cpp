// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/thread_pool.h"

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>

namespace lapedit {
namespace {

std::atomic<int> most_threads{std::numeric_limits<int>::max()};

constexpr std::uint64_t number_of(std::uint64_t ticket) {
  return ticket >> 32;
}
constexpr int piece_of(std::uint64_t ticket) {
  return static_cast<int>(ticket & 0xffffffffU);
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
  try {
    for (int i = 0; i < helpers; ++i) {
      helpers_.emplace_back([this] { help(); });
    }
  } catch (const std::exception&) {
    // If the system refuses a thread (no memory for its stack, no permission), the pool works with those that it has.
  }
}

ThreadPool::~ThreadPool() {
  quit_ = true;
  for_work_.open();
  for (std::thread& helper : helpers_) {
    helper.join();
  }
}

/// Takes the next piece of a job, if there is one.
bool ThreadPool::take(std::uint64_t number, int& piece) {
  std::uint64_t ticket = ticket_.load();
  // If pieces_ already belongs to another job, the exchange fails.
  while (number_of(ticket) == number && piece_of(ticket) < pieces_.load()) {
    if (ticket_.compare_exchange_weak(ticket, ticket + 1)) {
      piece = piece_of(ticket);
      return true;
    }
  }
  return false;
}

bool ThreadPool::has_pieces() const {
  return piece_of(ticket_.load()) < pieces_.load();
}

void ThreadPool::work(Function function, const void* context, int piece) noexcept {
  try {
    checkpoint(0);
    function(context, piece);
  } catch (...) {
    keep_error();
  }
}

void ThreadPool::keep_error() noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  error_ = std::current_exception();
}

void ThreadPool::run(int pieces, Function function, const void* context) {
  if (helpers_.empty() || pieces <= 1) {
    for (int piece = 0; piece < pieces; ++piece) {
      work(function, context, piece);
    }
    rethrow();
    return;
  }
  const std::uint64_t number = number_of(ticket_.load()) + 1;
  pieces_ = 0;  // no thread takes a piece until all members are set
  ticket_ = number << 32;
  done_ = 0;
  function_ = function;
  context_ = context;
  scope_ = ProgressScope::current();
  pieces_ = pieces;
  for_work_.open();
  int piece = 0;
  while (take(number, piece)) {
    work(function, context, piece);
    ++done_;
  }
  while (done_.load() < pieces) {
    try {
      wait(for_the_end_, [&] { return done_.load() == pieces; });
    } catch (...) {
      keep_error();  // Helpers still use what belongs to the caller.
    }
  }
  rethrow();
}

void ThreadPool::rethrow() {
  if (error_) {
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
}

void ThreadPool::help() {
  while (!quit_) {
    const std::uint64_t number = number_of(ticket_.load());
    int piece = 0;
    if (take(number, piece)) {
      do {
        ProgressScope::work_for(scope_.load());
        work(function_.load(), context_.load(), piece);
        // The caller may have begun another job before the piece is counted.
        if (++done_ == pieces_.load()) {
          for_the_end_.open();
        }
      } while (take(number, piece));
      ProgressScope::work_for(nullptr);
    } else {
      for_work_.wait([this] { return quit_ || has_pieces(); });
    }
  }
}

}  // namespace lapedit
