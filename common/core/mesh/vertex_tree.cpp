// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_tree.h"

#include "lapedit/base/format_text.h"
#include "lapedit/base/refuse.h"

namespace lapedit {

VertexTree::VertexTree(const Points& points, std::vector<int> vertices, const std::vector<int>* labels)
    : points_(points),
      labels_(labels),
      tree_(
          std::move(vertices), 8, [&points](int v) { return points.row(v).transpose(); },
          [this](int v) { return label(v); }) {}

int VertexTree::nearest(const Vector3& position, double limit) const {
  constexpr double kFar = 1e150;  // its square is finite
  limit = std::min(limit, kFar);
  std::size_t looks = 0;
  const auto any = [](int) { return true; };
  return nearest(position, limit * limit, kNoLabel, any, looks, tree_.items().size() + 1).vertex;
}

VertexFinder::VertexFinder(const TriangleMesh& mesh)
    : mesh_(mesh),
      usable_(usable_vertices(mesh)),
      diagonal_(bounding_box(mesh.vertices, usable_).diagonal().norm()),
      tree_(mesh.vertices, usable_) {
  if (usable_.empty()) {
    refuse_edit(ErrorCause::NotFinite, {},
                "No vertex of a face has three finite coordinates: give a mesh with faces, or repair it.");
  }
}

VertexFinder::Found VertexFinder::anywhere(const Vector3& point, const std::string& what) const {
  if (!point.allFinite()) {
    refuse_edit(ErrorCause::NotFinite, {}, what, " is not finite: give three finite coordinates on the surface.");
  }
  int vertex = tree_.nearest(point);
  if (vertex < 0) {  // so far away that squared distances overflow
    vertex = usable_.front();
  }
  return {vertex, (mesh_.vertices.row(vertex).transpose() - point).stableNorm()};
}

bool VertexFinder::is_near(const Vector3& point, double fraction) const {
  return point.allFinite() && anywhere(point, "The point").distance <= fraction * diagonal_;
}

VertexFinder::Found VertexFinder::on_surface(const Vector3& point, const std::string& what,
                                             const std::string& advice) const {
  const Found found = anywhere(point, what);
  if (found.distance > kFar * diagonal_) {
    throw OffSurface(ErrorCause::BadParameter, what + " " + place_text(point) + " is " + number_text(found.distance) +
                                                   " away from the nearest vertex, number " +
                                                   std::to_string(found.vertex) +
                                                   ", more than a tenth of the mesh's bounding-box diagonal (" +
                                                   number_text(diagonal_) + "): " + advice + ".");
  }
  return found;
}

int nearest_vertex(const TriangleMesh& mesh, const Vector3& point) {
  return VertexFinder(mesh).on_surface(point, "The handle point").vertex;
}

std::string place_text(const Vector3& point) {
  return "(" + number_text(point[0]) + ", " + number_text(point[1]) + ", " + number_text(point[2]) + ")";
}

}  // namespace lapedit
