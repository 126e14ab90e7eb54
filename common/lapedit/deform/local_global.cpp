// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/local_global.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "lapedit/base/cpu_dispatch.h"
#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {
namespace {

// Found by measuring stretch, folds and the tilt of details over some twenty edits (tests/scripts/quality.sh).
constexpr int kSmoothing = 2;
constexpr int kAveraging = 4;
constexpr double kNormals = 0.5;
constexpr int kWindow = 5;

constexpr int kStride = 12;  // of matrices that are averaged: three vectors
typedef double Lanes __attribute__((vector_size(4 * sizeof(double))));

LAPEDIT_INLINE Lanes load(const double* from) {
  Lanes result;
  std::memcpy(&result, from, sizeof result);
  return result;
}

/// Mean over a cell and its neighbours.
LAPEDIT_INLINE void mean_around(const IndexLists& neighbours, int cells, const double* in, double* out) {
  for (int a = 0; a < cells; ++a) {
    const double* from = in + std::ptrdiff_t{kStride} * a;
    Lanes sum[3] = {load(from), load(from + 4), load(from + 8)};
    for (const int b : neighbours[a]) {
      from = in + std::ptrdiff_t{kStride} * b;
      for (int e = 0; e < 3; ++e) {
        sum[e] += load(from + 4 * static_cast<std::ptrdiff_t>(e));
      }
    }
    const double share = 1 / (1 + static_cast<double>(neighbours[a].size()));
    for (int e = 0; e < 3; ++e) {
      sum[e] *= share;
    }
    std::memcpy(out + std::ptrdiff_t{kStride} * a, sum, sizeof sum);
  }
}

void mean_around_plain(const IndexLists& neighbours, int cells, const double* in, double* out) {
  mean_around(neighbours, cells, in, out);
}
LAPEDIT_AVX2 void mean_around_avx2(const IndexLists& neighbours, int cells, const double* in, double* out) {
  mean_around(neighbours, cells, in, out);
}

}  // namespace

LocalGlobal::LocalGlobal(const RegionCells& cells, const CellSurface& surface, const std::vector<double>& hold,
                         const EditSettings& settings, CoarseSystem& system)
    : cells_(cells),
      surface_(surface),
      hold_(hold),
      settings_(settings),
      system_(system),
      mixing_(kWindow),
      covariances_(cells.count()),
      before_(cells.neighbours.values.size()),
      current_(kStride * static_cast<std::size_t>(cells.count()), 0),
      other_(current_.size(), 0) {}

void LocalGlobal::start(const Points& carried, const std::vector<Matrix3>& linear) {
  if (carried_.rows() == carried.rows() && carried_ == carried && linear_ == linear) {
    return;  // in a drag it is the rest pose in every frame
  }
  carried_ = carried;
  linear_ = linear;
  smooth_before_ = carried;
  surface_.smooth(kSmoothing, smooth_before_, scratch_);
  normals_before_.resize(carried.rows(), 3);
  for (int a = 0; a < cells_.count(); ++a) {
    normals_before_.row(a) = surface_.normal(a, smooth_before_).transpose();
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      before_[k] =
          surface_.nearness(k) * (smooth_before_.row(cells_.neighbours.values[k]) - smooth_before_.row(a)).transpose();
    }
  }
}

/// The rotation nearest to C_a = sum_b g_ab (P1_b - P1_a)(P0_b - P0_a)^T + |.| n1 n0^T / 2, averaged.
void LocalGlobal::fit(const Points& displacement, std::vector<Matrix3>& rotations) {
  smooth_after_ = carried_ + displacement;
  surface_.smooth(kSmoothing, smooth_after_, scratch_);
  for (int a = 0; a < cells_.count(); ++a) {
    Matrix3 covariance = Matrix3::Zero();
    Vector3 first = Vector3::Zero(), second = Vector3::Zero();  // tangents, as in CellSurface::normal()
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      const Vector3 edge = (smooth_after_.row(cells_.neighbours.values[k]) - smooth_after_.row(a)).transpose();
      covariance.noalias() += edge * before_[k].transpose();
      first += surface_.slope(k)[0] * edge;
      second += surface_.slope(k)[1] * edge;
    }
    const Vector3 normal = first.cross(second);
    const double length = normal.norm();
    if (length > 0) {
      covariance += (kNormals * covariance.norm() / length * normal) * normals_before_.row(a);
    }
    Eigen::Map<Matrix3>(current_.data() + std::ptrdiff_t{kStride} * a) = covariance;
  }
  average();
  for (int a = 0; a < cells_.count(); ++a) {
    const Matrix3 averaged = Eigen::Map<const Matrix3>(current_.data() + std::ptrdiff_t{kStride} * a);
    covariances_[a] = averaged.allFinite() ? averaged : Matrix3(Matrix3::Identity());
    if (hold_[a] > 0) {
      covariances_[a] = (1 - hold_[a]) * covariances_[a] + hold_[a] * covariances_[a].norm() * Matrix3::Identity();
    }
  }
  nearest_rotations(covariances_.data(), cells_.count(), rotations.data());
}

void LocalGlobal::average() {
  // The same bits: sums are not contracted.
  const auto mean = for_processor(mean_around_plain, mean_around_avx2, mean_around_avx2);
  for (int round = 0; round < kAveraging; ++round) {
    current_.swap(other_);
    mean(cells_.neighbours, cells_.count(), other_.data(), current_.data());
  }
}

/// sum_b -M_ab ((R_a + R_b) / 2 - I) (C_a - C_b), or with R_a alone.
void LocalGlobal::turn(const std::vector<Matrix3>& rotations, Points& turned) const {
  const SparseMatrix& m = system_.differential_operator();
  const bool by_edges = settings_.turning == DetailTurning::Edge;
  turned.setZero(cells_.count(), 3);
  for (int b = 0; b < m.outerSize(); ++b) {
    for (SparseMatrix::InnerIterator entry(m, b); entry; ++entry) {
      const auto a = static_cast<int>(entry.row());
      if (a == b) {
        continue;
      }
      Vector3 edge = (cells_.centres.row(a) - cells_.centres.row(b)).transpose();
      edge += linear_[a] * edge;
      const Vector3 after =
          by_edges ? Vector3(0.5 * ((rotations[a] + rotations[b]) * edge)) : Vector3(rotations[a] * edge);
      turned.row(a) -= entry.value() * (after - edge).transpose();
    }
  }
}

LocalGlobal::Outcome LocalGlobal::settle(const Points& constraints, double accurate, int most_passes, bool goes_on,
                                         Points& displacement, std::vector<Matrix3>& rotations) {
  Outcome outcome;
  mixing_.restart();
  while (outcome.passes < most_passes) {
    const bool fits = goes_on || outcome.passes > 0;
    if (fits) {
      fit(displacement, rotations);
    }
    turn(rotations, turned_);
    next_ = constraints;
    system_.add_turned(turned_, next_);
    system_.solve(next_, next_);
    ++outcome.passes;
    if (!fits) {
      displacement = next_;
      continue;
    }
    outcome.left = (next_ - displacement).rowwise().norm().maxCoeff();
    mixing_.step(displacement, next_);
    if (!(outcome.left >= accurate)) {
      break;
    }
  }
  last_ = rotations;
  fit(displacement, rotations);
  for (int a = 0; a < cells_.count(); ++a) {
    outcome.turned = std::max(outcome.turned, (rotations[a] - last_[a]).norm() / std::sqrt(2.0));
  }
  return outcome;
}

}  // namespace lapedit
