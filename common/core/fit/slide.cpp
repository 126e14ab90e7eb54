// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/slide.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace lapedit {

namespace {

/// What is known of a displacement: its component in a direction.
struct Component {
  Eigen::RowVector3d at, direction;
  double value;
};

double kernel(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  return std::exp(-(a - b).squaredNorm() / 2);
}

/// Returns the weights of the components in a regression of displacements.
Eigen::VectorXd regression(const std::vector<Component>& known) {
  constexpr double kNoise = 0.02;  // of a displacement, over its standard deviation
  const auto count = static_cast<Eigen::Index>(known.size());
  Eigen::MatrixXd matrix(count, count);
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Component& a = known[static_cast<std::size_t>(i)];
    values[i] = a.value;
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Component& b = known[static_cast<std::size_t>(j)];
      matrix(i, j) = kernel(a.at, b.at) * a.direction.dot(b.direction) + (i == j ? kNoise * kNoise : 0);
    }
  }
  return matrix.llt().solve(values);
}

}  // namespace

FitSlide slide_of(const FittedShape& fit, const std::vector<int>& samples, const std::vector<int>& met) {
  constexpr std::size_t kEvery = 5, kKnown = 3;
  std::vector<Component> known;
  const auto know = [&](int v, const Eigen::RowVector3d& direction) {
    known.push_back({fit.before.row(v), direction, direction.dot(fit.after.row(v) - fit.before.row(v))});
  };
  std::vector<int> compared;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k % kEvery >= kKnown) {
      compared.push_back(samples[k]);
    } else if (fit.drawn[static_cast<std::size_t>(samples[k])] != 0) {
      know(samples[k], fit.normals.row(samples[k]));
    }
  }
  constexpr std::size_t kMostMet = 100;
  for (std::size_t k = 0; k < met.size(); k += 1 + met.size() / kMostMet) {
    for (int axis = 0; axis < 3; ++axis) {
      know(met[k], Eigen::RowVector3d::Unit(axis));
    }
  }
  if (known.empty()) {
    return {};
  }
  const Eigen::VectorXd weights = regression(known);
  FitSlide slide;
  double drawn = 0;
  for (const int v : compared) {
    Eigen::RowVector3d offset = fit.before.row(v) - fit.after.row(v);
    for (std::size_t k = 0; k < known.size(); ++k) {
      offset += weights[static_cast<Eigen::Index>(k)] * kernel(known[k].at, fit.before.row(v)) * known[k].direction;
    }
    const Eigen::RowVector3d normal = fit.normals.row(v), across = normal.dot(offset) * normal;
    const double along = (offset - across).norm();
    slide.along += along / static_cast<double>(compared.size());
    if (fit.drawn[static_cast<std::size_t>(v)] != 0) {
      slide.across += across.norm();
      ++drawn;
    }
    if (along > slide.most) {
      slide.most = along;
      slide.vertex = v;
    }
  }
  slide.across /= std::max(1.0, drawn);
  return slide;
}

}  // namespace lapedit
