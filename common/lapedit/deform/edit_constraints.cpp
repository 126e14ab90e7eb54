// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_constraints.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {
namespace {

Matrix3 rotation_of(const LocalMotion& motion) {
  const Matrix3 linear = motion.linear + Matrix3::Identity();
  return motion.linear.isZero(0) || linear.determinant() < 0 ? Matrix3(Matrix3::Identity()) : polar_rotation(linear);
}

}  // namespace

void EditConstraints::set(const std::vector<HandleMotion>& handles, const Affine& anchors) {
  paths_.set(handles, anchors);
  const Region& region = system_.region;
  const Points& rest = system_.rest.local;
  const std::vector<LocalMotion>& motions = paths_.rigid_motions();
  rigid_rotations_.assign(motions.size(), Matrix3::Identity());
  moves_rigidly_ = paths_.moves_rigidly();
  for (std::size_t c = 0; moves_rigidly_ && c < motions.size(); ++c) {
    rigid_rotations_[c] = rotation_of(motions[c]);
  }
  if (moves_rigidly_) {
    rigid_pose_ = rest;
    for (int i = 0; i < region.size(); ++i) {
      rigid_pose_.row(i) += rigid_motion(i).displacement(rest.row(i).transpose()).transpose();
    }
  }
  right_.setZero(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      const Vector3 displacement = wanted_displacement(i) - rigid_motion(i).displacement(rest.row(i).transpose());
      right_.row(i) = system_.squared_weights[i] * displacement.transpose();
    }
  }
  any_ = !right_.isZero(0);
}

void EditConstraints::fall_off(Points& displacement) const {
  const GeodesicFalloff& falloff = system_.falloff;
  const Points& rest = system_.rest.local;
  displacement.setZero(rest.rows(), 3);
  constexpr int kGrain = 2048;
  in_pieces(*system_.pool, system_.region.size(), kGrain, [&](int first, int last) {
    for (std::size_t g = 0; g < falloff.lone.size(); ++g) {
      for (int i = first; i < last; ++i) {
        const double weight = falloff.weights(i, static_cast<Eigen::Index>(g));
        if (weight > 0) {
          const Vector3 position = rest.row(falloff.lone[g] >= 0 ? falloff.lone[g] : i).transpose();
          displacement.row(i) +=
              weight *
              (paths_.motions()[g].displacement(position) - rigid_motion(i).displacement(position)).transpose();
        }
      }
    }
  });
}

}  // namespace lapedit
