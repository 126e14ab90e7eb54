// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/rotation_fit.h"

#include <algorithm>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {

RotationFit::RotationFit(const RegionCells& cells)
    : cells_(cells),
      areas_(Eigen::Map<const Eigen::VectorXd>(cells.area.data(), cells.count())),
      scratch_(cells.count(), 3),
      rotations_(cells.count()) {
  members_ = lists_of(cells.count(), [&](const auto& use) {
    for (int i = 0; i < static_cast<int>(cells.of.size()); ++i) {
      use(cells.of[i], i);
    }
  });
  for (int k = 0; k < 3; ++k) {
    rest_[k].resize(cells.count(), 3);
    moved_[k].resize(cells.count(), 3);
  }
  constexpr double kLeast = 1e-3;          // of the mean area
  constexpr double kVariance = 1.0 / 160;  // of the free area
  constexpr double kRound = 0.3;           // of the squared radius of curvature: thin limbs turn with their joints
  constexpr double kOfCell = 0.34;         // of a cell's area: the variance that sums over cells and blends have anyway
  areas_ = areas_.cwiseMax(kLeast * areas_.mean());
  const auto curvatures = Eigen::Map<const Eigen::ArrayXd>(cells.curvature.data(), cells.count());
  const Eigen::VectorXd times =
      ((kRound / curvatures.square()).min(kVariance * cells.free_area) - kOfCell * areas_.array()).max(0.0) / 4;
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < cells.count(); ++a) {
    entries.emplace_back(a, a, areas_[a] > 0 ? areas_[a] : 1);
    for (int k = cells.neighbours.offsets[a]; k < cells.neighbours.offsets[a + 1]; ++k) {
      const int b = cells.neighbours.values[k];
      const double weight = std::min(times[a], times[b]) * cells.crossing[k];
      entries.emplace_back(a, a, weight);
      entries.emplace_back(a, b, -weight);
    }
  }
  SparseMatrix matrix(cells.count(), cells.count());
  matrix.setFromTriplets(entries.begin(), entries.end());
  diffusion_ = std::make_unique<SmallCholesky>(matrix);
}

void RotationFit::diffuse(Points& rows) {
  diffusion_->solve(rows, scratch_);
  for (Eigen::Index c = 0; c < scratch_.rows(); ++c) {
    scratch_.row(c) *= areas_[c];
  }
  diffusion_->solve(scratch_, rows);
}

/// The covariance is that at rest, which is symmetric, and the change by the displacement. Each is diffused by itself,
/// so that a component without displacement has exactly the identity.
const std::vector<Matrix3>& RotationFit::operator()(const LaplacianSystem& system, const Points& before,
                                                    const Points& displacement) {
  constexpr int kGrain = 4;
  const OperatorRows::Rows& m = system.powers.first->rows();
  for_indices(*system.pool, cells_.count(), kGrain, [&](int c) {
    Matrix3 rest = Matrix3::Zero(), moved = rest;
    for (const int i : members_[c]) {
      for (OperatorRows::Rows::InnerIterator entry(m, i); entry; ++entry) {
        const auto j = static_cast<int>(entry.col());
        const double weight = -entry.value() * system.powers.divisor[i];
        const Vector3 edge = (before.row(i) - before.row(j)).transpose();
        rest += weight * edge * edge.transpose();
        moved += weight * (displacement.row(i) - displacement.row(j)).transpose() * edge.transpose();
      }
    }
    for (int k = 0; k < 3; ++k) {
      rest_[k].row(c) = rest.row(k);
      moved_[k].row(c) = moved.row(k);
    }
  });
  for (int k = 0; k < 3; ++k) {
    diffuse(rest_[k]);
    diffuse(moved_[k]);
  }
  for (int c = 0; c < cells_.count(); ++c) {
    Matrix3 rest, moved;
    for (int k = 0; k < 3; ++k) {
      rest.row(k) = rest_[k].row(c);
      moved.row(k) = moved_[k].row(c);
    }
    rotations_[c] = 0.5 * (rest + rest.transpose()) + moved;
    if (!rotations_[c].allFinite()) {
      rotations_[c].setIdentity();
    }
  }
  nearest_rotations(rotations_.data(), cells_.count(), rotations_.data());
  return rotations_;
}

}  // namespace lapedit
