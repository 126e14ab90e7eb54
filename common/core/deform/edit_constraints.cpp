// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_constraints.h"

namespace lapedit {

EditConstraints::EditConstraints(const RestPose& rest)
    : rest_(rest),
      region_(*rest.region),
      paths_(region_, rest.local, rest.origin),
      wanted_(Points::Zero(region_.size(), 3)) {
  for (int i = 0; i < region_.size(); ++i) {
    if (region_.classes[i] == VertexClass::Handle) {
      handles_.push_back(i);
    }
  }
}

void EditConstraints::set(const std::vector<HandleMotion>& handles, const Points& shift) {
  paths_.set(handles);
  const Points& rest = rest_.local;
  shift_ = shift;
  moves_rigidly_ = paths_.moves_rigidly();
  if (starts_elsewhere()) {
    start_ = rest;
    for (int i = 0; i < region_.size(); ++i) {
      start_.row(i) += start_displacement(i).transpose();
    }
  }
  any_ = paths_.revolves();
  for (const int i : handles_) {
    wanted_.row(i) = (wanted_displacement(i) - rigid_motion(i).displacement(rest.row(i).transpose())).transpose();
    any_ |= !wanted_.row(i).isZero(0);
  }
}

Vector3 EditConstraints::start_displacement(int i) const {
  const Vector3 rest = rest_.local.row(i).transpose();
  if (shift_.rows() == 0) {
    return rigid_motion(i).displacement(rest);
  }
  const Vector3 shift = shift_.row(i).transpose();
  return shift + rigid_motion(i).displacement(rest + shift);
}

void EditConstraints::fall_off(const GeodesicFalloff& falloff, Points& displacement, ThreadPool& pool) const {
  const Points& rest = rest_.local;
  displacement.setZero(rest.rows(), 3);
  constexpr int kGrain = 2048;
  in_pieces(pool, region_.size(), kGrain, [&](int first, int last) {
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
