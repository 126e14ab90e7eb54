// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace quality {

/// An edit that a user would make.
struct Edit {
  lapedit::TriangleMesh mesh;
  lapedit::RegionSpec region;
  std::vector<std::vector<int>> handles;
  std::vector<lapedit::Affine> maps;  ///< one per handle group
  /// A straight line along which the motion is to be even: see evenness().
  struct Spine {
    lapedit::Vector3 along;
    double from, to;
  };
  std::optional<Spine> spine;
  bool height_field = false;                                    ///< encloses nothing
  lapedit::Vector3 toward = {0.35, -0.8, 0.6}, up = {0, 0, 1};  ///< for a picture: from the mesh to the eye, upwards
};

/// An edit that is made on request.
struct NamedEdit {
  const char* name;
  const char* kind;  ///< which the summary compares one by one
  std::function<Edit()> make;
};

const std::vector<NamedEdit>& edits();

}  // namespace quality
