// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "lapedit/base/error.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {

/// The refusal of a point that is too far from the surface.
struct OffSurface : EditError {
  using EditError::EditError;
};

/// Finds the vertices of a mesh nearest to points. Only vertices with a face and finite coordinates count.
class VertexFinder {
 public:
  struct Found {
    int vertex;
    double distance;  ///< model units
  };

  /// The mesh has to outlive the object. O(n log n). @throws EditError (NotFinite) if no vertex counts
  explicit VertexFinder(const TriangleMesh& mesh);

  /// Largest distance from a vertex, over the bounding box's diagonal, of a point that counts as on the surface.
  static constexpr double kFar = 0.1;

  /// Returns the nearest vertex, the lowest number of several. @param what  names the point in a refusal
  /// @throws EditError (NotFinite) if the point is not finite; OffSurface (BadParameter) if it is farther from every
  ///         vertex than a tenth of the bounding box's diagonal
  Found on_surface(const Vector3& point, const std::string& what,
                   const std::string& advice = "give a point on the surface") const;
  /// The same at any distance. @throws EditError (NotFinite)
  Found anywhere(const Vector3& point, const std::string& what) const;
  /// Returns whether a point is finite, and a vertex is not farther away than a fraction of the diagonal.
  bool is_near(const Vector3& point, double fraction = kFar) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<int> usable_;
  double diagonal_;
  VertexTree tree_;
};

/// Returns the vertex nearest to the handle point. @throws EditError as VertexFinder
int nearest_vertex(const TriangleMesh& mesh, const Vector3& point);

/// Returns a point as "(x, y, z)".
std::string place_text(const Vector3& point);

}  // namespace lapedit
