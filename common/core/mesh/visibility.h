// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/camera.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/triangle_mesh.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {

/// The first intersection of a ray with the surface.
struct SurfaceHit {
  Vector3 point;
  int face = -1;
  int vertex = -1;  ///< the corner of the face that is nearest to the point
};

/// Returns the intersection with a face at a distance along the ray, in units of its direction.
SurfaceHit hit_of(const TriangleMesh& mesh, const Ray& ray, int face, double distance);

/// Returns the distance to a face along the ray, in units of its direction; infinity if the ray misses the face, or if
/// a coordinate is NaN. A ray through a vertex or an edge always hits one of the faces there. Source: T. Moeller, B.
/// Trumbore 1997.
double distance_along(const TriangleMesh& mesh, const Ray& ray, int face);

/// Barycentric coordinates down to minus this count as inside a face.
constexpr double kRaySeam = 1e-9;

/// Answers many visibility queries for one pose of a mesh.
class Visibility {
 public:
  /// Builds a tree of boxes over the faces. O(faces log faces). The mesh must outlive the object and must not change.
  explicit Visibility(const TriangleMesh& mesh);

  /// Returns whether one of a vertex's faces shows the viewer a side, if nothing is before it. O(its faces).
  bool shows_side(const Camera& view, const Adjacency& adjacency, int vertex, int side) const;
  /// Returns whether a viewer sees a vertex: the line from the near plane to the vertex meets only faces at the vertex,
  /// and at least one of these shows the given side. The window's borders are ignored.
  /// @param side  1: the outside of the faces, -1: their inside
  /// O(log faces).
  bool sees(const Camera& view, const Adjacency& adjacency, int vertex, int side = 1) const;

  /// Returns the first triangle along a ray, from either side. Triangles without area or with a non-finite corner are
  /// ignored. O(log faces). Allocates nothing.
  /// @param limit   hits at this distance or beyond are ignored, in units of the ray's direction
  /// @param except  faces around this vertex are ignored
  std::optional<SurfaceHit> first_hit(const Ray& ray, double limit = kUnreached, int except = -1) const;

 private:
  const TriangleMesh& mesh_;
  BoxTree faces_;             // those with finite corners
  double same_position_ = 0;  // vertices nearer than this are at the same position: a seam of duplicate vertices
};

/// Returns the vertices that a brush paints on its way between two pixels: those within its radius of the line between
/// them that are visible from the side that was hit and connected through such vertices to a hit, so that a brush does
/// not reach hidden parts. The vertex of a hit counts at any distance. Vertices within about two pixels of each other,
/// in depth as well, hide or show together. Ascending.
/// @param hits    of the surface under the line
/// @param radius  pixels
std::vector<int> brushed_vertices(const TriangleMesh& mesh, const Adjacency& adjacency, const Visibility& visibility,
                                  const Camera& view, const std::vector<SurfaceHit>& hits, const Vector2& from,
                                  const Vector2& to, double radius);

/// Returns the vertices that a viewer sees inside a closed line of pixels, by the even-odd rule. Ascending. O(mesh).
std::vector<int> enclosed_vertices(const TriangleMesh& mesh, const Adjacency& adjacency, const Visibility& visibility,
                                   const Camera& view, const std::vector<Vector2>& line);

}  // namespace lapedit
