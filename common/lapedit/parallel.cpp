// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/parallel.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

namespace lapedit {

int thread_count(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(int count, int grain, int threads, const std::function<void(int, int)>& body) {
  const int pieces = std::min(thread_count(threads), std::max(1, count / std::max(1, grain)));
  if (pieces <= 1) {
    if (count > 0) {
      body(0, count);
    }
    return;
  }
  auto start = [count, pieces](int piece) { return static_cast<int>(static_cast<long long>(count) * piece / pieces); };
  std::vector<std::exception_ptr> errors(pieces);
  auto work = [&](int piece) {
    try {
      body(start(piece), start(piece + 1));
    } catch (...) {
      errors[piece] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (int piece = 1; piece < pieces; ++piece) {
    others.emplace_back(work, piece);
  }
  work(0);
  for (std::thread& other : others) {
    other.join();
  }
  for (const std::exception_ptr& error : errors) {
    if (error) {
      std::rethrow_exception(error);
    }
  }
}

}  // namespace lapedit
