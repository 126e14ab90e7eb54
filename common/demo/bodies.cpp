// SPDX-License-Identifier: GPL-3.0-or-later
#include "bodies.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

namespace lapedit::shapes {
namespace {

/// A cone with round ends. It is added to the body or, if hollow, subtracted, with a smooth transition of length blend.
struct Part {
  Vector3 from, to;
  double from_radius, to_radius;
  double blend = 0.1;
  bool hollow = false;
  Vector3 flat = Vector3(1, 1, 1);  ///< factors of the extents along x, y and z, about from
};

/// Returns the approximate signed distance, negative inside.
double distance(const Part& part, const Vector3& p) {
  const Vector3 way = part.to - part.from;
  const Vector3 at = (p - part.from).cwiseQuotient(part.flat);
  const double length = way.squaredNorm();
  const double t = length > 0 ? std::clamp(at.dot(way) / length, 0.0, 1.0) : 0.0;
  const double radius = part.from_radius + t * (part.to_radius - part.from_radius);
  return ((at - t * way).norm() - radius) * part.flat.minCoeff();
}

double smooth_minimum(double a, double b, double over) {
  const double h = std::max(over - std::abs(a - b), 0.0) / over;
  return std::min(a, b) - h * h * over / 4;
}

class Body {
 public:
  Body(std::vector<Part> parts, double spacing) : parts_(std::move(parts)), spacing_(spacing) {}

  TriangleMesh mesh() const;

 private:
  using Cell = std::array<int, 3>;

  double value(const Vector3& p) const {
    double inside = 1e3;
    for (const Part& part : parts_) {
      const double d = distance(part, p);
      inside = part.hollow ? -smooth_minimum(-inside, d, part.blend) : smooth_minimum(inside, d, part.blend);
    }
    return inside;
  }

  Vector3 onto_surface(Vector3 p) const {
    const double step = 1e-4 * spacing_;
    for (int pass = 0; pass < 4; ++pass) {
      const double here = value(p);
      Vector3 gradient;
      for (int k = 0; k < 3; ++k) gradient[k] = (value(p + step * Vector3::Unit(k)) - here) / step;
      p -= here * gradient / std::max(gradient.squaredNorm(), 0.25);
    }
    return p;
  }

  std::vector<Part> parts_;
  double spacing_;
};

/// Makes surface nets (S. Gibson 1998): a vertex per cell that the surface crosses, a quad per crossed edge of the
/// grid.
TriangleMesh Body::mesh() const {
  std::map<Cell, bool> corners;
  auto is_inside = [&](const Cell& c) {
    const auto [entry, is_new] = corners.try_emplace(c, false);
    if (is_new) entry->second = value(spacing_ * Vector3(c[0], c[1], c[2])) < 0;
    return entry->second;
  };
  auto moved = [](Cell c, int axis, int by) {
    c[static_cast<std::size_t>(axis)] += by;
    return c;
  };
  std::map<Cell, int> numbers;
  std::vector<Cell> cells;
  auto visit = [&](const Cell& c) {
    int count = 0;
    for (int k = 0; k < 8; ++k) count += is_inside({c[0] + (k & 1), c[1] + (k >> 1 & 1), c[2] + (k >> 2)});
    if (count % 8 != 0 && numbers.try_emplace(c, static_cast<int>(cells.size())).second) cells.push_back(c);
  };
  const Vector3 begin = parts_.front().from / spacing_;
  Cell cell{static_cast<int>(begin[0]), static_cast<int>(begin[1]), static_cast<int>(begin[2])};
  while (cells.empty()) visit(cell = moved(cell, 1, 1));
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      for (int by : {-1, 1}) visit(moved(cells[i], axis, by));

  std::vector<Vector3> points;
  points.reserve(cells.size());
  for (const Cell& c : cells) points.push_back(onto_surface(spacing_ * (Vector3(c[0], c[1], c[2]).array() + 0.5)));
  std::vector<std::array<int, 4>> quads;
  std::vector<std::vector<int>> around(cells.size());
  for (const Cell& c : cells)
    for (int axis = 0; axis < 3; ++axis) {
      const bool inside = is_inside(c);
      if (inside == is_inside(moved(c, axis, 1))) continue;
      const int u = (axis + (inside ? 1 : 2)) % 3, v = (axis + (inside ? 2 : 1)) % 3;
      const Cell a = moved(moved(c, u, -1), v, -1);
      quads.push_back({numbers.at(a), numbers.at(moved(a, u, 1)), numbers.at(c), numbers.at(moved(a, v, 1))});
      for (std::size_t k = 0; k < 4; ++k)
        around[static_cast<std::size_t>(quads.back()[k])].push_back(quads.back()[(k + 1) % 4]);
    }
  for (int pass = 0; pass < 12; ++pass)  // spaces vertices evenly on the surface
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vector3 middle = Vector3::Zero();
      for (int other : around[i]) middle += points[static_cast<std::size_t>(other)];
      points[i] = onto_surface((points[i] + middle / static_cast<double>(around[i].size())) / 2);
    }
  TriangleMesh result;
  result.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) result.vertices.row(static_cast<Eigen::Index>(i)) = points[i];
  result.faces.resize(2 * static_cast<Eigen::Index>(quads.size()), 3);
  Eigen::Index f = 0;
  for (const auto& [a, b, c, d] : quads) {
    auto length = [&](int p, int q) {
      return (points[static_cast<std::size_t>(p)] - points[static_cast<std::size_t>(q)]).squaredNorm();
    };
    const bool first = length(a, c) < length(b, d);
    result.faces.row(f++) = first ? Eigen::RowVector3i(a, b, c) : Eigen::RowVector3i(a, b, d);
    result.faces.row(f++) = first ? Eigen::RowVector3i(a, c, d) : Eigen::RowVector3i(b, c, d);
  }
  return result;
}

/// Returns the height of bumps like scales, 0 to 1: near 1 at one point of each cell of a jittered grid of that size.
double scales(const Vector3& p, double size) {
  const Vector3 at = p / size;
  double nearest = 10;
  for (int k = 0; k < 27; ++k) {
    const std::array<long, 3> cell = {std::lround(std::floor(at[0])) + k % 3 - 1,
                                      std::lround(std::floor(at[1])) + k / 3 % 3 - 1,
                                      std::lround(std::floor(at[2])) + k / 9 - 1};
    auto dice = static_cast<unsigned>(cell[0] * 73856093L ^ cell[1] * 19349663L ^ cell[2] * 83492791L);
    Vector3 point;
    for (int axis = 0; axis < 3; ++axis) {
      dice = 1664525U * dice + 1013904223U;
      point[axis] = static_cast<double>(cell[static_cast<std::size_t>(axis)]) + 0.2 + 0.6 * (dice >> 8) / (1U << 24);
    }
    nearest = std::min(nearest, (at - point).squaredNorm());
  }
  return std::max(0.0, 1 - nearest / 0.6);
}

/// Returns the mesh with its vertices sorted by x.
TriangleMesh by_x(const TriangleMesh& mesh) {
  std::vector<int> order(static_cast<std::size_t>(mesh.vertices.rows())), number(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return mesh.vertices(a, 0) < mesh.vertices(b, 0); });
  TriangleMesh result = mesh;
  for (std::size_t k = 0; k < order.size(); ++k) {
    number[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
    result.vertices.row(static_cast<Eigen::Index>(k)) = mesh.vertices.row(order[k]);
  }
  result.faces = mesh.faces.unaryExpr([&](int v) { return number[static_cast<std::size_t>(v)]; });
  return result;
}

Part ball(const Vector3& centre, double radius, double blend) {
  return {centre, centre, radius, radius, blend};
}

Part ellipsoid(const Vector3& centre, double radius, const Vector3& flat, double blend) {
  return {centre, centre, radius, radius, blend, false, flat};
}

Part hollow(const Vector3& centre, double radius, double blend, const Vector3& flat = Vector3(1, 1, 1)) {
  return {centre, centre, radius, radius, blend, true, flat};
}

}  // namespace

TriangleMesh head(double spacing) {
  std::vector<Part> parts = {ellipsoid({0, 0.25, 0}, 1.02, {0.78, 1, 0.92}, 0.1),
                             ellipsoid({0, -0.35, 0.22}, 0.72, {0.85, 1, 0.95}, 0.4),
                             {{0, -0.6, -0.15}, {0, -1.5, -0.25}, 0.42, 0.46, 0.25},
                             {{0, 0.25, 0.88}, {0, -0.13, 1.1}, 0.07, 0.11, 0.14}};
  for (const double side : {-1.0, 1.0}) {
    parts.push_back(hollow({0.33 * side, 0.2, 1.0}, 0.17, 0.15));
    parts.push_back(ball({0.31 * side, 0.2, 0.76}, 0.16, 0.03));
    parts.push_back({{0.15 * side, 0.4, 0.88}, {0.5 * side, 0.4, 0.72}, 0.06, 0.05, 0.15});
    parts.push_back(ball({0.12 * side, -0.17, 1.0}, 0.07, 0.08));
    parts.push_back(ellipsoid({0.86 * side, 0.08, -0.05}, 0.34, {0.42, 1, 0.7}, 0.06));
    parts.push_back(hollow({0.99 * side, 0.1, 0.03}, 0.2, 0.06, {0.5, 1, 0.7}));
  }
  parts.push_back({{-0.2, -0.44, 0.86}, {0.2, -0.44, 0.86}, 0.055, 0.055, 0.08});
  parts.push_back({{-0.16, -0.56, 0.84}, {0.16, -0.56, 0.84}, 0.065, 0.065, 0.06});
  parts.push_back(ball({0, -0.84, 0.72}, 0.16, 0.2));
  return Body(parts, spacing).mesh();
}

TriangleMesh hand() {
  std::vector<Part> parts = {ellipsoid({0, 0, 0}, 0.62, {0.85, 1, 0.35}, 0.1),
                             {{0, -0.4, 0}, {0, -1, 0}, 0.28, 0.26, 0.3, false, {1, 1, 0.75}}};
  const double roots[4] = {-0.4, -0.14, 0.12, 0.36}, lengths[4] = {0.8, 1.0, 1.05, 0.95};
  for (int k = 0; k < 4; ++k) {
    const Vector3 root(roots[k], 0.35, 0);
    const Vector3 way = Vector3(0.28 * roots[k], 1, 0.1).normalized() * lengths[k];
    const Vector3 knuckle = root + 0.55 * way, tip = root + way + Vector3(0, 0.12, -0.06);
    parts.push_back({root, knuckle, 0.13, 0.105, 0.1});
    parts.push_back({knuckle, tip, 0.105, 0.085, 0.03});
    parts.push_back(ball(knuckle + Vector3(0, 0, -0.02), 0.115, 0.05));
  }
  parts.push_back({{0.38, -0.2, 0.03}, {0.72, 0.15, 0.12}, 0.17, 0.12, 0.15});
  parts.push_back({{0.72, 0.15, 0.12}, {0.86, 0.45, 0.15}, 0.12, 0.095, 0.04});
  return Body(parts, 0.024).mesh();
}

TriangleMesh creature() {
  std::vector<Part> parts = {{{-0.8, 0, 0}, {0.8, 0.05, 0}, 0.46, 0.5, 0.1, false, {1, 1, 0.85}},
                             {{0.95, 0.25, 0}, {1.4, 0.9, 0}, 0.34, 0.23, 0.3},
                             {{1.4, 1.0, 0}, {1.95, 0.78, 0}, 0.26, 0.15, 0.15},
                             {{-1.1, 0.15, 0}, {-1.75, 0.1, 0}, 0.12, 0.09, 0.2},
                             {{-1.75, 0.1, 0}, {-2.15, 0.55, 0}, 0.09, 0.06, 0.1}};
  for (const double side : {-1.0, 1.0}) {
    for (const double x : {-0.75, 0.7}) {
      parts.push_back({{x, -0.15, 0.25 * side}, {x + 0.06, -0.75, 0.3 * side}, 0.25, 0.14, 0.2});
      parts.push_back({{x + 0.06, -0.75, 0.3 * side}, {x, -1.25, 0.3 * side}, 0.14, 0.1, 0.05});
      parts.push_back({{x, -1.27, 0.3 * side}, {x + 0.12, -1.29, 0.3 * side}, 0.11, 0.09, 0.05});
    }
    parts.push_back({{1.38, 1.2, 0.12 * side}, {1.26, 1.55, 0.24 * side}, 0.085, 0.07, 0.06});
    parts.push_back({{1.26, 1.55, 0.24 * side}, {1.3, 1.9, 0.3 * side}, 0.07, 0.045, 0.05});
    parts.push_back({{1.28, 1.08, 0.2 * side}, {1.2, 1.18, 0.55 * side}, 0.1, 0.06, 0.06, false, {0.6, 1, 1}});
    parts.push_back(ball({1.62, 1.02, 0.14 * side}, 0.07, 0.04));
  }
  return Body(parts, 0.034).mesh();
}

TriangleMesh dragon() {
  const std::vector<Vector3> spine = {{-3.6, -0.28, 0}, {-3.0, -0.42, 0}, {-2.3, -0.38, 0}, {-1.6, -0.2, 0},
                                      {-0.9, 0, 0},     {0.1, 0.08, 0},   {0.8, 0.1, 0},    {1.4, 0.32, 0},
                                      {1.95, 0.5, 0},   {2.4, 0.6, 0}};
  const std::vector<double> radius = {0.035, 0.07, 0.13, 0.22, 0.4, 0.5, 0.42, 0.26, 0.21, 0.2};
  std::vector<Part> parts = {{spine[4], spine[5], radius[4], radius[5], 0.3, false, {1, 1, 0.85}}};
  for (std::size_t k = 0; k + 1 < spine.size(); ++k) {
    parts.push_back({spine[k], spine[k + 1], radius[k], radius[k + 1], 0.12, false, {1, 1, 0.9}});
    for (const double t : {0.0, 0.34, 0.67}) {  // the ridge
      const double width = radius[k] + t * (radius[k + 1] - radius[k]);
      const Vector3 root = spine[k] + t * (spine[k + 1] - spine[k]) + Vector3(0, 0.85 * width, 0);
      if (k > 0 && k < 8) {
        parts.push_back(
            {root, root + Vector3(-0.08, 0.13 + 0.4 * width, 0), 0.05 + 0.2 * width, 0.022, 0.04, false, {1, 1, 0.45}});
      }
    }
  }
  parts.push_back(ellipsoid({2.52, 0.66, 0}, 0.28, {1, 0.85, 0.85}, 0.15));
  parts.push_back({{2.6, 0.64, 0}, {3.12, 0.54, 0}, 0.2, 0.13, 0.1, false, {1, 0.8, 0.9}});
  parts.push_back({{2.5, 0.48, 0}, {3.02, 0.36, 0}, 0.13, 0.08, 0.03, false, {1, 0.8, 1}});
  for (const double side : {-1.0, 1.0}) {
    for (const double x : {-0.75, 0.62}) {
      parts.push_back({{x, -0.1, 0.3 * side}, {x - 0.08, -0.62, 0.46 * side}, 0.24, 0.14, 0.2});
      parts.push_back({{x - 0.08, -0.62, 0.46 * side}, {x + 0.04, -1.02, 0.5 * side}, 0.14, 0.1, 0.06});
      for (const double toe : {-0.09, 0.0, 0.09}) {
        parts.push_back(
            {{x + 0.04, -1.06, 0.5 * side + toe / 2}, {x + 0.26, -1.1, 0.5 * side + 1.4 * toe}, 0.075, 0.035, 0.04});
      }
    }
    parts.push_back({{2.42, 0.8, 0.14 * side}, {2.1, 0.98, 0.26 * side}, 0.075, 0.06, 0.06});
    parts.push_back({{2.1, 0.98, 0.26 * side}, {1.85, 1.2, 0.28 * side}, 0.06, 0.045, 0.03});
    parts.push_back({{2.6, 0.82, 0.15 * side}, {2.78, 0.78, 0.13 * side}, 0.05, 0.04, 0.06});
    parts.push_back(hollow({2.74, 0.72, 0.23 * side}, 0.07, 0.05));
    parts.push_back(ball({2.72, 0.71, 0.16 * side}, 0.075, 0.03));
    parts.push_back(ball({3.14, 0.62, 0.07 * side}, 0.045, 0.04));
  }
  TriangleMesh mesh = by_x(Body(parts, 0.026).mesh());
  Points normals = Points::Zero(mesh.vertices.rows(), 3);
  for (const auto& f : mesh.faces.rowwise()) {
    const Vector3 a = mesh.vertices.row(f[0]), b = mesh.vertices.row(f[1]), c = mesh.vertices.row(f[2]);
    for (const int v : {f[0], f[1], f[2]}) normals.row(v) += (b - a).cross(c - a);
  }
  normals.rowwise().normalize();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const Vector3 p = mesh.vertices.row(v);
    const double large = std::clamp(1.25 - std::abs(p[0]) / 3, 0.3, 1.0);  // smaller towards head and tail
    const double on_body =
        std::clamp((p[1] + 1.0) / 0.5, 0.0, 1.0) * (p[0] > 2.3 ? std::max(0.0, 1 - (p[0] - 2.3) / 0.3) : 1);
    mesh.vertices.row(v) += 0.028 * large * on_body * scales(p, 0.125) * normals.row(v);
  }
  return mesh;
}

TriangleMesh person() {
  std::vector<Part> parts = {{{0, 0.1, 0}, {0, 0.7, 0}, 0.36, 0.42, 0.1, false, {1, 1, 0.7}},
                             {{0, 0.85, 0}, {0, 1.2, 0}, 0.17, 0.13, 0.2},
                             ellipsoid({0, 1.5, 0.02}, 0.38, {0.85, 1, 0.9}, 0.08),
                             {{0, 1.52, 0.34}, {0, 1.4, 0.42}, 0.03, 0.05, 0.06}};
  for (const double side : {-1.0, 1.0}) {
    parts.push_back({{0.36 * side, 0.8, 0}, {0.68 * side, 0.32, 0}, 0.16, 0.115, 0.14});
    parts.push_back({{0.68 * side, 0.32, 0}, {0.95 * side, -0.12, 0.06}, 0.115, 0.085, 0.05});
    parts.push_back({{0.97 * side, -0.16, 0.07}, {1.06 * side, -0.34, 0.09}, 0.1, 0.075, 0.05, false, {1, 1, 0.7}});
    parts.push_back({{0.93 * side, -0.12, 0.12}, {0.9 * side, -0.28, 0.22}, 0.05, 0.045, 0.05});
    parts.push_back({{0.2 * side, 0, 0}, {0.25 * side, -0.8, 0.03}, 0.23, 0.15, 0.15});
    parts.push_back({{0.25 * side, -0.8, 0.03}, {0.27 * side, -1.5, -0.02}, 0.15, 0.1, 0.06});
    parts.push_back({{0.27 * side, -1.55, 0}, {0.3 * side, -1.6, 0.28}, 0.11, 0.09, 0.06});
    parts.push_back(hollow({0.13 * side, 1.56, 0.4}, 0.08, 0.07));
    parts.push_back(ball({0.125 * side, 1.56, 0.3}, 0.07, 0.02));
    parts.push_back(ellipsoid({0.34 * side, 1.48, 0}, 0.11, {0.4, 1, 0.7}, 0.04));
  }
  parts.push_back({{-0.06, 1.27, 0.3}, {0.06, 1.27, 0.3}, 0.04, 0.04, 0.08});
  return Body(parts, 0.024).mesh();
}

}  // namespace lapedit::shapes
