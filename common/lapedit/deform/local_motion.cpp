// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/local_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {

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

namespace {

/// Rotation and stretch of the groups' maps L = R S, the mean of each over a component's handle vertices, that of the
/// rotations by their quaternions; and their mean place goes to the mean of its targets.
LocalMotion mean_motion(const Region& region, const Points& rest, const std::vector<LocalMotion>& targets,
                        int component) {
  Eigen::Vector4d first = Eigen::Vector4d::Zero(), quaternion = first, turn = first;
  Matrix3 own_stretch = Matrix3::Zero(), stretch = own_stretch;
  Vector3 place = Vector3::Zero(), way = Vector3::Zero();
  int group = -1, count = 0;
  for (int i = 0; i < region.size(); ++i) {
    if (region.component[i] != component || region.classes[i] != VertexClass::Handle) {
      continue;
    }
    if (region.group[i] != group) {
      const Matrix3 linear = targets[region.group[i]].linear + Matrix3::Identity();
      const Matrix3 rotation = PolarDecomposition(linear).rotation();
      own_stretch = rotation.transpose() * linear;
      quaternion = Eigen::Quaterniond(rotation).coeffs();
      first = group < 0 ? quaternion : first;
      quaternion = quaternion.dot(first) < 0 ? Eigen::Vector4d(-quaternion) : quaternion;  // so the sum is never zero
      group = region.group[i];
    }
    turn += quaternion;
    stretch += own_stretch;
    place += rest.row(i).transpose();
    way += targets[group].displacement(rest.row(i).transpose());
    ++count;
  }
  const Matrix3 rotation = Eigen::Quaterniond(Eigen::Vector4d(turn.normalized())).toRotationMatrix();
  LocalMotion mean;
  mean.linear = rotation * (stretch / count) - Matrix3::Identity();
  mean.translation = (way - mean.linear * place) / count;
  return mean;
}

}  // namespace

void carry_components(const Region& region, const Points& rest, const std::vector<LocalMotion>& targets,
                      const LocalMotion& anchors, std::vector<LocalMotion>& carried, std::vector<HandlesSeen>& seen) {
  carried.assign(region.anchored.size(), LocalMotion());
  seen.assign(region.anchored.size(), HandlesSeen());
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
    if (seen[c].count++ == 0) {
      seen[c].first_group = region.group[i];
    }
    carried[c].linear += (target.linear - carried[c].linear) / seen[c].count;
    carried[c].translation += (target.translation - carried[c].translation) / seen[c].count;
    seen[c].agree = seen[c].agree && target.linear == targets[seen[c].first_group].linear;
  }
  for (std::size_t c = 0; c < carried.size(); ++c) {
    if (!seen[c].agree) {
      carried[c] = mean_motion(region, rest, targets, static_cast<int>(c));
    }
  }
}

}  // namespace lapedit
