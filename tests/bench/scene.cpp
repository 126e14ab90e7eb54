// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "lapedit/mesh/geodesic.h"

namespace speed {
namespace {

using Flat = Eigen::Vector2d;

constexpr double kPi = 3.14159265358979323846;

/// SplitMix64: the same numbers everywhere, unlike the standard library's distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  int below(int end) { return static_cast<int>(next() % static_cast<std::uint64_t>(end)); }

 private:
  std::uint64_t state_;
};

struct Disc {
  std::vector<Flat> points;  // edge length about 1
  std::vector<std::array<int, 3>> faces;
};

/// The points of a triangular lattice nearest to the origin, row by row, and the lattice's triangles between them.
Disc lattice_disc(int count) {
  const double height = std::sqrt(0.75);
  const int reach = static_cast<int>(std::sqrt(count * height / kPi) * 1.3) + 3;
  struct Candidate {
    double distance;
    int row, column;
  };
  std::vector<Candidate> candidates;
  const auto position = [height](int row, int column) {
    // Off the symmetric place, so that no two distances are the same.
    return Flat(column + 0.5 * row + 0.137, height * row + 0.071);
  };
  for (int row = -reach; row <= reach; ++row) {
    const int shift = static_cast<int>(std::floor(-0.5 * row));
    for (int column = shift - reach; column <= shift + reach; ++column) {
      candidates.push_back({position(row, column).norm(), row, column});
    }
  }
  std::nth_element(candidates.begin(), candidates.begin() + count, candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  candidates.resize(count);
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });

  Disc disc;
  std::unordered_map<std::int64_t, int> number;
  const auto key = [](int row, int column) { return static_cast<std::int64_t>(row) * 1000000 + column; };
  for (const Candidate& c : candidates) {
    number[key(c.row, c.column)] = static_cast<int>(disc.points.size());
    disc.points.push_back(position(c.row, c.column));
  }
  const auto find = [&](int row, int column) {
    const auto at = number.find(key(row, column));
    return at == number.end() ? -1 : at->second;
  };
  for (const Candidate& c : candidates) {
    const int here = find(c.row, c.column), right = find(c.row, c.column + 1);
    const int above = find(c.row + 1, c.column), below = find(c.row - 1, c.column + 1);
    if (right >= 0 && above >= 0) {
      disc.faces.push_back({here, right, above});
    }
    if (right >= 0 && below >= 0) {
      disc.faces.push_back({here, below, right});
    }
  }
  return disc;
}

double cross(const Flat& a, const Flat& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// No angle of a triangle is below about 20 degrees, and it is not flipped.
bool well_shaped(const Flat& a, const Flat& b, const Flat& c) {
  constexpr double kSine = 0.34;
  const double area = cross(b - a, c - a);
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  return area > kSine * std::max({ab * bc, bc * ca, ca * ab}) && area > 0;
}

/// Flips a fraction of the edges, where that leaves well-shaped triangles: valences from 3 to about 9.
void flip_edges(Disc& disc, double fraction, Random& random) {
  std::unordered_map<std::int64_t, int> half_edges;  // directed edge -> 3 * face + corner at its start
  half_edges.reserve(3 * disc.faces.size());
  const auto key = [](int a, int b) { return (static_cast<std::int64_t>(a) << 32) | static_cast<std::uint32_t>(b); };
  const auto enter = [&](int f) {
    for (int k = 0; k < 3; ++k) {
      half_edges[key(disc.faces[f][k], disc.faces[f][(k + 1) % 3])] = 3 * f + k;
    }
  };
  const int faces = static_cast<int>(disc.faces.size());
  for (int f = 0; f < faces; ++f) {
    enter(f);
  }
  const int tries = static_cast<int>(fraction * 1.5 * faces);
  for (int t = 0; t < tries; ++t) {
    const int f = random.below(faces), k = random.below(3);
    const int a = disc.faces[f][k], b = disc.faces[f][(k + 1) % 3], c = disc.faces[f][(k + 2) % 3];
    const auto twin = half_edges.find(key(b, a));
    if (twin == half_edges.end()) {
      continue;
    }
    const int g = twin->second / 3, d = disc.faces[g][(twin->second % 3 + 2) % 3];
    const auto& p = disc.points;
    if (half_edges.count(key(c, d)) || half_edges.count(key(d, c)) || !well_shaped(p[c], p[a], p[d]) ||
        !well_shaped(p[d], p[b], p[c])) {
      continue;
    }
    half_edges.erase(key(a, b));
    half_edges.erase(key(b, a));
    disc.faces[f] = {c, a, d};
    disc.faces[g] = {d, b, c};
    enter(f);
    enter(g);
  }
}

/// New number of each old one: strips of the old order, shuffled.
std::vector<int> shuffled_strips(int count, int strip, Random& random) {
  std::vector<int> starts;
  for (int start = 0; start < count; start += strip) {
    starts.push_back(start);
  }
  for (int i = static_cast<int>(starts.size()) - 1; i > 0; --i) {
    std::swap(starts[i], starts[random.below(i + 1)]);
  }
  std::vector<int> renumbered(count);
  int next = 0;
  for (const int start : starts) {
    for (int i = start; i < std::min(start + strip, count); ++i) {
      renumbered[i] = next++;
    }
  }
  return renumbered;
}

/// Smooth bumps of the disc's own scale, and ripples a few edges long.
double height_at(const Flat& position, double edge) {
  constexpr double kBumps[][4] = {// x, y, width, height
                                  {0.1, 0.2, 0.35, 0.12},   {-0.5, 0.3, 0.2, 0.1},  {0.4, -0.5, 0.25, -0.08},
                                  {-0.3, -0.5, 0.15, 0.07}, {0.6, 0.4, 0.2, -0.06}, {-0.05, -0.1, 0.12, 0.05}};
  double height = 0;
  for (const auto& bump : kBumps) {
    height += bump[3] * std::exp(-(position - Flat(bump[0], bump[1])).squaredNorm() / (bump[2] * bump[2]));
  }
  const Flat wave = position * (2 * kPi / (6 * edge));
  return height +
         0.25 * edge * (std::sin(wave.x()) * std::cos(0.8 * wave.y()) + std::sin(0.45 * (wave.x() + wave.y())));
}

}  // namespace

quality::Problem make_scene(int vertices) {
  Random random(20040607);
  Disc disc = lattice_disc(vertices);
  for (Flat& point : disc.points) {
    const double angle = 2 * kPi * random.unit(), way = 0.25 * std::sqrt(random.unit());
    point += way * Flat(std::cos(angle), std::sin(angle));
  }
  flip_edges(disc, 0.25, random);

  lapedit::TriangleMesh mesh;
  double size = 0;
  for (const Flat& point : disc.points) {
    size = std::max(size, point.norm());
  }
  const std::vector<int> number = shuffled_strips(vertices, 256, random);
  mesh.vertices.resize(vertices, 3);
  int centre = 0;
  for (int i = 0; i < vertices; ++i) {
    const Flat position = disc.points[i] / size;
    mesh.vertices.row(number[i]) << position.x(), position.y(), height_at(position, 1 / size);
    if (disc.points[i].norm() < disc.points[centre].norm()) {
      centre = i;
    }
  }
  for (auto& face : disc.faces) {
    face = {number[face[0]], number[face[1]], number[face[2]]};
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  }
  std::sort(disc.faces.begin(), disc.faces.end());
  mesh.faces.resize(static_cast<Eigen::Index>(disc.faces.size()), 3);
  for (std::size_t f = 0; f < disc.faces.size(); ++f) {
    mesh.faces.row(static_cast<Eigen::Index>(f)) << disc.faces[f][0], disc.faces[f][1], disc.faces[f][2];
  }

  const std::vector<int> handle = {number[centre]};
  const lapedit::Adjacency adjacency = lapedit::build_adjacency(vertices, mesh.faces);
  lapedit::GeodesicSearch search({mesh, adjacency});
  lapedit::RegionSpec spec;
  spec.radius = search.distance(search.run(handle, lapedit::kUnreached).back()) * (1 + 1e-12);
  quality::Problem scene(std::move(mesh), std::move(spec), {handle}, {handle_move(0)});
  if (scene.region.size() != vertices) {
    throw std::runtime_error("the scene has " + std::to_string(scene.region.size()) + " region vertices, not " +
                             std::to_string(vertices));
  }
  return scene;
}

lapedit::Affine handle_move(int frame) {
  const Eigen::Vector3d way(0.1 * std::sin(0.7 * frame + 0.3), 0.1 * std::cos(0.9 * frame),
                            0.25 + 0.1 * std::sin(0.31 * frame));
  return lapedit::Affine(Eigen::Translation3d(way));
}

}  // namespace speed
