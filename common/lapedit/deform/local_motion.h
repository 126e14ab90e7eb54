// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// A map x -> L x + t as "minus identity", about a local origin: keeps a translation of a far-away mesh exact.
struct LocalMotion {
  Matrix3 linear = Matrix3::Zero();       ///< L - I
  Vector3 translation = Vector3::Zero();  ///< displacement of the local origin

  static LocalMotion of(const Affine& map, const Vector3& origin);
  Vector3 displacement(const Vector3& local) const { return linear * local + translation; }
  bool none() const { return linear.isZero(0) && translation.isZero(0); }
};

/// @throws EditError (NoHandle, NotFinite) unless there is a finite map for each of the region's handle groups
void check_targets(const Region& region, const std::vector<Affine>& handles);

/// Scratch of carry_components(), per component.
struct HandlesSeen {
  int count = 0, first_group = -1;
  bool agree = true;  ///< whether all groups turn and stretch alike
};

/// Where each component of a region is carried before anything is solved for: with its anchors, or else by the mean of
/// its groups' maps, in which rotations stay rotations: a linear mean of groups that turn by different angles would
/// shrink what is between them.
/// @param rest  size() x 3, about the origin of the motions. Nothing is allocated after the first call.
void carry_components(const Region& region, const Points& rest, const std::vector<LocalMotion>& targets,
                      const LocalMotion& anchors, std::vector<LocalMotion>& carried, std::vector<HandlesSeen>& seen);

}  // namespace lapedit
