// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"

namespace lapedit {

/// The point of a surface that is nearest to another point.
struct NearestPoint {
  int face = -1;
  double squared = 0;                 ///< squared distance
  Vector3 weights = Vector3::Zero();  ///< barycentric, exactly 0 for corners that the point does not depend on
};

/// Returns barycentric coordinates of the point of a triangle abc that is nearest to p. In a triangle without area it
/// is on an edge.
Vector3 nearest_weights(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c);

/// Returns the rows in the order of a space-filling curve (G. Morton 1966), which depends on positions alone.
/// All are finite.
std::vector<int> order_by_position(const Points& points);

/// Returns the principal axes of a surface as columns, the longest first; right- or left-handed. They do not depend on
/// the coordinate system, unless the surface is symmetric, and mirror with the surface.
Matrix3 principal_axes(const Points& points, const Faces& faces);

/// Some points of a surface, evenly by area, with normals; of a cloud every n-th point. They do not depend on numbers,
/// and mirror with the surface.
struct SurfaceSamples {
  Points points, normals;
};

/// Triangles with normals, borders, and a tree of bounding boxes that finds nearest points. A face that names one
/// vertex three times is a point, so a cloud of points is a surface too.
class SurfaceIndex {
 public:
  /// All corners are finite. @param normals  of a cloud; otherwise those of the faces. O(faces log faces)
  SurfaceIndex(Points points, Faces faces, Points normals = {});

  /// Gives the vertices new positions, and recomputes normals. O(faces).
  void move(const Points& points, ThreadPool& pool);

  /// Returns the nearest point, on the face of the lowest number of several.
  /// @param hint  a face that may be near, which makes the search faster; -1: none
  NearestPoint nearest(const Vector3& point, int hint = -1) const;
  /// Likewise, of the points nearer than `limit` that face along `normal`. @return face -1: none
  NearestPoint nearest_facing(const Vector3& point, const Vector3& normal, double cosine, double limit) const;
  Vector3 position(const NearestPoint& at) const { return interpolated(points_, at); }
  Vector3 normal(const NearestPoint& at) const { return interpolated(normals_, at); }  ///< of a length up to 1
  /// Returns whether the surface faces at a nearest point along a unit vector: its normal has at least this cosine to
  /// it.
  bool faces_along(const NearestPoint& at, const Vector3& direction, double cosine) const;
  /// Returns whether a nearest point is on the border, so that the surface may end there.
  bool ends_at(const NearestPoint& at) const;

  bool is_on_border(int vertex) const { return border_[static_cast<std::size_t>(vertex)] != 0; }
  bool has_border() const { return std::find(border_.begin(), border_.end(), 1) != border_.end(); }

  /// @param axes  orthogonal; samples are chosen along its columns
  SurfaceSamples samples(int count, const Matrix3& axes) const;

  const Points& points() const { return points_; }
  const Faces& faces() const { return faces_; }
  const Points& normals() const { return normals_; }  ///< unit length, or zero where undefined
  bool is_cloud() const { return faces_(0, 0) == faces_(0, 1); }

 private:
  struct Node {
    Eigen::Array4f low[3], high[3];  // boxes of the children, by axis
    int child[4];                    // a node, or the complement of a face
    int count;
  };
  int build(int* first, int* last, const Points& centres);
  void enclose(ThreadPool& pool);
  template <class Accept>
  void search(const Vector3& point, int hint, const Accept& accept, NearestPoint& best) const;
  Vector3 interpolated(const Points& rows, const NearestPoint& at) const;

  Points points_;
  Faces faces_;
  Points normals_;
  std::vector<char> border_;  // per vertex
  std::vector<Node> nodes_;   // parents before children
  double reach_ = 0;          // largest absolute coordinate
};

/// Returns the areas of faces; 1 for those of a cloud.
Eigen::VectorXd face_areas(const Points& points, const Faces& faces);

/// Centroid of a surface and its size: sqrt(2) times the RMS distance from the centroid, both by area.
struct SurfaceSize {
  Vector3 centroid;
  double size;
};
SurfaceSize size_of(const Points& points, const Faces& faces);

}  // namespace lapedit
