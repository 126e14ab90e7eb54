// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "shapes.h"

namespace quality {
namespace {

using lapedit::TriangleMesh;
using lapedit::Vector3;
using Field = std::function<double(const Vector3&)>;

constexpr double kPi = 3.14159265358979323846;

/// The smaller one, rounded where they are nearer to each other than k.
double blend(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}
double ball(const Vector3& p, const Vector3& centre, double radius) {
  return (p - centre).norm() - radius;
}
double ellipsoid(const Vector3& p, const Vector3& centre, const Vector3& half) {
  const Vector3 q = p - centre;
  const double a = q.cwiseQuotient(half).norm(), b = q.cwiseQuotient(half.cwiseAbs2()).norm();
  return b > 0 ? a * (a - 1) / b : -half.minCoeff();
}
double capsule(const Vector3& p, const Vector3& a, const Vector3& b, double at_a, double at_b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm() - (at_a + t * (at_b - at_a));
}

/// A number in [-1, 1] for each pair of integers, the same everywhere.
double noise(int a, int b) {
  std::uint32_t h = static_cast<std::uint32_t>(a) * 0x9E3779B1U ^ static_cast<std::uint32_t>(b) * 0x85EBCA77U;
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12)) * 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<double>(h) / 2147483647.5 - 1;
}

TriangleMesh mesh_of(const std::vector<Vector3>& vertices, const std::vector<std::array<int, 3>>& faces) {
  TriangleMesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  }
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    mesh.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  }
  return mesh;
}

/// One vertex in each cell that the surface passes, one square across each edge of the grid that it cuts.
TriangleMesh surface_nets(const Field& distance, const Vector3& low, const Vector3& high, double cell) {
  std::array<int, 3> size{};
  for (int k = 0; k < 3; ++k) {
    size[k] = static_cast<int>(std::ceil((high[k] - low[k]) / cell)) + 1;
  }
  const std::array<int, 3> step{1, size[0], size[0] * size[1]};
  std::vector<double> value(static_cast<std::size_t>(step[2]) * size[2]);
  const auto position = [&](int i, int j, int k) -> Vector3 { return low + cell * Vector3(i, j, k); };
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        value[i + step[1] * j + step[2] * k] = distance(position(i, j, k));
      }
    }
  }
  std::vector<int> number(value.size(), -1);
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> faces;
  for (int k = 0; k + 1 < size[2]; ++k) {
    for (int j = 0; j + 1 < size[1]; ++j) {
      for (int i = 0; i + 1 < size[0]; ++i) {
        const int at = i + step[1] * j + step[2] * k;
        Vector3 sum = Vector3::Zero();
        int cuts = 0;
        for (int a = 0; a < 8; ++a) {
          for (int axis = 0; axis < 3; ++axis) {
            const int b = a | (1 << axis);
            const auto corner = [&](int c) { return at + (c & 1) + step[1] * ((c >> 1) & 1) + step[2] * (c >> 2); };
            const double va = value[corner(a)], vb = value[corner(b)];
            if (b != a && (va < 0) != (vb < 0)) {
              const auto p = position(i + (a & 1), j + ((a >> 1) & 1), k + (a >> 2));
              sum += p + va / (va - vb) * cell * Vector3::Unit(axis);
              ++cuts;
            }
          }
        }
        if (cuts > 0) {
          number[at] = static_cast<int>(vertices.size());
          vertices.emplace_back(sum / cuts);
        }
      }
    }
  }
  for (int k = 1; k + 1 < size[2]; ++k) {
    for (int j = 1; j + 1 < size[1]; ++j) {
      for (int i = 1; i + 1 < size[0]; ++i) {
        const int at = i + step[1] * j + step[2] * k;
        for (int axis = 0; axis < 3; ++axis) {
          const bool inside = value[at] < 0;
          if (inside == (value[at + step[axis]] < 0)) {
            continue;
          }
          const int u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];
          std::array<int, 4> square{number[at], number[at - u], number[at - u - v], number[at - v]};
          if (!inside) {
            std::swap(square[1], square[3]);
          }
          const bool first = (vertices[square[0]] - vertices[square[2]]).squaredNorm() <
                             (vertices[square[1]] - vertices[square[3]]).squaredNorm();
          const int s = first ? 0 : 1;
          faces.push_back({square[s], square[s + 1], square[s + 2]});
          faces.push_back({square[s], square[s + 2], square[(s + 3) % 4]});
        }
      }
    }
  }
  return mesh_of(vertices, faces);
}

/// The half of a mesh with x > 0 and its mirror image. Vertices nearer to the plane x = 0 than the gap are put onto it;
/// no face may cross it.
TriangleMesh mirrored(const TriangleMesh& mesh, double gap) {
  std::vector<int> right(static_cast<std::size_t>(mesh.vertices.rows()), -1), left = right;
  std::vector<Vector3> vertices;
  for (std::size_t v = 0; v < right.size(); ++v) {
    Vector3 p = mesh.vertices.row(static_cast<Eigen::Index>(v));
    if (p.x() > -gap) {
      p.x() = p.x() < gap ? 0 : p.x();
      right[v] = left[v] = static_cast<int>(vertices.size());
      vertices.push_back(p);
      if (p.x() > 0) {
        left[v] = static_cast<int>(vertices.size());
        vertices.emplace_back(-p.x(), p.y(), p.z());
      }
    }
  }
  std::vector<std::array<int, 3>> faces;
  for (const auto& f : mesh.faces.rowwise()) {
    const auto a = static_cast<std::size_t>(f[0]), b = static_cast<std::size_t>(f[1]),
               c = static_cast<std::size_t>(f[2]);
    if (right[a] >= 0 && right[b] >= 0 && right[c] >= 0) {
      faces.push_back({right[a], right[b], right[c]});
      faces.push_back({left[a], left[c], left[b]});
    }
  }
  return mesh_of(vertices, faces);
}

}  // namespace

TriangleMesh level_set(const Field& distance, const Vector3& low, const Vector3& high, double cell) {
  TriangleMesh mesh = surface_nets(distance, low, high, cell);
  const auto adjacency = lapedit::build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  // To the mean of the neighbours, and back to the surface.
  for (int round = 0; round < 6; ++round) {
    const lapedit::Points old = mesh.vertices;
    for (int v = 0; v < old.rows(); ++v) {
      Vector3 p = Vector3::Zero();
      for (const int w : adjacency.neighbours[v]) {
        p += Vector3(old.row(w)) / adjacency.neighbours[v].size();
      }
      for (int newton = 0; newton < 2; ++newton) {
        Vector3 slope;
        const double h = 1e-3 * cell, here = distance(p);
        for (int k = 0; k < 3; ++k) {
          slope[k] = (distance(p + h * Vector3::Unit(k)) - distance(p - h * Vector3::Unit(k))) / (2 * h);
        }
        const Vector3 way = -here / std::max(slope.squaredNorm(), 0.1) * slope;
        p += way * std::min(1.0, cell / std::max(way.norm(), 1e-300));
      }
      mesh.vertices.row(v) = p;
    }
  }
  return mesh;
}

TriangleMesh head_with_ear(double cell) {
  const auto distance = [](const Vector3& p) {
    constexpr double kHalfThickness = 0.05, kRound = 0.045, kHalfWidth = 0.45, kHalfLength = 0.85;
    const double z = p.z() - 1.55;
    // Cupped and bent: how far in front of the ear's middle surface.
    const double front = p.x() - 0.35 * p.y() * p.y() - 0.12 * z * z;
    const double wide = kHalfWidth * (z < 0 ? 1 : 1 - 0.35 * z / kHalfLength);  // pointed
    const double leaf = (std::hypot(p.y() / wide, z / kHalfLength) - 1) * kHalfWidth;
    const double a = std::abs(front) - kHalfThickness + kRound, b = leaf + kRound;
    const double ear = std::min(std::max(a, b), 0.0) + std::hypot(std::max(a, 0.0), std::max(b, 0.0)) - kRound;
    return blend(ball(p, Vector3::Zero(), 1), ear, 0.15);
  };
  return level_set(distance, Vector3(-1.2, -1.2, -1.2), Vector3(1.2, 1.2, 2.6), cell);
}

TriangleMesh body_with_arm(double cell) {
  const auto distance = [](const Vector3& p) {
    const double body = ellipsoid(p, Vector3(-1, 0, 0), Vector3(1.0, 0.8, 1.4));
    double arm = capsule(p, Vector3(-0.2, 0, 0), Vector3(2, 0, 0.0), 0.42, 0.3);
    arm = blend(arm, ellipsoid(p, Vector3(0.9, 0, 0.12), Vector3(0.7, 0.33, 0.36)), 0.2);  // upper arm's muscle
    arm = blend(arm, capsule(p, Vector3(2, 0, 0), Vector3(3.6, 0, 0), 0.3, 0.2), 0.1);
    arm = blend(arm, ellipsoid(p, Vector3(2.5, 0, 0.05), Vector3(0.5, 0.28, 0.28)), 0.15);
    arm = blend(arm, ball(p, Vector3(3.75, 0, 0), 0.33), 0.15);  // fist
    for (int k = 0; k < 4; ++k) {                                // knuckles
      arm = blend(arm, ball(p, Vector3(4.0, 0.18 - 0.12 * k, 0.12), 0.09), 0.05);
    }
    return blend(body, arm, 0.4);
  };
  return level_set(distance, Vector3(-2.2, -1, -1.6), Vector3(4.3, 1, 1.6), cell);
}

TriangleMesh bust(double cell) {
  const auto distance = [](const Vector3& p) {
    double d = ellipsoid(p, Vector3(0, 0, -0.7), Vector3(1.6, 0.7, 0.8));
    d = blend(d, capsule(p, Vector3(0, 0, -0.2), Vector3(0, 0, 1.3), 0.45, 0.38), 0.3);
    double head = ellipsoid(p, Vector3(0, 0, 1.8), Vector3(0.65, 0.75, 0.85));
    head = blend(head, capsule(p, Vector3(0, -0.5, 1.6), Vector3(0, -1.0, 1.5), 0.3, 0.2), 0.2);  // snout
    for (const double side : {-1.0, 1.0}) {
      head = blend(head, ball(p, Vector3(0.28 * side, -0.62, 2.0), 0.12), 0.06);  // eyes
      head = blend(head, capsule(p, Vector3(0.45 * side, 0.1, 2.3), Vector3(0.6 * side, 0.15, 2.85), 0.16, 0.06), 0.1);
    }
    return blend(d, head, 0.2);
  };
  return level_set(distance, Vector3(-1.8, -1.4, -1.7), Vector3(1.8, 1.1, 3.1), cell);
}

TriangleMesh body_with_tail(double cell, Vector3& sting) {
  constexpr int kBeads = 7;
  std::array<Vector3, kBeads> middles;
  std::array<double, kBeads> radii{};
  Vector3 at(1.1, 0, 0.1);
  for (int k = 0; k < kBeads; ++k) {
    radii[k] = 0.4 - 0.03 * k;
    const double angle = 0.25 + 0.28 * k;
    middles[k] = at;
    at += 1.45 * radii[k] * Vector3(std::cos(angle), 0, std::sin(angle));
  }
  const Vector3 tip = at + Vector3(-0.45, 0, 0.45);
  const auto distance = [=](const Vector3& p) {
    double d = ellipsoid(p, Vector3::Zero(), Vector3(1.2, 0.8, 0.5));
    for (int k = 0; k < kBeads; ++k) {
      d = blend(d, ellipsoid(p, middles[k], Vector3(radii[k], 0.9 * radii[k], radii[k])), 0.1);
    }
    return blend(d, capsule(p, middles[kBeads - 1], tip, 0.18, 0.05), 0.08);
  };
  TriangleMesh mesh = level_set(distance, Vector3(-1.4, -1, -0.7), Vector3(4.2, 1, 3.6), cell);
  Eigen::Index nearest = 0;
  (mesh.vertices.rowwise() - (tip + Vector3(-0.1, 0, 0.1)).transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  sting = mesh.vertices.row(nearest);
  return mesh;
}

TriangleMesh symmetric_figure(double cell) {
  const auto distance = [](const Vector3& q) {
    const Vector3 p(std::abs(q.x()), q.y(), q.z());
    double d = ellipsoid(p, Vector3(0, 0, 0.45), Vector3(0.42, 0.3, 0.65));
    d = blend(d, capsule(p, Vector3(0, 0, 0.9), Vector3(0, 0, 1.3), 0.17, 0.14), 0.15);
    d = blend(d, ellipsoid(p, Vector3(0, -0.03, 1.55), Vector3(0.29, 0.33, 0.36)), 0.1);
    d = blend(d, capsule(p, Vector3(0, -0.33, 1.5), Vector3(0, -0.42, 1.45), 0.07, 0.06), 0.06);
    d = blend(d, capsule(p, Vector3(0.33, 0, 0.85), Vector3(0.72, 0, 0.35), 0.15, 0.12), 0.12);
    d = blend(d, capsule(p, Vector3(0.72, 0, 0.35), Vector3(1.0, -0.08, -0.15), 0.12, 0.09), 0.05);
    d = blend(d, ball(p, Vector3(1.05, -0.1, -0.25), 0.13), 0.05);
    d = blend(d, capsule(p, Vector3(0.26, 0, 0), Vector3(0.32, 0, -1.5), 0.19, 0.12), 0.12);
    return blend(d, capsule(p, Vector3(0.32, 0, -1.55), Vector3(0.35, -0.28, -1.58), 0.13, 0.1), 0.06);
  };
  // The middle of a cell is on the plane, so that no square crosses it.
  const double side = (std::ceil(1.3 / cell) + 0.5) * cell;
  return mirrored(level_set(distance, Vector3(-side, -0.7, -1.8), Vector3(side, 0.5, 2.1), cell), 0.25 * cell);
}

TriangleMesh quadruped(double cell) {
  const auto distance = [](const Vector3& q) {
    const Vector3 p(q.x(), std::abs(q.y()), q.z());
    double d = ellipsoid(p, Vector3(0, 0, 0), Vector3(1.3, 0.5, 0.55));
    d = blend(d, capsule(p, Vector3(1.0, 0, 0.2), Vector3(1.75, 0, 1.05), 0.3, 0.18), 0.2);
    d = blend(d, capsule(p, Vector3(1.75, 0, 1.1), Vector3(2.35, 0, 0.8), 0.22, 0.13), 0.1);
    d = blend(d, capsule(p, Vector3(1.68, 0.1, 1.25), Vector3(1.6, 0.16, 1.5), 0.07, 0.04), 0.05);  // ears
    d = blend(d, capsule(p, Vector3(-1.2, 0, 0.3), Vector3(-1.75, 0, -0.6), 0.1, 0.06), 0.1);       // tail
    for (const double x : {0.85, -0.9}) {
      const double back = x > 0 ? 0.06 : -0.12;
      d = blend(d, capsule(p, Vector3(x, 0.28, -0.1), Vector3(x + back, 0.32, -0.85), 0.26, 0.14), 0.15);
      d = blend(d, capsule(p, Vector3(x + back, 0.32, -0.85), Vector3(x, 0.32, -1.55), 0.14, 0.09), 0.05);
      d = blend(d, ellipsoid(p, Vector3(x + 0.05, 0.32, -1.65), Vector3(0.15, 0.12, 0.12)), 0.05);
    }
    return d;
  };
  return level_set(distance, Vector3(-2, -0.8, -1.9), Vector3(2.7, 0.8, 1.7), cell);
}

TriangleMesh half_fine_tube() {
  constexpr int kAround = 16, kTimes = 4, kRings = 20;  // of the coarse half
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> faces;
  const auto ring = [&vertices](double x, int around) {
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * kPi * k / around;
      vertices.emplace_back(x, std::cos(angle), std::sin(angle));
    }
  };
  for (int i = 0; i <= kRings; ++i) {
    ring(8.0 * i / kRings, kAround);
  }
  const int fine = kTimes * kAround, first_fine = (kRings + 1) * kAround;
  for (int i = 1; i <= kTimes * kRings; ++i) {
    ring(8 + 8.0 * i / (kTimes * kRings), fine);
  }
  const auto strip = [&faces](int first, int next, int around) {
    for (int k = 0; k < around; ++k) {
      const int l = (k + 1) % around;
      faces.push_back({first + k, next + l, next + k});
      faces.push_back({first + k, first + l, next + l});
    }
  };
  for (int i = 0; i < kRings; ++i) {
    strip(i * kAround, (i + 1) * kAround, kAround);
  }
  const int last_coarse = kRings * kAround;
  for (int k = 0; k < kAround; ++k) {  // fans from the coarse ring to the fine one
    const int l = (k + 1) % kAround, middle = kTimes * k + kTimes / 2;
    for (int t = 0; t < kTimes; ++t) {
      const int a = kTimes * k + t, b = (a + 1) % fine;
      faces.push_back({last_coarse + (a < middle ? k : l), first_fine + b, first_fine + a});
    }
    faces.push_back({last_coarse + k, last_coarse + l, first_fine + middle});
  }
  for (int i = 0; i + 1 < kTimes * kRings; ++i) {
    strip(first_fine + i * fine, first_fine + (i + 1) * fine, fine);
  }
  return mesh_of(vertices, faces);
}

TriangleMesh tube_with_relief() {
  constexpr double kLength = 16, kDepth = 0.2;
  TriangleMesh mesh = lapedit::shapes::cylinder(128, 320);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double x = mesh.vertices(v, 0) * kLength / 4, angle = std::atan2(mesh.vertices(v, 2), mesh.vertices(v, 1));
    const double radius = std::hypot(mesh.vertices(v, 1), mesh.vertices(v, 2));
    const double bump = 1 + kDepth * std::cos(8 * angle) * std::cos(8 * x);
    mesh.vertices.row(v) << x, radius * bump * std::cos(angle), radius * bump * std::sin(angle);
  }
  return mesh;
}

TriangleMesh uneven_face(int rows, int columns) {
  TriangleMesh mesh = lapedit::shapes::grid(rows, columns);
  const auto spread = [](double t) { return 1.5 * (0.25 * t + 0.75 * t * std::abs(t)); };  // dense in the middle
  const auto bump = [](double x, double y, double cx, double cy, double wx, double wy) {
    return std::exp(-std::pow((x - cx) / wx, 2) - std::pow((y - cy) / wy, 2));
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double dx = i == 0 || i == rows - 1 ? 0 : 0.42 * noise(i, j);
      const double dy = j == 0 || j == columns - 1 ? 0 : 0.42 * noise(j + 7919, i);
      const double x = spread(2 * (i + dx) / (rows - 1) - 1), y = 1.5 * (2 * (j + dy) / (columns - 1) - 1);
      double z = std::sqrt(5 - x * x - y * y) - 1;
      z += 0.45 * bump(x, y, 0, 0, 0.16, 0.28);                                                // nose
      z += 0.08 * (bump(x, y, 0, -0.55, 0.35, 0.06) + bump(x, y, 0, -0.72, 0.3, 0.06));        // lips
      z -= 0.15 * (bump(x, y, 0.42, 0.35, 0.18, 0.12) + bump(x, y, -0.42, 0.35, 0.18, 0.12));  // eyes
      mesh.vertices.row(columns * i + j) << x, y, z;
    }
  }
  // Either diagonal, so that valences vary, where neither turns a face over; obtuse ones stay.
  const auto upward = [&mesh](int a, int b, int c) {
    const auto& p = mesh.vertices;
    return (p(b, 0) - p(a, 0)) * (p(c, 1) - p(a, 1)) > (p(b, 1) - p(a, 1)) * (p(c, 0) - p(a, 0));
  };
  for (int f = 0; f + 1 < mesh.faces.rows(); f += 2) {
    const int q = mesh.faces(f, 0), right = mesh.faces(f, 1), above = mesh.faces(f, 2), over = mesh.faces(f + 1, 2);
    const bool as_it_is = upward(q, right, above) && upward(above, right, over);
    if (upward(q, right, over) && upward(q, over, above) && (!as_it_is || noise(f, 31) > 0)) {
      mesh.faces.row(f) << q, right, over;
      mesh.faces.row(f + 1) << q, over, above;
    }
  }
  return mesh;
}

}  // namespace quality
