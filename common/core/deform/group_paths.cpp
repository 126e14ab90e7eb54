// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/group_paths.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/base/refuse.h"
#include "lapedit/base/whole_part.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

constexpr double kUnit = 0.1;  // length of a step over the region's size
constexpr int kLeastSteps = 12, kMostSteps = 40;
constexpr int kSeveral = -1, kNoGroup = -2;

bool same(const LocalMotion& a, const LocalMotion& b) {
  return a.linear == b.linear && a.translation == b.translation;
}

}  // namespace

GroupPaths::GroupPaths(const Region& region, const Points& rest, const Vector3& origin)
    : region_(region),
      rest_(rest),
      origin_(origin),
      groups_(1 + *std::max_element(region.group.begin(), region.group.end())),
      index_(region.size(), -1),
      held_(region.anchored.size()),
      motions_(groups_.size()),
      rigid_motions_(region.anchored.size()),
      rotations_(groups_.size()),
      rigid_rotations_(region.anchored.size()),
      leader_(region.anchored.size(), kNoGroup) {
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      Group& group = groups_[region.group[i]];
      index_[i] = static_cast<int>(group.vertices.size());
      group.vertices.push_back(i);
      group.components.push_back(region.component[i]);
      group.centre += rest.row(i).transpose();
    }
  }
  for (Group& group : groups_) {
    group.components = sorted_set(std::move(group.components));
    group.centre /= static_cast<double>(std::max<std::size_t>(group.vertices.size(), 1));
    for (const int i : group.vertices) {
      if (!region.anchored[region.component[i]]) {
        held_[region.component[i]].push_back(i);
      }
    }
  }
  find_hanging();
}

/// Returns whether the vertices spread in more than one direction.
bool GroupPaths::is_wide(const Group& group) const {
  constexpr double kLine = 0.0025;  // squared ratio of the two widths
  Matrix3 spread = Matrix3::Zero();
  for (const int i : group.vertices) {
    const Vector3 off = rest_.row(i).transpose() - group.centre;
    spread += off * off.transpose();
  }
  const double trace = spread.trace();
  return trace * trace - spread.squaredNorm() > 2 * kLine * trace * trace;
}

void GroupPaths::find_hanging() {
  std::vector<char> is_free(region_.size()), wide(groups_.size());
  std::transform(region_.classes.begin(), region_.classes.end(), is_free.begin(),
                 [](VertexClass c) { return c == VertexClass::Free ? 1 : 0; });
  std::transform(groups_.begin(), groups_.end(), wide.begin(), [this](const Group& g) { return is_wide(g) ? 1 : 0; });
  std::vector<int> part;
  std::vector<int> holder(connected_components(region_.neighbours, part, is_free), kNoGroup);
  for (int i = 0; i < region_.size(); ++i) {
    for (const int j : region_.neighbours[i]) {
      if (is_free[i] && !is_free[j]) {
        const int by = region_.group[j] >= 0 && wide[region_.group[j]] ? region_.group[j] : kSeveral;
        int& met = holder[part[i]];
        met = met == kNoGroup || met == by ? by : kSeveral;
      }
    }
  }
  for (int i = 0; i < region_.size(); ++i) {
    if (is_free[i] && holder[part[i]] >= 0) {
      index_[i] = holder[part[i]];
      hanging_.push_back(i);
    } else if (!region_.anchored[region_.component[i]]) {
      unanchored_.push_back(i);
    }
  }
}

void GroupPaths::check(const std::vector<HandleMotion>& motions) const {
  if (motions.size() < groups_.size()) {
    refuse_edit(ErrorCause::NoHandle, {"handles"}, motions.size(), " handle motions were given for ", groups_.size(),
                " handle groups: give one for each.");
  }
  for (std::size_t g = 0; g < motions.size(); ++g) {
    const HandleMotion& motion = motions[g];
    if (!motion.map.matrix().allFinite() || !motion.targets.allFinite() || !std::isfinite(motion.fraction)) {
      refuse_edit(ErrorCause::NotFinite, {entry_key("handles", g)}, "The target of handle group ", g,
                  " is not finite: give finite coordinates.");
    }
    if (g < groups_.size() && motion.targets.rows() > 0 &&
        motion.targets.rows() != static_cast<Eigen::Index>(groups_[g].vertices.size())) {
      refuse_edit(ErrorCause::BadParameter, {entry_key("handles", g) + ".targets"}, "Handle group ", g, " has ",
                  groups_[g].vertices.size(), " vertices and ", motion.targets.rows(),
                  " targets: give one target for each vertex.");
    }
  }
}

/// Sets the group's motion to the rigid one that fits the targets best, and its offsets to the remainders, rotated
/// back.
void GroupPaths::set_targets(Group& group, const HandleMotion& motion) {
  const auto count = static_cast<Eigen::Index>(group.vertices.size());
  Vector3 mean = Vector3::Zero();
  for (Eigen::Index k = 0; k < count; ++k) {
    group.offsets.row(k) = motion.targets.row(k) - origin_.transpose();
    mean += group.offsets.row(k).transpose() / static_cast<double>(count);
  }
  Matrix3 covariance = Matrix3::Zero();
  for (Eigen::Index k = 0; k < count; ++k) {
    covariance += (group.offsets.row(k).transpose() - mean) * (rest_.row(group.vertices[k]) - group.centre.transpose());
  }
  const Matrix3 rotation = nearest_rotation(covariance);
  Affine rigid;
  rigid.linear() = rotation;
  rigid.translation() = mean - rotation * group.centre;
  group.path = MotionPath(rigid, Vector3::Zero(), group.centre);
  for (Eigen::Index k = 0; k < count; ++k) {
    group.offsets.row(k) =
        (rotation.transpose() * (group.offsets.row(k).transpose() - mean) + group.centre).transpose() -
        rest_.row(group.vertices[k]);
  }
}

void GroupPaths::set(const std::vector<HandleMotion>& motions) {
  check(motions);
  const double unit = kUnit * region_.max_distance;
  double length = 0;
  has_targets_ = false;
  std::fill(leader_.begin(), leader_.end(), kNoGroup);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Group& group = groups_[g];
    group.fraction = motions[g].fraction;
    group.offsets.resize(motions[g].targets.rows(), 3);
    if (group.offsets.rows() > 0) {
      has_targets_ = true;
      set_targets(group, motions[g]);
      length = std::max(length, unit > 0 ? group.offsets.rowwise().norm().maxCoeff() / unit : 0);
    } else {
      group.path = MotionPath(motions[g], origin_, group.centre);
    }
    length = std::max(length, group.path.length(unit));
    for (const int c : group.components) {
      lead(static_cast<int>(g), leader_[c]);
    }
  }
  constexpr double kRounding = 1e-9;  // so that rounding errors of a length do not add a step
  steps_ = whole_part(std::ceil(length - kRounding), kLeastSteps, kMostSteps);
  go_to(steps_);
}

/// A component follows a motion that all its groups have in common; groups of one vertex have no rotation to compare.
void GroupPaths::lead(int g, int& leader) const {
  const Group& group = groups_[g];
  if (leader == kNoGroup && group.offsets.rows() == 0) {
    leader = g;
  } else if (leader == kNoGroup || leader == kSeveral || group.offsets.rows() > 0) {
    leader = kSeveral;
  } else {
    const Group& other = groups_[leader];
    const bool rotates = group.vertices.size() > 1 || other.vertices.size() > 1;
    const bool alike = rotates ? group.path.turn() == other.path.turn() && same(group.path.at(1), other.path.at(1))
                               : same(after(group, 1), after(other, 1));
    leader = !alike ? kSeveral : group.vertices.size() > other.vertices.size() ? g : leader;
  }
}

void GroupPaths::go_to(int step) {
  const double at = step == steps_ ? 1 : static_cast<double>(step) / steps_;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    motions_[g] = after(groups_[g], at * groups_[g].fraction);
    rotations_[g] = motions_[g].rotation();
    groups_[g].now = at * groups_[g].fraction;
  }
  for (std::size_t c = 0; c < rigid_motions_.size(); ++c) {
    rigid_motions_[c] = region_.anchored[c] || leader_[c] == kNoGroup ? LocalMotion()
                        : leader_[c] != kSeveral                      ? motions_[leader_[c]]
                                                                      : best_fit(static_cast<int>(c));
    rigid_rotations_[c] = rigid_motions_[c].rotation();
  }
}

LocalMotion GroupPaths::after(const Group& group, double fraction) const {
  LocalMotion motion = group.path.at(fraction);
  if (group.vertices.size() == 1) {
    motion.translation = motion.displacement(group.centre);
    motion.linear.setZero();
  }
  return motion;
}

Vector3 GroupPaths::displacement(int group, const Vector3& position, const Vector3& offset) const {
  const Vector3 moved = groups_[group].now * offset;
  return motions_[group].displacement(position + moved) + moved;
}

Vector3 GroupPaths::displacement(int i) const {
  return displacement(region_.group[i], rest_.row(i).transpose(), target_offset(i));
}

Vector3 GroupPaths::target_offset(int i) const {
  const Group& group = groups_[region_.group[i]];
  return group.offsets.rows() > 0 ? group.offsets.row(index_[i]).transpose().eval() : Vector3::Zero().eval();
}

double GroupPaths::degrees(std::size_t group) const {
  return std::abs(groups_[group].fraction) * groups_[group].path.turn().norm();
}

bool GroupPaths::stays(std::size_t group) const {
  const Group& one = groups_[group];
  return one.offsets.rows() == 0 && one.path.at(1).none() && one.path.turn().isZero(0);
}

bool GroupPaths::mirrors(std::size_t group) const {
  const Group& one = groups_[group];
  return one.offsets.rows() == 0 && lapedit::mirrors(one.path.at(1).linear + Matrix3::Identity());
}

bool GroupPaths::moves_rigidly() const {
  return !std::all_of(rigid_motions_.begin(), rigid_motions_.end(),
                      [](const LocalMotion& motion) { return motion.none(); });
}

bool GroupPaths::revolves() const {
  constexpr double kNearly = 359;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (groups_[g].vertices.size() > 1 && degrees(g) > kNearly) {
      return true;
    }
  }
  return false;
}

void GroupPaths::rotate_hanging(std::vector<Matrix3>& rotations) const {
  for (const int i : hanging_) {
    if (const int g = followed(i); g >= 0) {
      rotations[i] = rotations_[g] * rigid_rotations_[region_.component[i]].transpose();
    }
  }
  for (const int i : unanchored_) {
    if (leader_[region_.component[i]] >= 0) {
      rotations[i].setIdentity();
    }
  }
}

/// Weights vertices by their squared weights, as in the equations.
LocalMotion GroupPaths::best_fit(int component) const {
  const auto for_vertices = [&](const auto& body) {
    for (const int i : held_[component]) {
      const double weight = region_.weight(i);
      body(weight * weight, rest_.row(i).transpose(), displacement(i));
    }
  };
  double count = 0;
  Vector3 mean = Vector3::Zero(), mean_displacement = Vector3::Zero();
  for_vertices([&](double weight, const Vector3& from, const Vector3& moved) {
    count += weight;
    mean += weight * from;
    mean_displacement += weight * moved;
  });
  mean /= count;
  mean_displacement /= count;
  Matrix3 covariance = Matrix3::Zero();
  for_vertices([&](double weight, const Vector3& from, const Vector3& moved) {
    const Vector3 before = from - mean;
    const Matrix3 product = (before + (moved - mean_displacement)) * before.transpose();
    covariance += weight * product;
  });
  LocalMotion fit;
  fit.linear = nearest_rotation(covariance) - Matrix3::Identity();
  fit.translation = mean_displacement - fit.linear * mean;
  return fit;
}

}  // namespace lapedit
