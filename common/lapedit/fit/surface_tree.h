// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"

namespace lapedit {

/// The point of a surface that is nearest to another point.
struct NearestPoint {
  int face = -1;                      ///< -1: none within the limit
  double squared = 0;                 ///< squared distance
  Vector3 weights = Vector3::Zero();  ///< barycentric, exactly 0 for corners that the point does not depend on
};

/// A tree of bounding boxes over triangles that finds nearest points. A face that names one vertex three times is a
/// point, so that clouds are surfaces too.
class SurfaceTree {
 public:
  /// Points and faces are not copied and must outlive the object; all corners are finite. O(faces log faces).
  SurfaceTree(const Points& points, const Faces& faces);

  /// Follows the points, which have moved. O(faces).
  void refit(ThreadPool& pool);

  /// Returns the nearest point, on the face of the lowest number of several.
  /// @param hint  a face that may be near, which makes the search faster; -1: none
  NearestPoint nearest(const Vector3& point, int hint = -1) const;

  Vector3 position(const NearestPoint& at) const { return interpolated(points_, at); }
  /// Returns the mean of the corners' rows with the weights of a point.
  Vector3 interpolated(const Points& rows, const NearestPoint& at) const;

 private:
  struct Node {
    Vector3 low, high;
    int first, count;  // of triangles_ in a leaf; count 0: the children are first and first + 1
  };
  struct Triangle {
    Vector3 corners[3];
    int face;
  };
  void split(int node, int first, int last, const Points& centres);
  void enclose(Node& node);
  void try_triangle(const Vector3& point, const Triangle& triangle, NearestPoint& best) const;

  const Points& points_;
  const Faces& faces_;
  std::vector<Triangle> triangles_;  // leaf by leaf
  std::vector<int> order_, slot_;    // the face of each triangle, and the reverse
  std::vector<Node> nodes_;          // parents before children
};

}  // namespace lapedit
