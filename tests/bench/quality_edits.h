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

/// Kinds of edits, which the summary compares one by one.
enum class EditClass {
  Vertex,     ///< one vertex pulled
  Turned,     ///< one group rotated by at most 90 degrees
  FarTurned,  ///< one group rotated by more
  Several,    ///< several groups, or whole components
  Elbow,      ///< a short free joint between two rigid parts
  Support,    ///< an animal that stands on held feet
  Coarse,     ///< some hundred vertices
  Uneven,     ///< half fine and half coarse
  Relief,     ///< details that are as deep as wide, on a bent body
  Survey,     ///< of M. Botsch, O. Sorkine, TVCG 2008
  Other
};

/// An edit that is made on request.
struct NamedEdit {
  const char* name;
  EditClass kind;
  bool quick;  ///< among the handful
  bool real;   ///< on a mesh of the folder with the real ones
  std::function<Edit()> make;
};

const std::vector<NamedEdit>& edits();

}  // namespace quality
