// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lapedit/fit/surface_tree.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// What a template is fitted to: a mesh, or points with normals if it has no faces.
struct ScanData {
  TriangleMesh mesh;
  Points normals;  ///< one per vertex, of any length; none: those of the faces
  std::string name = "the scan";
};

/// A surface with normals and borders, for nearest points. Vertices at one place are one.
struct SurfaceShape {
  Points points;
  Faces faces;               ///< with area; of a cloud a face per point, see SurfaceTree
  Points normals;            ///< unit length, or zero where undefined
  std::vector<char> border;  ///< per vertex: whether it is on an edge of one face

  /// Returns whether a nearest point is on the border, so that the surface may end there.
  bool ends_at(const NearestPoint& at) const;
};

/// Some points of a surface, evenly by area, with normals and areas; of a cloud every n-th point.
struct SurfaceSamples {
  Points points, normals;
  std::vector<NearestPoint> at;
};
SurfaceSamples samples_of(const SurfaceShape& surface, int count);

/// A scan in coordinates of its own: its centroid is the origin, its size 1.
class Scan {
 public:
  /// @throws EditError (EmptyMesh, BadParameter, NotFinite) for a scan that is empty, or a cloud without normals
  /// O(vertices log vertices)
  explicit Scan(const ScanData& data);
  Scan(const Scan&) = delete;
  Scan& operator=(const Scan&) = delete;

  const SurfaceShape& surface() const { return surface_; }
  const SurfaceTree& tree() const { return *tree_; }
  bool is_cloud() const { return spacing_ > 0; }
  /// Of a cloud the distance between neighbouring points; 0 of a mesh.
  double spacing() const { return spacing_; }
  const Vector3& origin() const { return origin_; }  ///< model units
  double size() const { return size_; }              ///< model units, see size_of()
  const std::string& name() const { return name_; }

 private:
  SurfaceShape surface_;
  std::unique_ptr<SurfaceTree> tree_;
  Vector3 origin_;
  double size_ = 1, spacing_ = 0;
  std::string name_;
};

/// Centroid of a surface and its size: sqrt(2) times the RMS distance from the centroid, both by area.
struct SurfaceSize {
  Vector3 centroid = Vector3::Zero();
  double size = 0;
};
SurfaceSize size_of(const SurfaceShape& surface);

/// Marks the vertices on edges of a single face.
std::vector<char> border_vertices(Eigen::Index vertices, const Faces& faces);

}  // namespace lapedit
