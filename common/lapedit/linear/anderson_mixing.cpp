// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/anderson_mixing.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace lapedit {
namespace {

constexpr int kMostWindow = 8;

double dot(const Points& a, const Points& b) {
  double sum = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    sum += a.data()[i] * b.data()[i];
  }
  return sum;
}

}  // namespace

void AndersonMixing::step(Points& x, Points& g) {
  constexpr double kWorse = 2, kRidge = 1e-8;
  g_steps_.resize(window_);
  left_steps_.resize(window_);
  for (int k = 0; k < window_; ++k) {  // all at the first step
    g_steps_[k].resize(x.rows(), 3);
    left_steps_[k].resize(x.rows(), 3);
  }
  x = g - x;  // what is left over
  const double left = dot(x, x);
  if (count_ > 0 && !(left <= kWorse * kWorse * last_left_)) {
    count_ = 0;
  }
  last_left_ = left;
  if (count_ > 0) {
    const int slot = (count_ - 1) % window_;
    left_steps_[slot] = x - last_left_over_;
    g_steps_[slot] = g - last_g_;
  }
  last_left_over_ = x;
  last_g_ = g;
  const int known = std::min(count_, window_);
  ++count_;
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostWindow, kMostWindow>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostWindow, 1>;
  Small products = Small::Zero(known, known);
  Column right = Column::Zero(known);
  for (int i = 0; i < known; ++i) {
    right[i] = dot(left_steps_[i], x);
    for (int j = 0; j <= i; ++j) {
      products(i, j) = products(j, i) = dot(left_steps_[i], left_steps_[j]);
    }
    products(i, i) *= 1 + kRidge;
  }
  if (known > 0) {
    right = products.llt().solve(right);
  }
  for (int i = 0; i < known; ++i) {
    g -= right[i] * g_steps_[i];
  }
  if (g.allFinite()) {
    x.swap(g);
  } else {
    x = last_g_;
    count_ = 0;
  }
}

}  // namespace lapedit
