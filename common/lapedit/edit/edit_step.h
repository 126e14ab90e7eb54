// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"
#include "lapedit/mesh/symmetry.h"

namespace lapedit {

/// Vertices that move together, and how.
struct HandleGroup {
  std::vector<int> vertices;  ///< mesh vertex numbers
  HandleTransform transform;
  std::vector<double> weights = {};  ///< of each vertex, kLeastShare to 1, what handle_weight counts there; empty: 1
};

/// One edit: which part, which handles, how far, with what settings.
struct EditStep {
  RegionSpec region;
  std::vector<HandleGroup> handles;
  EditSettings settings;
  std::optional<MirrorPlane> mirror = {};  ///< handles and region are mirrored across it, see mirrored()
};

/// A sequence of steps with the mesh it was made for.
struct Edit {
  std::optional<int> mesh_vertices, mesh_faces;
  std::string connectivity;  ///< checksum, empty: not given
  std::vector<EditStep> steps;
};

/// Centroid of some vertices. @throws EditError (BadIndex, NoHandle)
Vector3 centroid(const Points& vertices, const std::vector<int>& group);

// Of the handles of a step, one entry per group.
std::vector<std::vector<int>> groups_of(const EditStep& step);
std::vector<std::vector<double>> weights_of(const EditStep& step);
/// Where they go. @throws EditError as centroid() and resolve()
std::vector<Affine> targets(const TriangleMesh& mesh, const EditStep& step, double fraction = 1);

/// Makes the group ascending without duplicates, so that sums over a group do not depend on how it was written; of a
/// vertex that is there twice the larger weight counts. @throws EditError (BadParameter) if there are weights, but not
/// one for each
void sort_group(std::vector<int>& vertices, std::vector<double>& weights);

}  // namespace lapedit
