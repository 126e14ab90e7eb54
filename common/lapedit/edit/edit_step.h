// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
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
  std::vector<double> weights = {};   ///< of each vertex, kLeastShare to 1, what handle_weight counts there; empty: 1
  std::vector<Vector3> targets = {};  ///< of each vertex, in place of the transform; empty: the transform counts
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
/// How they move; targets in ascending order of the vertices. @param fraction  of the path, 0 to 1. @throws EditError
/// as centroid(), resolve() and sort_group(); (BadParameter) as check_handles(); (NotFinite)
std::vector<HandleMotion> motions_of(const TriangleMesh& mesh, const EditStep& step, double fraction = 1);

/// @throws EditError (BadParameter) if a group of one vertex is to be rotated or scaled without a
/// center, or if a group with targets is to be mirrored
void check_handles(const EditStep& step);

/// Makes the group ascending without duplicates, so that sums over a group do not depend on how it was written; of a
/// vertex that is there twice the larger weight counts. @throws EditError (BadParameter) if there are weights, but not
/// one for each
void sort_group(std::vector<int>& vertices, std::vector<double>& weights);
/// The same with its targets. @param number  of the group in its step, for the message. @throws EditError
/// (BadParameter) also if there are targets, but not one for each vertex, or different ones for one vertex
void sort_group(HandleGroup& group, std::size_t number);

}  // namespace lapedit
