// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <new>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/contact_search.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {
namespace {

/// Returns the mesh with one vertex at each position, so that faces that touch there share it, unless the edit
/// separates vertices at one position; and each face once.
TriangleMesh joined(const TriangleMesh& mesh, const Points& after) {
  const Weld weld(mesh.vertices);
  bool together = true;
  for (int v = 0; v < static_cast<int>(after.rows()) && !weld.empty(); ++v) {
    together = together && (weld.representative(v) == v || after.row(v) == after.row(weld.representative(v)));
  }
  TriangleMesh result = {mesh.vertices, together ? weld.faces(mesh.faces) : mesh.faces};
  keep_distinct(result.faces);
  return result;
}

}  // namespace

int new_self_intersections(const TriangleMesh& given, const EditResult& result, int threads) {
  Points after = given.vertices;
  scatter(result.vertices, result.positions, after);
  const TriangleMesh before = joined(given, after);
  const Faces& faces = before.faces;
  std::vector<int> moving, still;
  Eigen::AlignedBox3d reach;
  for (int f = 0; f < faces.rows(); ++f) {
    const auto corners = faces.row(f);
    const auto is = [&corners](const auto& condition) {
      return std::any_of(corners.begin(), corners.end(), condition);
    };
    if (is([&](int v) { return !before.vertices.row(v).allFinite() || !after.row(v).allFinite(); })) {
      continue;
    }
    if (is([&](int v) { return after.row(v) != before.vertices.row(v); })) {
      moving.push_back(f);
      reach.extend(face_box(after, faces, f));
    } else {
      still.push_back(f);
    }
  }
  still.erase(
      std::remove_if(still.begin(), still.end(), [&](int f) { return !reach.intersects(face_box(after, faces, f)); }),
      still.end());
  if (moving.empty()) {
    return 0;
  }
  ContactSurface surface(before.vertices, gather(faces, moving));
  if (!still.empty()) {
    surface.set_resting(Points(0, 3), gather(faces, still));
  }
  ThreadPool pool(threads);
  return surface.new_crossings(after, pool);
}

void count_self_intersections(const TriangleMesh& before, EditResult& result, int most_vertices) {
  if (static_cast<int>(result.vertices.size()) > most_vertices || result.reports.empty()) {
    return;
  }
  try {
    result.reports.back().new_intersections = new_self_intersections(before, result);
  } catch (const std::bad_alloc&) {
    // An edit must not fail because memory for a figure is missing.
  }
}

}  // namespace lapedit
