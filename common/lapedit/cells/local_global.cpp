// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/local_global.h"

#include <algorithm>
#include <cmath>

#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {
namespace {

// Found by measuring stretch, folds and the tilt of details over some twenty edits (tests/scripts/quality.sh).
constexpr int kSmoothing = 1;
constexpr int kAveraging = 1;
constexpr double kNormals = 0.5;
constexpr double kMomentum = 0.5;
// What keeps a pose from jumping while its handle moves on, at places where the surface collapses: a normal fades out,
// and a rotation stays near the last one.
constexpr double kSureNormal = 0.5, kInertia = 0.5;

}  // namespace

LocalGlobal::LocalGlobal(const RegionCells& cells, const CellSurface& surface, const std::vector<double>& hold,
                         const EditSettings& settings, CoarseSystem& system)
    : cells_(cells),
      surface_(surface),
      hold_(hold),
      settings_(settings),
      system_(system),
      averages_(cells.count()),
      covariances_(cells.count()),
      before_(cells.neighbours.values.size()) {}

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
    const double length = std::sqrt(normal.squaredNorm() + kSureNormal * kSureNormal);
    covariance += (kNormals * covariance.norm() / length * normal) * normals_before_.row(a);
    averages_[a] = covariance;
  }
  averages_.average(cells_.neighbours, kAveraging, alone_);
  for (int a = 0; a < cells_.count(); ++a) {
    const Matrix3 averaged = averages_[a];
    covariances_[a] = averaged.allFinite() ? averaged : Matrix3(Matrix3::Identity());
    covariances_[a] += kInertia * covariances_[a].norm() * rotations[a];
    if (hold_[a] > 0) {
      covariances_[a] = (1 - hold_[a]) * covariances_[a] + hold_[a] * covariances_[a].norm() * Matrix3::Identity();
    }
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

LocalGlobal::Outcome LocalGlobal::settle(const Points& constraints, double accurate, int most_passes,
                                         Points& displacement, std::vector<Matrix3>& rotations) {
  Outcome outcome;
  while (outcome.passes < most_passes) {
    if (outcome.passes > 0) {
      fit(displacement, rotations);
    }
    turn(rotations, turned_);
    next_ = constraints;
    system_.add_turned(turned_, next_);
    system_.solve(next_, next_);
    if (++outcome.passes == 1) {
      displacement = result_ = next_;
      continue;
    }
    outcome.left = (next_ - displacement).rowwise().norm().maxCoeff();
    // Rotations are fitted to a place somewhat ahead, which is worth several passes.
    displacement = next_ + kMomentum * (next_ - result_);
    result_.swap(next_);
    if (!(outcome.left >= accurate)) {
      break;
    }
  }
  fit(displacement, rotations);
  displacement = result_;
  return outcome;
}

}  // namespace lapedit
