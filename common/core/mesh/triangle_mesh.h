// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lapedit/base/types.h"

namespace lapedit {

/// An indexed triangle mesh. Vertices without a face, faces that name a vertex twice and repeated faces are allowed.
struct TriangleMesh {
  Points vertices;
  Faces faces;
};

/// Checks what every algorithm requires: at least one vertex and face, and all face corners in range. Does not check
/// coordinates, since only the region's have to be finite. O(faces).
/// @throws EditError (EmptyMesh, BadIndex)
void validate(const TriangleMesh& mesh);

/// Returns the 64-bit FNV-1a hash of the vertex count and all face corners in order, as 16 hexadecimal digits.
/// Coordinates are not part of it.
std::string connectivity_checksum(std::size_t vertex_count, const Faces& faces);

/// Keeps the faces whose numbers `keep` accepts, in their order.
template <class Keep>
void keep_faces(Faces& faces, const Keep& keep) {
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (keep(f)) {
      faces.row(count++) = faces.row(f);
    }
  }
  faces.conservativeResize(count, 3);
}

/// Removes the faces that are no part of a surface: those that name a vertex twice, and those with the three vertices
/// of an earlier face, in any order. The others keep their order. Corners have to be in range. O(vertices + faces)
/// @return whether there were any
bool keep_distinct(Faces& faces);

/// Returns the vertices that have a face with three different corners, and finite coordinates. O(vertices + faces)
std::vector<int> usable_vertices(const TriangleMesh& mesh);

/// Returns the normal of a face, twice its area long.
inline Vector3 area_normal(const Points& points, const Faces& faces, Eigen::Index face) {
  const Vector3 a = points.row(faces(face, 0)), b = points.row(faces(face, 1)), c = points.row(faces(face, 2));
  return (b - a).cross(c - a);
}
inline Vector3 area_normal(const TriangleMesh& mesh, int face) {
  return area_normal(mesh.vertices, mesh.faces, face);
}

/// Returns the bounding box of a face with finite corners.
inline Eigen::AlignedBox3d face_box(const Points& points, const Faces& faces, Eigen::Index face) {
  const Vector3 a = points.row(faces(face, 0)), b = points.row(faces(face, 1)), c = points.row(faces(face, 2));
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

/// Returns the bounding box of some vertices with finite coordinates.
Eigen::AlignedBox3d bounding_box(const Points& points, const std::vector<int>& vertices);
/// Returns the bounding box of all finite points; empty if there are none.
Eigen::AlignedBox3d bounding_box(const Points& points);

}  // namespace lapedit
