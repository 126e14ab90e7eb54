// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/handle_transform.h"
#include "lapedit/fit/fit.h"
#include "lapedit/mesh/region.h"
#include "lapedit/mesh/symmetry.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {

/// Vertices given by their positions on the mesh before the first step; see located(). At most one kind is given.
struct VertexQuery {
  struct Disc {
    Vector3 point = Vector3::Zero();
    double radius = 0;  ///< along the surface, model units
  };

  std::vector<Vector3> points;  ///< the vertex nearest to each
  std::optional<Disc> within;   ///< all vertices within the radius of the one nearest to the point
  bool selected = false;        ///< those selected in MeshLab

  bool empty() const { return points.empty() && !within && !selected; }
};

/// The coordinate systems of landmarks, see coordinate_space.h; empty: unknown.
struct LandmarkSpaces {
  std::string points, targets;
  std::string conversion;  ///< made by in_space(), as in "from RAS to LPS"; empty: none
};

/// Vertices that move together, and their motion.
struct HandleGroup {
  std::vector<int> vertices;  ///< mesh vertex numbers
  HandleTransform transform;
  std::vector<double> weights = {};     ///< per vertex, kLeastWeight to 1: factor of handle_weight; empty: 1
  std::vector<Vector3> targets = {};    ///< per vertex, replaces the transform; empty: the transform applies
  std::vector<std::string> names = {};  ///< of the landmarks that vertices and targets come from, or none
  VertexQuery query = {};               ///< replaces vertices until located() finds them
  LandmarkSpaces spaces = {};           ///< of query.points and targets
  double slide = 1;                     ///< of targets in a fit, see FitLandmark
  std::string targets_advice = {};      ///< from located(): why targets are far from the surface, as advice
};

/// A scan that a region is fitted to, in place of a motion of handles.
struct FitStep {
  std::string to;      ///< file, or in MeshLab a layer; empty: half of the way to the mesh's own mirror image
  std::string folder;  ///< of a relative file name
  ScanFitSettings settings;
  std::vector<int> exclude;               ///< mesh vertices that are not drawn to the scan
  std::vector<int> exclude_faces;         ///< of the scan, which the fit does not see
  bool exclude_selected = false;          ///< likewise its selected faces
  std::shared_ptr<const Scan> scan = {};  ///< null until with_scans() reads it
};

/// One step of an edit: region, handles with their motions, settings.
struct EditStep {
  RegionSpec region;
  std::vector<HandleGroup> handles;
  EditSettings settings;
  /// Handles and region are mirrored across it, see mirrored(). Of a fit to the own mirror image; none: found.
  std::optional<MirrorPlane> mirror = {};
  VertexQuery region_query = {};    ///< in place of region.vertices, until they are located
  std::optional<FitStep> fit = {};  ///< handles are landmarks with targets, or none
};

/// Positions of some vertices of a mesh, so that an edit of it can be applied to another mesh of the same object.
struct VertexPositions {
  std::vector<int> vertices;  ///< mesh vertex numbers, ascending
  std::vector<Vector3> points;
};

/// A sequence of steps, with a description of its mesh.
struct Edit {
  std::optional<int> mesh_vertices, mesh_faces;
  std::string connectivity;  ///< checksum, empty: not given
  std::vector<EditStep> steps;
  VertexPositions positions = {};  ///< of the vertices that the steps name; used if the members above are not given

  bool by_position() const {
    return !positions.points.empty() && !mesh_vertices && !mesh_faces && connectivity.empty();
  }
};

/// Returns the centroid of some vertices. @throws EditError (BadIndex, NoHandle)
Vector3 centroid(const Points& vertices, const std::vector<int>& group);

/// Return the vertices and the weights of a step's handles, one entry per group.
std::vector<std::vector<int>> groups_of(const EditStep& step);
std::vector<std::vector<double>> weights_of(const EditStep& step);
/// Returns the motions of the groups, whose vertices have to be sorted. @param fraction  of the path, 0 to 1.
/// @throws EditError as centroid() and resolve(); (BadParameter) as check_handles(), if a path is longer than 1e60, and
///         if the map of a group mirrors but not those of all groups of several vertices, since the surface between
///         them would turn inside out; (NotFinite)
std::vector<HandleMotion> motions_of(const TriangleMesh& mesh, const EditStep& step, double fraction = 1);

/// Computes HandleMotion::targets: one row per vertex, or none if all targets are the vertices' own positions, so that
/// such a group has no motion at all. Allocates nothing for as many rows as before.
void targets_to(const std::vector<int>& vertices, const std::vector<Vector3>& targets, const TriangleMesh& mesh,
                Points& rows);

/// @throws EditError (BadParameter) if a group of one vertex is to be rotated or scaled without a center
void check_handles(const EditStep& step);

/// Returns the step with the representatives of the vertices that it names.
/// @throws EditError (BadParameter) if vertices at one place are in different groups or have different targets
EditStep welded(EditStep step, const Weld& weld);

/// Sorts the group and removes duplicates, so that sums over it do not depend on how it was written. A vertex that is
/// listed twice keeps the larger weight. @param number of the group in its step, for the message.
/// @throws EditError (BadParameter) if there are weights or targets, but not one for each vertex, or different targets
///         for one vertex
void sort_group(HandleGroup& group, std::size_t number);
void sort_group(std::vector<int>& vertices, std::vector<double>& weights, std::size_t number);

}  // namespace lapedit
