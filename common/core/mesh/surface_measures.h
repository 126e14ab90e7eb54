// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"
#include "lapedit/mesh/region.h"

// Measures of the surface of a region, or of a mesh. These functions only read.
namespace lapedit {

/// Computes unit vertex normals, area-weighted over the given faces; zero where a vertex has no face with area, or
/// where its faces cancel. Cost: O(faces). The second form keeps its workspace between calls.
void vertex_normals(const Points& points, const Faces& faces, Points& normals);
void vertex_normals(const Points& points, const Faces& faces, Points& normals, Eigen::VectorXd& areas);

/// Returns the area-weighted normal of the surface at some vertices, of any length; zero if undefined.
Vector3 mean_normal(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices);

/// RMS and largest positive value of |after| / |before| - 1 over the region's edges. Edges without length are skipped.
struct EdgeStretch {
  double rms = 0, largest = 0;
  int at = -1;  ///< lower vertex (of the region) of the edge with the largest stretch; -1: none became longer
};
EdgeStretch edge_stretch(const Region& region, const Points& before, const Points& after);

/// How many times as long a triangle became in the direction in which it grew most, and its area before.
struct FaceStretch {
  double factor, area;
};
/// Returns those of the region's faces but for needles, which have hardly any area. Cost: O(faces).
std::vector<FaceStretch> face_stretches(const Region& region, const Points& before, const Points& after);

/// The vertex at which the surface bends most, and by how many degrees more than before, in either direction.
struct Bend {
  double degrees = 0;
  int at = -1;  ///< of the region; -1: there is none
};
/// Searches among the anchors. The bend at a vertex is that of a fold through it with the same sum of edge length times
/// change of angle between the edge's two faces, in which slivers cancel. Cost: O(faces).
Bend bend_at_anchors(const Region& region, const Points& before, const Points& after);

/// Returns whether the normal of a face rotated by more than 90 degrees against the mean of its corners' rotations.
bool is_flipped(const Region& region, Eigen::Index face, const Points& before, const Points& after,
                const std::vector<Matrix3>& rotations);
/// Counts faces whose normal rotated by more than 90 degrees against the mean of its corners' rotations. Degenerate
/// faces are skipped.
int flipped_triangles(const Region& region, const Points& before, const Points& after,
                      const std::vector<Matrix3>& rotations);

/// The volume of the cones from the centroid of a component's border to its faces, cubic model units: the enclosed
/// volume of a closed component, positive if normals point outwards. A rigid motion does not change it. If the border
/// does not move, its change is that of the body's volume.
struct ComponentVolume {
  double volume = 0, area = 0;
  bool is_body = false;  ///< far from flat, and closed or open at so small holes that it has an inside and an outside
};
/// Returns one entry per component of the region. Cost: O(faces).
std::vector<ComponentVolume> component_volumes(const Region& region, const Points& positions);

/// Returns the sum over all components, of which `is_body` says only whether it is far from flat.
ComponentVolume enclosed_volume(const Region& region, const Points& positions);

/// Returns whether a rigid motion takes each component to its new positions, within `rounding` (model units) plus 3e-4
/// of the component's extent, which is too small to be seen. Cost: O(vertices).
bool moved_rigidly(const Region& region, const Points& before, const Points& after, double rounding);

/// Unit normal of a triangle, and the angles at its corners in radians.
struct FaceShape {
  Vector3 normal;
  std::array<double, 3> angles;
};

/// Measures a triangle. @return false if it has no area or a corner that is not finite
bool measure(const std::array<Vector3, 3>& corners, FaceShape& shape);

/// Stretch of a region's edges against the rest pose, for any number of poses.
class VertexStretch {
 public:
  /// @param rest  the whole mesh
  /// Cost: O(region).
  VertexStretch(const Region& region, const Points& rest);

  /// Returns per vertex of the region the edge that has changed its length most: new / rest - 1 if it is
  /// longer, 1 - rest / new if it is shorter, so that twice as long is 1 and half as long -1. Edges of length zero are
  /// ignored; non-finite values become 0; all values are in [-kMost, kMost].
  /// @param pose  one row per vertex of the region
  /// Cost: two visits of each edge; allocates nothing.
  const std::vector<float>& of(const Points& pose);

  static constexpr float kMost = 1e6F;

 private:
  CompressedRows edges_;
  std::vector<float> inverse_rest_;  // 1 / length of each at rest, 0 without one
  std::vector<float> stretch_;
  ThreadPool pool_;
};

}  // namespace lapedit
