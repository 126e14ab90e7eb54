// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_constraints.h"

#include <algorithm>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {
namespace {

Matrix3 rotation_of(const LocalMotion& motion) {
  if (motion.linear.isZero(0)) {
    return Matrix3::Identity();
  }
  const Matrix3 rotation = PolarDecomposition(motion.linear + Matrix3::Identity()).orthogonal();
  return rotation.determinant() > 0 ? rotation : Matrix3::Identity();
}

}  // namespace

LocalMotion LocalMotion::of(const Affine& map, const Vector3& origin) {
  LocalMotion motion;
  motion.linear = map.linear() - Matrix3::Identity();
  motion.translation = motion.linear * origin + map.translation();
  return motion;
}

void check_targets(const Region& region, const std::vector<Affine>& handles) {
  const int groups = 1 + *std::max_element(region.group.begin(), region.group.end());
  if (static_cast<int>(handles.size()) < groups) {
    throw EditError(ErrorCause::NoHandle, std::to_string(handles.size()) + " handle maps were given for " +
                                              std::to_string(groups) + " handle groups: give one for each.");
  }
  for (std::size_t g = 0; g < handles.size(); ++g) {
    if (!handles[g].matrix().allFinite()) {
      throw EditError(ErrorCause::NotFinite,
                      "The target of handle group " + std::to_string(g) + " is not finite: give a finite transform.");
    }
  }
}

void carry_components(const Region& region, const std::vector<LocalMotion>& targets, const LocalMotion& anchors,
                      std::vector<LocalMotion>& carried, std::vector<int>& handles_seen) {
  carried.assign(region.anchored.size(), LocalMotion());
  handles_seen.assign(region.anchored.size(), 0);
  for (std::size_t c = 0; c < carried.size(); ++c) {
    if (region.anchored[c]) {
      carried[c] = anchors;
    }
  }
  for (int i = 0; i < region.size(); ++i) {
    const int c = region.component[i];
    if (region.classes[i] != VertexClass::Handle || region.anchored[c]) {
      continue;
    }
    // A running mean stays exact when all groups agree.
    const LocalMotion& target = targets[region.group[i]];
    const int seen = ++handles_seen[c];
    carried[c].linear += (target.linear - carried[c].linear) / seen;
    carried[c].translation += (target.translation - carried[c].translation) / seen;
  }
}

void EditConstraints::set(const std::vector<Affine>& handles, const Affine& anchors) {
  targets_.resize(handles.size());
  for (std::size_t g = 0; g < handles.size(); ++g) {
    targets_[g] = LocalMotion::of(handles[g], system_.rest.origin);
  }
  carry_along(anchors);
  set_right_hand_side();
}

void EditConstraints::carry_along(const Affine& anchors) {
  const Region& region = system_.region;
  const Points& rest = system_.rest.local;
  carry_components(region, targets_, LocalMotion::of(anchors, system_.rest.origin), carried_, handles_seen_);
  carried_rotation_.assign(carried_.size(), Matrix3::Identity());
  carries_ = false;
  for (std::size_t c = 0; c < carried_.size(); ++c) {
    if (!carried_[c].none()) {
      carries_ = true;
      carried_rotation_[c] = rotation_of(carried_[c]);
    }
  }
  if (carries_) {
    carried_pose_ = rest;
    for (int i = 0; i < region.size(); ++i) {
      carried_pose_.row(i) += carried(i).displacement(rest.row(i).transpose()).transpose();
    }
  }
}

void EditConstraints::set_right_hand_side() {
  const Region& region = system_.region;
  right_.setZero(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      const Vector3 way = wanted_way(i) - carried(i).displacement(system_.rest.local.row(i).transpose());
      right_.row(i) = system_.squared_weights[i] * way.transpose();
    }
  }
  pulls_ = !right_.isZero(0);
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
          const Vector3 place = rest.row(falloff.lone[g] >= 0 ? falloff.lone[g] : i).transpose();
          displacement.row(i) +=
              weight * (targets_[g].displacement(place) - carried(i).displacement(place)).transpose();
        }
      }
    }
  });
}

Vector3 EditConstraints::wanted_way(int i) const {
  return targets_[system_.region.group[i]].displacement(system_.rest.local.row(i).transpose());
}

std::size_t EditConstraints::bytes() const {
  return static_cast<std::size_t>(carried_pose_.size() + right_.size()) * sizeof(double);
}

}  // namespace lapedit
