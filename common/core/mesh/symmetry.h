// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "lapedit/mesh/region.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {

/// A mirror plane.
struct MirrorPlane {
  Vector3 point = Vector3::Zero();    ///< any of its points, model units
  Vector3 normal = Vector3::UnitX();  ///< any length but zero

  bool operator==(const MirrorPlane& other) const { return point == other.point && normal == other.normal; }
};

/// Returns the map S: x -> x - 2 n (n . (x - p)), n the unit normal and p the point. @throws EditError (NotFinite,
/// BadParameter)
Affine reflection(const MirrorPlane& plane);

/// Returns the plane of the mesh's best mirror symmetry; `std::nullopt` if the mean distance from the mirrored vertices
/// to the nearest vertices exceeds 1 % of the bounding box's diagonal. Candidates are the planes normal to the
/// coordinate axes, which are preferred when equal, and to the axes of inertia, each through the centre of the box and
/// through the centroid; the best are refined. Deterministic. Cost: O(vertices log vertices), some 0.1 s for 100,000.
std::optional<MirrorPlane> find_symmetry(const TriangleMesh& mesh);

/// Returns the mean distance from the mirrored positions of the vertices to the nearest vertices, over the bounding
/// box's diagonal: 0 for a symmetric mesh. Distances of more than 5 % count as 5 %. It is measured on a sample of 2000
/// vertices.
double asymmetry(const TriangleMesh& mesh, const MirrorPlane& plane);
/// Largest asymmetry() of a mesh that counts as symmetric.
constexpr double kSymmetric = 0.01;

/// Mirror images of vertices: of each the vertex nearest to its mirrored position.
class MirrorImages {
 public:
  /// @param mesh  must outlive the object. Cost: O(vertices log vertices + faces). @throws EditError as reflection()
  MirrorImages(const TriangleMesh& mesh, const MirrorPlane& plane);
  const TriangleMesh& mesh() const { return mesh_; }

  /// Returns the image of a vertex; -1: no vertex is nearer to its mirrored position than four mean edges or 2 % of the
  /// bounding box's diagonal.
  int of(int v) const;
  /// A vertex of the image of a set, and the vertex of the set whose image it is; of several the nearest.
  using Pairs = std::vector<std::pair<int, int>>;
  /// Returns the image of each set, ascending. The image of more than one vertex also has the vertices whose own images
  /// are in the set.
  /// @param sets  ascending, without common vertices. @param missing out: the vertices without an image
  /// Cost: O(vertices), however many sets there are.
  std::vector<Pairs> of(const std::vector<std::vector<int>>& sets, std::vector<int>& missing) const;
  /// Returns how far the image is from the mirrored position of the other vertex.
  double distance(const std::pair<int, int>& pair) const;
  /// Returns a set with its image, ascending. @param what names a vertex of it. @throws EditError (BadIndex)
  std::vector<int> joined(std::vector<int> set, const char* what) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<int> usable_;
  Affine mirror_;
  VertexTree tree_;
  double edge_, limit_;
};

/// Returns the region with its mirror image: vertex sets and kept anchors include their images, where these exist; a
/// radius and components follow from the handles. @throws EditError (BadIndex, BadParameter)
RegionSpec mirrored(const MirrorImages& images, const RegionSpec& region);
inline RegionSpec mirrored(const TriangleMesh& mesh, const RegionSpec& region, const MirrorPlane& plane) {
  const bool has_vertices = region.kind == RegionSpec::Kind::Vertices || !region.held.empty();
  return has_vertices ? mirrored(MirrorImages(mesh, plane), region) : region;
}

/// Averages poses of a symmetric region with their mirror images, so that they are symmetric to the last bits; cells
/// and factorisations are not symmetric.
class PoseSymmetry {
 public:
  /// Has no effect if a vertex of the region has no twin within 1e-6 of the mesh's diagonal of its mirrored position.
  PoseSymmetry(const TriangleMesh& mesh, const Region& region, const MirrorPlane& plane);
  void apply(Points& positions) const;  ///< size() x 3; allocates nothing

 private:
  Points rest_;
  Matrix3 mirror_;
  std::vector<int> twin_;  // local; empty: not symmetric
};

}  // namespace lapedit
