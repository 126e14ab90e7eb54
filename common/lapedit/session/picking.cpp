// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/picking.h"

#include <algorithm>

namespace lapedit {
namespace {

/// A press this near to a handle vertex grabs its group.
constexpr double kGrabPixels = 6;

double pixels_away(const Cursor& cursor, const Vector3& position) {
  return (cursor.view.pixel(position) - cursor.pixel).norm();
}

}  // namespace

int group_at(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups,
             const std::optional<SurfaceHit>& hit, const Cursor& cursor, double depth) {
  int found = -1;
  double nearest = kGrabPixels;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const int v : groups[g]) {
      const Vector3 position = mesh.vertices.row(v).transpose();
      if (!cursor.view.in_front(position)) {
        continue;
      }
      const double pixels = pixels_away(cursor, position);
      const double behind = hit ? (position - hit->point).norm() : 0;
      const double reach = std::max(depth, kGrabPixels * cursor.view.pixel_size(position));
      if ((pixels <= nearest && behind <= reach) || (hit && v == hit->vertex)) {
        nearest = pixels;
        found = static_cast<int>(g);
      }
    }
  }
  return found;
}

int curve_point_at(const TriangleMesh& mesh, const HandleCurve& curve, const Cursor& cursor) {
  int found = -1;
  double nearest = kGrabPixels;
  for (std::size_t k = 0; curve.bends() && k < curve.points.size(); ++k) {
    const Vector3 position = mesh.vertices.row(curve.path[curve.points[k]]).transpose();
    const double pixels = cursor.view.in_front(position) ? pixels_away(cursor, position) : kGrabPixels;
    if (pixels < nearest) {
      nearest = pixels;
      found = static_cast<int>(k);
    }
  }
  return found;
}

}  // namespace lapedit
