// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/blended_rotations.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace lapedit {
namespace {

std::vector<double> weights_of(const TriangleMesh& mesh, const Region& region, const EditSettings& settings) {
  return settings.laplacian == LaplacianKind::Umbrella && region.links.empty()
             ? std::vector<double>()
             : edge_weights(settings.laplacian, region, mesh, settings.membrane > 0).values;
}

}  // namespace

BlendedRotations::BlendedRotations(const TriangleMesh& mesh, const Region& region, const Points& rest,
                                   const EditSettings& settings, ThreadPool& pool)
    : cells_(
          make_cells(region, rest, weights_of(mesh, region, settings), CellTurning::wanted_cells(region.size()), pool)),
      blend_(cells_, rest, pool),
      turning_(region, rest, cells_, blend_, settings, CholeskyBackend::Eigen, pool),
      hold_(region.size(), 0) {
  for (int i = 0; i < region.size() && !region.anchor_depth.empty(); ++i) {
    const double depth = region.anchor_depth[i];
    hold_[i] = depth * depth * (3 - 2 * depth);
  }
}

void BlendedRotations::quaternions(std::vector<Eigen::Vector4d>& quaternions) const {
  quaternions.resize(cells_.count());
  for (int c = 0; c < cells_.count(); ++c) {
    quaternions[c] = Eigen::Quaterniond(turning_.rotations()[c]).coeffs();
  }
}

/// q = sum_k w_k (q_k . q_0) q_k, then towards the identity, as far as it is held back. No sign of a quaternion changes
/// it, and it has no jumps where two cells rotate by 180 degrees against each other.
void BlendedRotations::spread(std::vector<Matrix3>& rotations, ThreadPool& pool) {
  constexpr int kGrain = 1024;
  constexpr double kCancelled = 0.2;
  quaternions(quaternions_);
  const auto n = static_cast<int>(hold_.size());
  rotations.resize(n);
  in_pieces(pool, n, kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const Eigen::Vector4d towards = quaternions_[blend_.cells(0, i)];
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (int k = 0; k < CellBlend::kReach; ++k) {
        const Eigen::Vector4d& one = quaternions_[blend_.cells(k, i)];
        const auto weight = static_cast<double>(blend_.weights(k, i));
        sum += weight * one.dot(towards) * one;
      }
      sum += std::max(0.0, kCancelled - sum.norm()) * towards;
      sum.normalize();
      const double along = hold_[i] * sum[3];
      sum *= 1 - hold_[i];
      sum[3] += along;
      rotations[i] = sum.isZero(0) ? Matrix3(Matrix3::Identity())
                                   : Eigen::Quaterniond(Eigen::Vector4d(sum.normalized())).toRotationMatrix();
    }
  });
}

}  // namespace lapedit
