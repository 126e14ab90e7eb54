// SPDX-License-Identifier: GPL-3.0-or-later
#include "bandwidth.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

namespace speed {
namespace {

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
// The bound is the memory's, so the sum may use what the machine has.
__attribute__((target_clones("default", "avx2", "avx512f")))
#endif
double
sum(const double* data, std::size_t count) {
  constexpr std::size_t kLanes = 32;
  double lanes[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      lanes[k] += data[i + k];
    }
  }
  double result = 0;
  for (const double lane : lanes) {
    result += lane;
  }
  for (; i < count; ++i) {
    result += data[i];
  }
  return result;
}

}  // namespace

double Bandwidth::seconds(int threads) {
  constexpr int kBestOf = 3;
  const auto share = [this, threads](int t) {
    const std::size_t first = data_.size() * static_cast<std::size_t>(t) / static_cast<std::size_t>(threads);
    const std::size_t last = data_.size() * static_cast<std::size_t>(t + 1) / static_cast<std::size_t>(threads);
    double total = 0;
    for (int pass = 0; pass < 2; ++pass) {
      benchmark::ClobberMemory();  // or the second pass would be known to find
                                   // the same
      total += sum(data_.data() + first, last - first);
    }
    return total;
  };
  double best = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < kBestOf; ++attempt) {
    std::atomic<int> ready{0};
    std::atomic<bool> go{false};
    std::vector<double> sums(static_cast<std::size_t>(threads), 0.0);
    std::vector<std::thread> others;
    for (int t = 1; t < threads; ++t) {
      others.emplace_back([&, t] {
        ++ready;
        while (!go) {
          std::this_thread::yield();
        }
        sums[static_cast<std::size_t>(t)] = share(t);
        --ready;
      });
    }
    while (ready < threads - 1) {
      std::this_thread::yield();
    }
    const auto start = std::chrono::steady_clock::now();
    go = true;
    sums[0] = share(0);
    while (ready > 0) {
      std::this_thread::yield();
    }
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    for (std::thread& other : others) {
      other.join();
    }
    double total = 0;
    for (const double part : sums) {
      total += part;
    }
    error_ = std::abs(total / (2.0 * static_cast<double>(data_.size())) - 1);
  }
  return best;
}

}  // namespace speed
