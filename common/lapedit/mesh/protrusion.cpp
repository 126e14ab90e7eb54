// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "lapedit/base/whole_part.h"

namespace lapedit {
namespace {

constexpr int kRadii = 96;

/// Length of the border and area of discs of kRadii radii.
struct Profile {
  double step = 0;
  std::array<double, kRadii + 1> length{}, area{};

  /// Adds the area of a face, and the length in it, that discs cover. @param d  ascending distances of its corners p
  void add(const std::array<double, 3>& d, const std::array<Vector3, 3>& p) {
    const double face = (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    const double span = d[2] - d[0];
    const double widest = span > 0 ? (p[0] + (d[1] - d[0]) / span * (p[2] - p[0]) - p[1]).norm() : 0;
    for (int k = whole_part(std::ceil(d[0] / step), 0, kRadii + 1); k <= kRadii; ++k) {
      const double r = k * step;
      if (r >= d[2]) {
        whole_[k] += face;
        return;
      }
      const bool near = r < d[1];
      const double part = near ? (r - d[0]) / (d[1] - d[0]) : (d[2] - r) / (d[2] - d[1]);
      length[k] += part * widest;
      area[k] += near ? face * part * (r - d[0]) / span : face * (1 - part * (d[2] - r) / span);
    }
  }
  /// Adds each face that a disc covers wholly to this and all larger discs.
  void finish() {
    double sum = 0;
    for (int k = 0; k <= kRadii; ++k) {
      sum += whole_[k];
      area[k] += sum;
    }
  }

 private:
  std::array<double, kRadii + 1> whole_{};
};

}  // namespace

double protrusion_radius(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search,
                         const std::vector<int>& reached, double smallest, double largest, double whole) {
  constexpr double kNarrow = 0.6, kSpreads = 1.5, kSame = 1.15, kMostOfPiece = 0.25;
  constexpr double kPlane = 12.566370614359172;
  Profile profile;
  profile.step = std::min(largest, reached.empty() ? 0 : search.distance(reached.back())) / kRadii;
  if (!(profile.step > 0)) {
    return 0;
  }
  for (const int v : reached) {
    for (const int f : adjacency.faces[v]) {
      std::array<int, 3> corners{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
      std::sort(corners.begin(), corners.end(),
                [&](int a, int b) { return std::pair(search.distance(a), a) < std::pair(search.distance(b), b); });
      if (corners[0] != v || !(search.distance(corners[2]) < kUnreached)) {
        continue;  // each face once
      }
      std::array<double, 3> d{};
      std::array<Vector3, 3> p;
      for (int k = 0; k < 3; ++k) {
        d[k] = search.distance(corners[k]);
        p[k] = mesh.vertices.row(corners[k]).transpose();
      }
      profile.add(d, p);
    }
  }
  profile.finish();
  double narrowest = kNarrow;
  int last = -1;  // index of the largest radius that is about as narrow
  for (int k = whole_part(std::ceil(smallest / profile.step), 1, kRadii + 1); k <= kRadii; ++k) {
    const double ratio = profile.area[k] > 0 ? profile.length[k] * profile.length[k] / (kPlane * profile.area[k]) : 1;
    if (ratio <= kSame * narrowest) {
      narrowest = std::min(narrowest, ratio);
      last = k;
    } else if (last >= 0 && ratio >= kSpreads * narrowest) {
      return profile.area[last] <= kMostOfPiece * whole ? last * profile.step : 0;
    }
  }
  return 0;
}

}  // namespace lapedit
