// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <tuple>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/edit/edit.h"
#include "lapedit/edit/step_solver.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::connected_pieces_test {
namespace {

/// A ball with a socket, and an eye in it that touches nothing; the head's vertices come first.
struct HeadWithEye {
  static constexpr double kEye = 0.2, kClearance = 0.02;
  const Vector3 socket{0.3, 0, 0.95};
  TriangleMesh mesh;
  int head_vertices = 0;

  HeadWithEye() {
    TriangleMesh head = shapes::icosphere(5), eye = shapes::icosphere(3);
    head_vertices = static_cast<int>(head.vertices.rows());
    for (int v = 0; v < head_vertices; ++v) {
      const Vector3 from = head.vertices.row(v).transpose() - socket;
      if (from.norm() < kEye + kClearance) {  // out through the back
        const Vector3 to = (from.normalized() - 0.9 * socket.normalized()).normalized();
        head.vertices.row(v) = (socket + (kEye + kClearance) * to).transpose();
      }
    }
    eye.vertices *= kEye;
    mesh = shapes::together(head, eye, socket);
  }

  EditStep step(const HandleTransform& transform) const {
    const Adjacency adjacency = support::adjacency_of(mesh);
    EditStep made;
    made.region.radius = 1.6;
    made.region.connect_gap = 0.05;
    made.handles.push_back({vertices_within(mesh, adjacency, support::vertex_at(mesh, {0, 0, 1}), 0.08), transform});
    return made;
  }
  Points after(const EditStep& step) const { return support::edited(mesh, support::apply_step(mesh, step)); }
  Points eye(const Points& positions) const { return positions.bottomRows(positions.rows() - head_vertices); }
  /// Mean displacement of the socket.
  Vector3 socket_displacement(const Points& positions) const {
    Vector3 sum = Vector3::Zero();
    int count = 0;
    for (int v = 0; v < head_vertices; ++v) {
      if ((mesh.vertices.row(v).transpose() - socket).norm() < kEye + kClearance + 1e-6) {
        sum += (positions.row(v) - mesh.vertices.row(v)).transpose();
        ++count;
      }
    }
    return sum / count;
  }
};

/// The largest change of a link's length, over that length.
double change_of_links(const TriangleMesh& mesh, const EditStep& step, const Points& after) {
  const Region region = build_region(mesh, support::adjacency_of(mesh), step.region, groups_of(step));
  EXPECT_GT(region.links.size(), 10U);
  double most = 0;
  for (const auto& [i, j] : region.links) {
    const int a = region.mesh_vertex[i], b = region.mesh_vertex[j];
    const double before = (mesh.vertices.row(a) - mesh.vertices.row(b)).norm();
    most = std::max(most, std::abs((after.row(a) - after.row(b)).norm() / before - 1));
  }
  return most;
}

/// The largest distance from the rigid motion that fits best.
double off_rigid(const Points& before, const Points& after) {
  const Points a = before.rowwise() - before.colwise().mean(), b = after.rowwise() - after.colwise().mean();
  const Matrix3 rotation = nearest_rotation(b.transpose() * a);
  return (a * rotation.transpose() - b).rowwise().norm().maxCoeff();
}

/// It takes some of the socket's bending, since it keeps its distance.
TEST(ConnectedPieces, EyeGoesWithItsSocket) {
  const HeadWithEye head;
  const Points rest = head.eye(head.mesh.vertices);
  for (const Vector3& pull : {Vector3(0.1, 0.05, 0.3), Vector3(0.3, 0, -0.1)}) {
    HandleTransform transform;
    transform.translation = pull;
    EditStep step = head.step(transform);
    for (const LaplacianKind kind : {LaplacianKind::MeanValue, LaplacianKind::Cotangent, LaplacianKind::Umbrella}) {
      step.settings.laplacian = kind;
      const Points positions = head.after(step), eye = head.eye(positions);
      ASSERT_TRUE(positions.allFinite());
      const Vector3 way = (eye - rest).colwise().mean().transpose();
      EXPECT_GT(way.norm(), 0.15) << name(kind);
      EXPECT_LT(off_rigid(rest, eye), 0.15 * way.norm()) << name(kind);
      EXPECT_LT(change_of_links(head.mesh, step, positions), 0.02) << name(kind);
      EXPECT_LT((way - head.socket_displacement(positions)).norm(), 0.32 * way.norm()) << name(kind);
    }
    step.region.connect_gap = 0;
    EXPECT_TRUE(support::same_bits(head.eye(head.after(step)), rest)) << "it stays where it is not connected";
  }
}

/// Every setting takes a region of linked pieces, a whole one without anchors too.
TEST(ConnectedPieces, AllSettingsKeepThemFiniteAndTogether) {
  const HeadWithEye head;
  HandleTransform transform;
  transform.translation = Vector3(0, 0, 0.2);
  EditStep step = head.step(transform);
  for (const EditMethod method : {EditMethod::Default, EditMethod::Paper, EditMethod::Linear}) {
    step.settings = EditSettings::of(method);
    const Points positions = head.after(step);
    ASSERT_TRUE(positions.allFinite());
    EXPECT_GT((head.eye(positions) - head.eye(head.mesh.vertices)).col(2).mean(), 0.02) << name(method);
  }
  step = head.step(transform);
  step.region.kind = RegionSpec::Kind::Component;
  const Points positions = head.after(step);
  EXPECT_LT((positions - head.mesh.vertices).rowwise().norm().maxCoeff(), 0.2 + 1e-9) << "it follows as a whole";
  EXPECT_GT((positions - head.mesh.vertices).rowwise().norm().minCoeff(), 0.2 - 1e-9);
}

/// A sheet, and a smaller one above it; they do not fit together.
struct Sheets {
  TriangleMesh mesh;
  int below = 0;  ///< vertices of the lower one, which come first
  double length = 0, width = 0;

  Sheets(int n, double gap) {
    const TriangleMesh low = shapes::grid(n, 3 * n);
    below = static_cast<int>(low.vertices.rows());
    width = low.vertices.col(0).maxCoeff();
    length = low.vertices.col(1).maxCoeff();
    if (width > length) {
      ADD_FAILURE();
    }
    const int x = n / 5, y = n / 3;
    mesh = shapes::together(low, shapes::grid(n / 2, 2 * n), Vector3(0.3 + x, 0.4 + y, gap));
  }
  std::vector<int> end(bool far) const {
    return support::vertices_where(mesh, [&](const Vector3& p) { return far ? p[1] > length - 1.5 : p[1] < 1.5; });
  }
  /// Whether each upper vertex is above the triangles of the lower vertex that it is linked to.
  bool lies_above(const EditStep& step, const Points& after) const {
    const Region region = build_region(mesh, support::adjacency_of(mesh), step.region, groups_of(step));
    const auto normal_at = [&](int v) {
      Vector3 sum = Vector3::Zero();
      for (const auto& face : mesh.faces.rowwise()) {
        if (face[0] == v || face[1] == v || face[2] == v) {
          const Vector3 a = after.row(face[0]), b = after.row(face[1]), c = after.row(face[2]);
          sum += (b - a).cross(c - a);
        }
      }
      return sum;
    };
    const double up = normal_of_first()[2];
    for (std::size_t k = 0; k < region.links.size(); k += 7) {
      const auto& [i, j] = region.links[k];
      const int a = region.mesh_vertex[i], b = region.mesh_vertex[j];
      if (up * normal_at(a).dot((after.row(b) - after.row(a)).transpose()) <= 0) {
        return false;
      }
    }
    return true;
  }
  Vector3 normal_of_first() const {
    const Vector3 a = mesh.vertices.row(mesh.faces(0, 0)), b = mesh.vertices.row(mesh.faces(0, 1)),
                  c = mesh.vertices.row(mesh.faces(0, 2));
    return (b - a).cross(c - a).normalized();
  }
};

struct Motion {
  const char* name;
  HandleTransform transform;
};

std::vector<Motion> motions(const Sheets& sheets) {
  const auto turn = [&](double degrees, const Vector3& axis) {
    HandleTransform transform;
    transform.degrees = degrees;
    transform.axis = axis;
    transform.center = Vector3(sheets.width / 2, sheets.length / 2, 0);
    return transform;
  };
  const auto move = [&](const Vector3& by) {
    HandleTransform transform;
    transform.translation = by * sheets.length;
    return transform;
  };
  return {{"bent up", turn(90, Vector3::UnitX())},  {"bent down", turn(-120, Vector3::UnitX())},
          {"twisted", turn(100, Vector3::UnitY())}, {"stretched", move({0, 0.5, 0})},
          {"sheared", move({0.3, 0, 0})},           {"pulled", move({0, 0, 0.4})}};
}

/// What is linked keeps its distance, whatever is done to it, and stays on its side.
TEST(ConnectedPieces, KeepTheirDistance) {
  std::vector<EditSettings> settings = {EditSettings::of(EditMethod::Default), EditSettings::of(EditMethod::Linear)};
  settings.push_back(settings.back());
  settings.back().order = 2;
  for (const LaplacianKind kind : {LaplacianKind::Cotangent, LaplacianKind::Umbrella}) {
    settings.push_back(settings.front());
    settings.back().laplacian = kind;
  }
  for (const int n : {9, 21}) {
    for (const double gap : {0.01, 0.2, 1.0}) {
      const Sheets sheets(n, gap);
      EditStep step;
      step.region = support::component();
      step.region.connect_gap = 1.2 * std::max(gap, 0.8);
      for (const Motion& motion : motions(sheets)) {
        step.handles = {{sheets.end(false), {}}, {sheets.end(true), motion.transform}};
        for (std::size_t k = 0; k < settings.size(); ++k) {
          step.settings = settings[k];
          const Points after = support::edited(sheets.mesh, support::apply_step(sheets.mesh, step));
          EXPECT_LT(change_of_links(sheets.mesh, step, after), 0.1)
              << n << " " << gap << " " << motion.name << " " << k;
          // Without rotations a surface that turns keeps the direction of its links; and between a bent sheet's
          // vertices its triangles are farther off than the smallest gap.
          if (step.settings.method == EditMethod::Default && gap > 0.1) {
            EXPECT_TRUE(sheets.lies_above(step, after)) << n << " " << gap << " " << motion.name << " " << k;
          }
        }
      }
    }
  }
}

/// The same for a pull at either sheet, and while it is dragged.
TEST(ConnectedPieces, KeepTheirDistanceNextToAHandle) {
  for (const int n : {9, 21}) {
    for (const double gap : {0.01, 0.2, 1.0}) {
      const Sheets sheets(n, gap);
      const double z = sheets.mesh.vertices(sheets.mesh.vertices.rows() - 1, 2);
      for (const double height : {0.0, z}) {
        EditStep step;
        step.region.radius = 0.9 * n;
        step.region.connect_gap = 1.2 * std::max(gap, 0.8);
        const int middle = support::vertex_at(sheets.mesh, {sheets.width / 2, sheets.length / 2, height});
        step.handles = {{vertices_within(sheets.mesh, support::adjacency_of(sheets.mesh), middle, 1.5), {}}};
        step.handles.front().transform.translation = Vector3(0, 0.1, 0.25) * n;
        const Points after = support::edited(sheets.mesh, support::apply_step(sheets.mesh, step));
        EXPECT_LT(change_of_links(sheets.mesh, step, after), 0.1) << n << " " << gap << " " << height;

        StepSolver solver(sheets.mesh,
                          find_region(sheets.mesh, support::adjacency_of(sheets.mesh), step.region, groups_of(step)),
                          step.settings);
        solver.make_cells();
        solver.prepare(sheets.mesh);
        Points frame, framed = sheets.mesh.vertices;
        solver.frame(motions_of(sheets.mesh, step), frame);
        scatter(solver.region().mesh_vertex, frame, framed);
        EXPECT_LT(change_of_links(sheets.mesh, step, framed), 0.15) << n << " " << gap << " " << height << " frame";
      }
    }
  }
}

/// A sheet rolled into a tube whose seam is not quite closed: one piece, with a border on both sides of the seam.
TEST(ConnectedPieces, SeamWithinAPieceStaysClosed) {
  for (const int around : {16, 40}) {
    const int along = around;
    TriangleMesh mesh = shapes::grid(along, around + 1);
    const double wide = mesh.vertices.col(1).maxCoeff() > mesh.vertices.col(0).maxCoeff() ? 1 : 0;
    const int across = wide > 0 ? 1 : 0;
    const double turn = 2 * std::acos(-1.0) / around, radius = 1 / turn;
    std::vector<std::pair<int, int>> seam;
    for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) {
      const double u = mesh.vertices(v, across), w = mesh.vertices(v, 1 - across);
      mesh.vertices.row(v) << radius * std::cos(turn * u), radius * std::sin(turn * u), w;
    }
    for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) {
      for (int w = v + 1; w < static_cast<int>(mesh.vertices.rows()); ++w) {
        if ((mesh.vertices.row(v) - mesh.vertices.row(w)).norm() < 1e-6) {
          seam.emplace_back(v, w);
        }
      }
    }
    ASSERT_EQ(seam.size(), static_cast<std::size_t>(along));
    EditStep step;
    step.region.radius = 0.6 * along;
    step.handles = {{{support::vertex_at(mesh, {radius, 0, along / 2.0})}, {}}};
    step.handles.front().transform.translation = Vector3(0.3 * along, 0, 0);
    const auto crack = [&](double gap) {
      step.region.connect_gap = gap;
      const Points after = support::edited(mesh, support::apply_step(mesh, step));
      double most = 0;
      for (const auto& [v, w] : seam) {
        most = std::max(most, (after.row(v) - after.row(w)).norm());
      }
      return most / (0.3 * along);
    };
    EXPECT_GT(crack(0), 0.3);
    EXPECT_LT(crack(1e-6), 0.001);
    EXPECT_LT(crack(1.3), 0.001) << "longer than an edge";
  }
}

/// A closed pipe wall in one piece, of radius 6 and thickness 0.3, bent by 90 degrees.
TriangleMesh bent_pipe() {
  constexpr int kAround = 40, kAlong = 24;
  constexpr double kRadius = 6, kThickness = 0.3, kBend = 16, kRightAngle = 1.5707963267948966;
  TriangleMesh mesh{Points(2 * kAround * kAlong, 3), Faces(4 * kAround * kAlong, 3)};
  for (int i = 0; i < 2 * kAlong; ++i) {
    const bool outside = i < kAlong;
    const double bend = kRightAngle * (outside ? i : 2 * kAlong - 1 - i) / (kAlong - 1);
    for (int j = 0; j < kAround; ++j) {
      const double angle = 4 * kRightAngle * j / kAround, radius = outside ? kRadius : kRadius - kThickness;
      const double from_axis = kBend + radius * std::cos(angle);
      mesh.vertices.row(i * kAround + j) << from_axis * std::cos(bend), from_axis * std::sin(bend),
          radius * std::sin(angle);
      const int a = i * kAround + j, b = i * kAround + (j + 1) % kAround;
      const int c = (a + kAround) % (2 * kAround * kAlong), d = (b + kAround) % (2 * kAround * kAlong);
      mesh.faces.row(2 * a) << a, b, d;
      mesh.faces.row(2 * a + 1) << a, d, c;
    }
  }
  return mesh;
}

TEST(ConnectedPieces, ClosedWallKeepsItsThickness) {
  TriangleMesh plate = shapes::bar(20, 20, 1);
  plate.vertices.col(2) *= 0.2;
  const TriangleMesh pipe = bent_pipe();
  EditStep step;
  step.region.connect_gap = 0.4;
  const double slant = std::sqrt(0.5);
  for (const auto& [mesh, point, normal] : {std::tuple(plate, Vector3(10, 10, 0.2), Vector3(0, 0, 1)),
                                            std::tuple(pipe, Vector3(22 * slant, 22 * slant, 0), Vector3(1, 1, 0))}) {
    step.region.radius = 8;
    step.handles = {{vertices_within(mesh, support::adjacency_of(mesh), nearest_vertex(mesh, point), 1.5), {}}};
    for (const double pull : {3.0, -3.0}) {
      step.handles.front().transform.translation = pull * normal.normalized();
      const Points after = support::edited(mesh, support::apply_step(mesh, step));
      EXPECT_LT(change_of_links(mesh, step, after), 0.1) << mesh.vertices.rows() << " vertices, pull " << pull;
    }
  }
}

TEST(ConnectedPieces, ReportCountsNoTrianglesThatAreNotThere) {
  const HeadWithEye head;
  HandleTransform transform;
  transform.translation = Vector3(0.1, 0.05, 0.3);
  const EditReport report = support::apply_step(head.mesh, head.step(transform)).reports.front();
  EXPECT_EQ(report.uniform_edges, 0);
  EXPECT_EQ(report.flipped, 0);
  EXPECT_EQ(report.folded, 0);
  EXPECT_LT(report.stretch_max, 1);
}

}  // namespace
}  // namespace lapedit::connected_pieces_test
