// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/types.h"

/// Error measures, orders and refusals for tests of all layers.
namespace lapedit::support {

/// Diagonal of the bounding box.
inline double diameter(const Points& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

/// Largest distance between equal rows over the box diagonal of expected; infinite if anything is not a number.
inline double error(const Points& actual, const Points& expected) {
  if (actual.rows() != expected.rows() || !actual.allFinite() || !expected.allFinite()) {
    return std::numeric_limits<double>::infinity();
  }
  return (actual - expected).rowwise().norm().maxCoeff() / diameter(expected);
}

inline bool same_bits(const Points& a, const Points& b) {
  if (a.rows() != b.rows()) {
    return false;
  }
  return a.size() == 0 || std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0;  // no data, a null pointer
}

/// Rows of some vertices.
inline Points rows(const Points& points, const std::vector<int>& vertices) {
  Points result(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    result.row(static_cast<Eigen::Index>(i)) = points.row(vertices[i]);
  }
  return result;
}

/// 0 .. count - 1 in an arbitrary, reproducible order.
inline std::vector<int> shuffled(int count, unsigned seed) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  std::mt19937 generator(seed);
  for (int k = count - 1; k > 0; --k) {  // std::shuffle differs between libraries
    std::swap(numbers[k], numbers[generator() % (k + 1)]);
  }
  return numbers;
}

inline void expect_contains(const std::string& text, const std::string& expected) {
  EXPECT_NE(text.find(expected), std::string::npos) << text << "\nhas no " << expected;
}

/// Expects an EditError of a cause, with one sentence; returns the sentence.
template <typename Function>
std::string expect_refusal(ErrorCause cause, Function function) {
  try {
    function();
  } catch (const EditError& refusal) {
    std::string sentence = refusal.what();
    EXPECT_EQ(static_cast<int>(refusal.cause()), static_cast<int>(cause)) << sentence;
    EXPECT_GT(sentence.size(), 20U) << sentence;
    EXPECT_EQ(sentence.back(), '.') << sentence;
    return sentence;
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace lapedit::support
