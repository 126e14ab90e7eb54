// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>

namespace quality {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using lapedit::Faces;
using lapedit::Points;

/// A face's box that remembers the face.
class Box : public CGAL::Box_intersection_d::Box_d<double, 3> {
 public:
  Box(int face, const CGAL::Bbox_3& box) : Box_d(box), face_(face) {}
  int face() const { return face_; }

 private:
  int face_;
};

class Surface {
 public:
  Surface(const Faces& faces, const Points& positions) : faces_(faces), positions_(positions) {}

  Point point(int v) const { return {positions_(v, 0), positions_(v, 1), positions_(v, 2)}; }
  std::array<Point, 3> corners(int f) const { return {point(faces_(f, 0)), point(faces_(f, 1)), point(faces_(f, 2))}; }
  bool has_area(int f) const {
    const auto [a, b, c] = corners(f);
    return !CGAL::collinear(a, b, c);
  }
  Box box(int f) const {
    const auto [a, b, c] = corners(f);
    return {f, a.bbox() + b.bbox() + c.bbox()};
  }
  Kernel::Triangle_3 triangle(int f) const {
    const auto [a, b, c] = corners(f);
    return {a, b, c};
  }

  bool intersect(int f, int g) const {
    std::array<int, 3> of_f{}, of_g{};  // corners: those shared first
    int shared = 0;
    const auto has = [this](int face, int v) {
      return faces_(face, 0) == v || faces_(face, 1) == v || faces_(face, 2) == v;
    };
    const auto sort_corners = [&](int face, int other, std::array<int, 3>& corners) {
      for (int k = 0; k < 3; ++k) {
        corners[k] = faces_(face, k);
      }
      const auto end = std::partition(corners.begin(), corners.end(), [&](int v) { return has(other, v); });
      shared = static_cast<int>(end - corners.begin());
    };
    sort_corners(f, g, of_f);
    sort_corners(g, f, of_g);
    switch (shared) {
      case 0:
        return CGAL::do_intersect(triangle(f), triangle(g));
      case 1:  // they cut each other where the side of one that is not at the common corner cuts the other
        return cuts(of_f[1], of_f[2], g) || cuts(of_g[1], of_g[2], f);
      case 2: {  // folded onto each other
        const Point a = point(of_f[0]), b = point(of_f[1]), c = point(of_f[2]), d = point(of_g[2]);
        return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
      }
      default:
        return true;  // the same face twice
    }
  }

 private:
  bool cuts(int a, int b, int f) const {
    return point(a) != point(b) && CGAL::do_intersect(Kernel::Segment_3(point(a), point(b)), triangle(f));
  }

  const Faces& faces_;
  const Points& positions_;
};

}  // namespace

std::vector<std::pair<int, int>> intersecting_pairs(const Faces& faces, const std::vector<int>& looked_at,
                                                    const Points& positions) {
  const Surface surface(faces, positions);
  std::vector<Box> boxes, others;
  for (int f = 0; f < faces.rows(); ++f) {
    const bool finite = positions.row(faces(f, 0)).allFinite() && positions.row(faces(f, 1)).allFinite() &&
                        positions.row(faces(f, 2)).allFinite();
    if (finite && surface.has_area(f)) {
      (std::binary_search(looked_at.begin(), looked_at.end(), f) ? boxes : others).push_back(surface.box(f));
    }
  }
  std::vector<std::pair<int, int>> result;
  const auto meet = [&](const Box& a, const Box& b) {
    if (surface.intersect(a.face(), b.face())) {
      result.emplace_back(std::minmax(a.face(), b.face()));
    }
  };
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), meet);
  CGAL::box_intersection_d(boxes.begin(), boxes.end(), others.begin(), others.end(), meet);
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace quality
