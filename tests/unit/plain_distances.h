// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "lapedit/mesh/geodesic.h"

namespace lapedit::support {

/// Lengths of all edges and of all lines of SurfaceLines, found without a search.
class PlainLines {
 public:
  struct Line {
    int from, to;
    double length;
  };

  explicit PlainLines(const TriangleMesh& mesh) : mesh_(mesh) {
    for (int f = 0; f < mesh.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
        faces_[std::minmax(a, b)].push_back(f);
        if (a != b) {
          lines.push_back({a, b, (at(a) - at(b)).norm()});
          lines.push_back({b, a, lines.back().length});
        }
      }
    }
    for (int f = 0; f < mesh.faces.rows(); ++f) {
      const int a = mesh.faces(f, 0), b = mesh.faces(f, 1), c = mesh.faces(f, 2);
      if (a != b && b != c && c != a) {
        add_lines(f, a, b, c);
        add_lines(f, b, c, a);
        add_lines(f, c, a, b);
      }
    }
  }

  std::vector<Line> lines;

 private:
  using Vector2 = Eigen::Vector2d;

  Vector3 at(int v) const { return mesh_.vertices.row(v).transpose(); }
  static double turn(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

  /// Lines from a corner of a face across the edge opposite to it.
  void add_lines(int face, int start, int a, int b) {
    const Vector3 to_a = at(a) - at(start), to_b = at(b) - at(start);
    const double length = to_a.norm();
    const Vector2 in_plane_a(length, 0), in_plane_b(to_a.dot(to_b) / length, to_a.cross(to_b).norm() / length);
    if (turn(in_plane_a, in_plane_b) > 0) {
      go_on(start, face, 0, a, in_plane_a, b, in_plane_b, in_plane_a, in_plane_b);
    }
  }

  /// @param first,last  directions between which the crossed edges leave a view from the start
  void go_on(int start, int face, int weight, int a, const Vector2& in_plane_a, int b, const Vector2& in_plane_b,
             const Vector2& first, const Vector2& last) {
    std::vector<int> behind = faces_.at(std::minmax(a, b));
    const auto third = [&](int next) { return mesh_.faces.row(next).sum() - a - b; };
    behind.erase(std::remove_if(behind.begin(), behind.end(),
                                [&](int next) { return next == face || third(next) == a || third(next) == b; }),
                 behind.end());
    constexpr int kReach = 7, kMostBehind = 3, kBranching = 4;
    weight += behind.size() > 1 ? kBranching : 0;
    if (behind.size() > kMostBehind || weight > kReach) {
      return;
    }
    for (const int next : behind) {
      const int c = third(next);
      if (!at(c).allFinite()) {
        continue;
      }
      const Vector3 ab = at(b) - at(a), ac = at(c) - at(a);
      const Vector2 along = (in_plane_b - in_plane_a) / ab.norm(), outwards(along.y(), -along.x());
      const Vector2 in_plane_c =
          in_plane_a + ac.dot(ab) / ab.norm() * along + ac.cross(ab).norm() / ab.norm() * outwards;
      const double after = turn(first, in_plane_c), before = turn(in_plane_c, last);
      if (after >= 0 && before >= 0) {
        lines.push_back({start, c, in_plane_c.norm()});
      }
      const double squares[] = {ab.squaredNorm(), ac.squaredNorm(), (at(c) - at(b)).squaredNorm()};
      const double thin = *std::min_element(squares, squares + 3) / *std::max_element(squares, squares + 3);
      const int passed = weight + (thin >= 0.6 ? 4 : thin >= 0.199 ? 3 : 1);
      if (passed <= kReach && after > 0) {
        go_on(start, next, passed, a, in_plane_a, c, in_plane_c, first, before > 0 ? in_plane_c : last);
      }
      if (passed <= kReach && before > 0) {
        go_on(start, next, passed, c, in_plane_c, b, in_plane_b, after > 0 ? in_plane_c : first, last);
      }
    }
  }

  const TriangleMesh& mesh_;
  std::map<std::pair<int, int>, std::vector<int>> faces_;
};

/// Distances on a surface by trying all lines again and again (Bellman and Ford).
inline std::vector<double> plain_distances(const TriangleMesh& mesh, const std::vector<int>& seeds) {
  const PlainLines all(mesh);
  std::vector<double> distance(mesh.vertices.rows(), kUnreached);
  for (const int seed : seeds) {
    distance[seed] = 0;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const PlainLines::Line& line : all.lines) {
      const double through = distance[line.from] + line.length;
      if (through < distance[line.to]) {
        distance[line.to] = through;
        changed = true;
      }
    }
  }
  return distance;
}

}  // namespace lapedit::support
