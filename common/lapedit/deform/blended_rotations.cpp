// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/blended_rotations.h"

#include <Eigen/Geometry>

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

/// q = sum_k w_k +-q_k, each sign towards the first cell's; then towards the identity, as far as it is held back.
void BlendedRotations::spread(std::vector<Matrix3>& rotations, ThreadPool& pool) {
  constexpr int kGrain = 1024;
  constexpr double kCancelled = 0.1;
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
        sum += (one.dot(towards) < 0 ? -weight : weight) * one;
      }
      double length = sum.norm();
      if (!(length > kCancelled)) {
        sum = towards;
        length = 1;
      }
      sum *= (sum[3] < 0 ? hold_[i] - 1 : 1 - hold_[i]) / length;
      sum[3] += hold_[i];
      rotations[i] = Eigen::Quaterniond(Eigen::Vector4d(sum.normalized())).toRotationMatrix();
    }
  });
}

}  // namespace lapedit
