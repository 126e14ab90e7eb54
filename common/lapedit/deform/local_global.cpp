// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/local_global.h"

#include <cmath>
#include <utility>

#include "lapedit/deform/nearest_rotations.h"

namespace lapedit {
namespace {

// Found by measuring stretch, folds and the tilt of details over some twenty edits (tests/scripts/quality.sh).
constexpr int kSmoothing = 2;
constexpr int kAveraging = 4;
constexpr double kNormals = 0.5;
constexpr int kWindow = 5;

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
      other_(cells.count()) {}

void LocalGlobal::start(const Points& carried, std::vector<Matrix3> linear) {
  carried_ = carried;
  linear_ = std::move(linear);
  smooth_before_ = carried;
  surface_.smooth(kSmoothing, smooth_before_, scratch_);
  normals_before_.resize(carried.rows(), 3);
  for (int a = 0; a < cells_.count(); ++a) {
    normals_before_.row(a) = surface_.normal(a, smooth_before_).transpose();
  }
}

/// The rotation nearest to C_a = sum_b g_ab (P1_b - P1_a)(P0_b - P0_a)^T + |.| n1 n0^T / 2, averaged.
void LocalGlobal::fit(const Points& displacement, std::vector<Matrix3>& rotations) {
  smooth_after_ = carried_ + displacement;
  surface_.smooth(kSmoothing, smooth_after_, scratch_);
  for (int a = 0; a < cells_.count(); ++a) {
    Matrix3 covariance = Matrix3::Zero();
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      const int b = cells_.neighbours.values[k];
      const Vector3 after = surface_.nearness(k) * (smooth_after_.row(b) - smooth_after_.row(a)).transpose();
      covariance += after * (smooth_before_.row(b) - smooth_before_.row(a));
    }
    const Vector3 normal = kNormals * covariance.norm() * surface_.normal(a, smooth_after_);
    covariances_[a] = covariance + normal * normals_before_.row(a);
  }
  for (int round = 0; round < kAveraging; ++round) {
    covariances_.swap(other_);
    for (int a = 0; a < cells_.count(); ++a) {
      Matrix3 sum = other_[a];
      for (const int b : cells_.neighbours[a]) {
        sum += other_[b];
      }
      covariances_[a] = sum / (1 + static_cast<double>(cells_.neighbours[a].size()));
    }
  }
  for (int a = 0; a < cells_.count(); ++a) {
    if (!covariances_[a].allFinite()) {
      covariances_[a].setIdentity();
    }
    covariances_[a] = (1 - hold_[a]) * covariances_[a] + hold_[a] * covariances_[a].norm() * Matrix3::Identity();
  }
  nearest_rotations(covariances_.data(), cells_.count(), rotations.data());
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
  fit(displacement, rotations);
  return outcome;
}

}  // namespace lapedit
