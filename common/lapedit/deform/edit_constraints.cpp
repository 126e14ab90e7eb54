// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_constraints.h"

namespace lapedit {
void EditConstraints::set(const std::vector<HandleMotion>& handles, const Affine& anchors) {
  paths_.set(handles, anchors);
  const Region& region = system_.region;
  const Points& rest = system_.rest.local;
  moves_rigidly_ = paths_.moves_rigidly();
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
  any_ = !right_.isZero(0) || paths_.revolves();
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
