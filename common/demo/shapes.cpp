// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace lapedit::shapes {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Collects vertices and faces, then makes a mesh of them.
struct Builder {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> faces;

  Builder() = default;
  explicit Builder(const TriangleMesh& mesh) {
    for (int v = 0; v < mesh.vertices.rows(); ++v) vertices.push_back(mesh.vertices.row(v));
    for (int f = 0; f < mesh.faces.rows(); ++f) faces.push_back({mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)});
  }

  int add(const Vector3& p) {
    vertices.push_back(p);
    return static_cast<int>(vertices.size()) - 1;
  }
  void face(int a, int b, int c) { faces.push_back({a, b, c}); }

  TriangleMesh mesh() const {
    TriangleMesh m;
    m.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
    for (std::size_t v = 0; v < vertices.size(); ++v)
      m.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v].transpose();
    m.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t f = 0; f < faces.size(); ++f)
      m.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
    return m;
  }
};

/// Returns a reproducible number in [-1, 1] for each pair of integers.
double noise(int a, int b) {
  std::uint32_t h = static_cast<std::uint32_t>(a) * 0x9E3779B1U ^ static_cast<std::uint32_t>(b) * 0x85EBCA77U;
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12)) * 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<double>(h) / 2147483647.5 - 1;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Adds the faces of a closed tube around the x axis, whose vertices are a pole, rings of `around` vertices and a pole.
/// @param staggered  odd rings are rotated by half a step
TriangleMesh close_tube(Builder b, int around, int rings, bool staggered) {
  auto at = [=](int ring, int k) { return 1 + ring * around + k % around; };
  for (int k = 0; k < around; ++k) b.face(0, at(0, k + 1), at(0, k));
  for (int r = 0; r + 1 < rings; ++r)
    for (int k = 0; k < around; ++k) {
      const bool back = staggered && r % 2 == 1;
      b.face(at(r, k), at(r, k + 1), at(r + 1, back ? k + 1 : k));
      b.face(at(r, back ? k : k + 1), at(r + 1, k + 1), at(r + 1, k));
    }
  const int last = static_cast<int>(b.vertices.size()) - 1;
  for (int k = 0; k < around; ++k) b.face(last, at(rings - 1, k), at(rings - 1, k + 1));
  return b.mesh();
}

using Point2 = Eigen::Vector2d;

double distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Point2 d = b - a;
  const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (p - a - t * d).norm();
}

/// Returns the distance from the strokes of the word SMI, written in [0.5, 3.5] x [0.45, 1.55].
double distance_to_letters(const Point2& p) {
  double nearest = 10;
  auto stroke = [&](double ax, double ay, double bx, double by) {
    nearest = std::min(nearest, distance_to_segment(p, {ax, ay}, {bx, by}));
  };
  // S: two arcs of 270 degrees around (1, 1.275) and (1, 0.725).
  constexpr int kSteps = 16;
  constexpr double kRadius = 0.275;
  auto arc = [&](double cy, double from, double to) {
    for (int k = 0; k < kSteps; ++k) {
      const double s = from + (to - from) * k / kSteps, t = from + (to - from) * (k + 1) / kSteps;
      stroke(1 + kRadius * 1.3 * std::cos(s), cy + kRadius * std::sin(s), 1 + kRadius * 1.3 * std::cos(t),
             cy + kRadius * std::sin(t));
    }
  };
  arc(1.275, 0.1 * kPi, 1.5 * kPi);
  arc(0.725, 0.5 * kPi, -0.9 * kPi);
  // M
  stroke(1.7, 0.45, 1.7, 1.55);
  stroke(1.7, 1.55, 2.05, 0.9);
  stroke(2.05, 0.9, 2.4, 1.55);
  stroke(2.4, 1.55, 2.4, 0.45);
  // I
  stroke(3.05, 0.45, 3.05, 1.55);
  stroke(2.8, 0.45, 3.3, 0.45);
  stroke(2.8, 1.55, 3.3, 1.55);
  return nearest;
}

}  // namespace

TriangleMesh grid(int rows, int columns) {
  Builder b;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) b.add(Vector3(i, j, 0));
  for (int i = 0; i + 1 < rows; ++i)
    for (int j = 0; j + 1 < columns; ++j) {
      const int q = columns * i + j;
      b.face(q, q + columns, q + 1);
      b.face(q + 1, q + columns, q + columns + 1);
    }
  return b.mesh();
}

TriangleMesh bumpy_grid(double height) {
  TriangleMesh m = grid(100, 60);
  for (int i = 9; i < 92; ++i)
    for (int j = 0; j < 60; ++j)
      if (i / 8 % 2 == 0 && j / 8 % 2 == 0) m.vertices(60 * i + j, 2) = height;
  return m;
}

TriangleMesh icosphere(int levels) {
  Builder b;
  const double g = (1 + std::sqrt(5.0)) / 2;
  for (double s : {-1.0, 1.0})
    for (double t : {-g, g})
      for (int axis = 0; axis < 3; ++axis) {
        Vector3 p = Vector3::Zero();
        p[(axis + 1) % 3] = s;
        p[(axis + 2) % 3] = t;
        b.add(p.normalized());
      }
  // The corners of the icosahedron's faces are the triples at mutual distance of one edge.
  const double edge = 2 / std::sqrt(1 + g * g);
  auto adjacent = [&](int i, int j) { return std::abs((b.vertices[i] - b.vertices[j]).norm() - edge) < 0.1; };
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k)
        if (adjacent(i, j) && adjacent(j, k) && adjacent(i, k)) {
          const bool outward = b.vertices[i].dot(b.vertices[j].cross(b.vertices[k])) > 0;
          b.face(i, outward ? j : k, outward ? k : j);
        }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    auto middle = [&](int i, int j) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(i, j), 0);
      if (is_new) entry->second = b.add((b.vertices[i] + b.vertices[j]).normalized());
      return entry->second;
    };
    const auto coarse = std::move(b.faces);
    b.faces.clear();
    for (const auto& [i, j, k] : coarse) {
      const int ij = middle(i, j), jk = middle(j, k), ki = middle(k, i);
      b.face(i, ij, ki);
      b.face(ij, j, jk);
      b.face(ki, jk, k);
      b.face(ij, jk, ki);
    }
  }
  return b.mesh();
}

TriangleMesh cylinder(int around, int rings) {
  Builder b;
  b.add(Vector3::Zero());
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * kPi * k / around;
      b.add(Vector3(4.0 * r / (rings - 1), std::cos(angle), std::sin(angle)));
    }
  b.add(Vector3(4, 0, 0));
  return close_tube(std::move(b), around, rings, false);
}

TriangleMesh bar(int nx, int ny, int nz) {
  Builder b;
  std::map<std::array<int, 3>, int> numbers;
  const std::array<int, 3> cells{nx, ny, nz};
  auto corner = [&](const std::array<int, 3>& p) {
    const auto [entry, is_new] = numbers.try_emplace(p, 0);
    if (is_new) entry->second = b.add(Vector3(p[0], p[1], p[2]));
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (bool far : {false, true})
      for (int i = 0; i < cells[u]; ++i)
        for (int j = 0; j < cells[v]; ++j) {
          auto at = [&](int di, int dj) {
            std::array<int, 3> p{};
            p[axis] = far ? cells[axis] : 0;
            p[u] = i + di;
            p[v] = j + dj;
            return corner(p);
          };
          const int p = at(0, 0), q = at(1, 0), r = at(1, 1), s = at(0, 1);
          b.face(p, far ? q : r, far ? r : q);
          b.face(p, far ? r : s, far ? s : r);
        }
  }
  return b.mesh();
}

TriangleMesh tapered_arm(int around, int along, double depth) {
  constexpr double kLength = 10, kRoot = 1, kTip = 0.3;
  // Profile: quarter circle, straight taper, quarter circle; walked at constant speed.
  const double lengths[3] = {kRoot * kPi / 2, kLength - kRoot - kTip, kTip * kPi / 2};
  const double total = lengths[0] + lengths[1] + lengths[2];
  auto profile = [&](double s) -> Point2 {  // (x, radius)
    if (s < lengths[0]) return {kRoot - kRoot * std::cos(s / kRoot), kRoot * std::sin(s / kRoot)};
    s -= lengths[0];
    if (s < lengths[1]) return {kRoot + s, kRoot + (kTip - kRoot) * s / lengths[1]};
    s -= lengths[1];
    return {kLength - kTip + kTip * std::sin(s / kTip), kTip * std::cos(s / kTip)};
  };
  // A ring has 0.32 of the limb's radius there, and its centre is 0.45 of it from the middle of the lower side.
  auto dent = [&](double x, double radius, double angle) {
    if (x < kRoot || x > kLength - kTip) return 0.0;
    double deepest = 0;
    for (double centre = kRoot + 0.5; centre < kLength - kTip;) {
      const double here = kRoot + (kTip - kRoot) * (centre - kRoot) / lengths[1];
      for (double side : {-0.45, 0.45}) {
        const double across = (std::remainder(angle - 1.5 * kPi, 2 * kPi) - side) * radius;
        const double off = (std::hypot(x - centre, across) - 0.32 * here) / (0.12 * here);
        deepest = std::max(deepest, here * std::exp(-off * off));
      }
      centre += 1.1 * here;
    }
    return deepest;
  };
  Builder b;
  b.add(Vector3::Zero());
  for (int r = 0; r < along; ++r)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * kPi * (k + 0.5 * (r % 2)) / around;
      const Point2 p = profile(total * (r + 1) / (along + 1));
      const double radius = p.y() - depth * dent(p.x(), p.y(), angle);
      b.add(Vector3(p.x(), radius * std::cos(angle), radius * std::sin(angle)));
    }
  b.add(Vector3(kLength, 0, 0));
  return close_tube(std::move(b), around, along, true);
}

TriangleMesh letter_field(int nx, int ny, double height) {
  constexpr double kHalfStroke = 0.1, kFlank = 0.05;
  TriangleMesh m = grid(nx, ny);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      // Border vertices stay on the border.
      const double dx = i == 0 || i == nx - 1 ? 0 : 0.3 * noise(i, j);
      const double dy = j == 0 || j == ny - 1 ? 0 : 0.3 * noise(j + 7919, i);
      const Point2 p(4 * (i + dx) / (nx - 1), 2 * (j + dy) / (ny - 1));
      const double inside = (kHalfStroke + kFlank / 2 - distance_to_letters(p)) / kFlank;
      m.vertices.row(ny * i + j) << p.x(), p.y(), height * smooth_step(inside);
    }
  return m;
}

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b, const Vector3& offset) {
  TriangleMesh m;
  m.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
  m.vertices << a.vertices, b.vertices.rowwise() + offset.transpose();
  m.faces.resize(a.faces.rows() + b.faces.rows(), 3);
  m.faces << a.faces, b.faces.array() + static_cast<int>(a.vertices.rows());
  return m;
}

TriangleMesh two_pieces(int levels) {
  return together(icosphere(levels), icosphere(levels), Vector3(3, 0, 0));
}

TriangleMesh degenerate_grid(int rows, int columns) {
  Builder b(grid(rows, columns));
  auto at = [=](int i, int j) { return columns * i + j; };
  // Duplicated vertices: the faces above the middle row take copies of it, and sliver faces join the two.
  const int seam = rows / 2;
  std::vector<int> copy(static_cast<std::size_t>(columns));
  for (int j = 0; j < columns; ++j) copy[static_cast<std::size_t>(j)] = b.add(b.vertices[at(seam, j)]);
  for (auto& f : b.faces)
    if (*std::max_element(f.begin(), f.end()) >= at(seam + 1, 0))
      for (int& v : f)
        if (v / columns == seam) v = copy[static_cast<std::size_t>(v % columns)];
  for (int j = 0; j + 1 < columns; ++j) {
    b.face(at(seam, j), copy[j], at(seam, j + 1));
    b.face(at(seam, j + 1), copy[j], copy[j + 1]);
  }
  for (int j = 0; j + 2 < columns; j += 3) b.face(at(1, j), at(1, j + 1), at(1, j + 2));  // collinear
  for (int j = 0; j < columns; j += 4) b.face(at(2, j), at(2, j), at(1, j));              // a corner twice
  // Needles: one row of vertices is 1e-7 from the next.
  for (int j = 0; j < columns; ++j) b.vertices[at(rows - 3, j)].x() = rows - 2 - 1e-7;
  for (int k = 0; k < 5; ++k) b.add(Vector3(k, k, 10));  // isolated
  return b.mesh();
}

TriangleMesh non_manifold_grid(int rows, int columns) {
  Builder b(grid(rows, columns));
  const int i = rows / 2;
  std::vector<int> top;
  top.reserve(columns);
  for (int j = 0; j < columns; ++j) top.push_back(b.add(Vector3(i, j, 1)));
  for (int j = 0; j + 1 < columns; ++j) {
    b.face(columns * i + j, columns * i + j + 1, top[j]);
    b.face(columns * i + j + 1, top[j + 1], top[j]);
  }
  // A bow tie: another fan that meets the grid in one corner only.
  const int p = b.add(Vector3(-1, -2, 0)), q = b.add(Vector3(-2, -1, 0));
  b.face(0, q, p);
  return b.mesh();
}

TriangleMesh inconsistent_grid(int rows, int columns) {
  TriangleMesh m = grid(rows, columns);
  for (int f = 0; f < m.faces.rows(); f += 3) std::swap(m.faces(f, 1), m.faces(f, 2));
  return m;
}

}  // namespace lapedit::shapes
