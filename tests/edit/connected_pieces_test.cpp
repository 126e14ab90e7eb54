// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/edit/edit.h"
#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
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

/// The largest distance from the rigid motion that fits best.
double off_rigid(const Points& before, const Points& after) {
  const Points a = before.rowwise() - before.colwise().mean(), b = after.rowwise() - after.colwise().mean();
  const Matrix3 rotation = nearest_rotation(b.transpose() * a);
  return (a * rotation.transpose() - b).rowwise().norm().maxCoeff();
}

TEST(ConnectedPieces, EyeGoesWithItsSocketNearlyRigidly) {
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
      EXPECT_LT(off_rigid(rest, eye), 0.08 * way.norm()) << name(kind);
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

TEST(ConnectedPieces, ReportCountsNoTrianglesThatAreNotThere) {
  const HeadWithEye head;
  HandleTransform transform;
  transform.translation = Vector3(0.1, 0.05, 0.3);
  const EditReport report = support::apply_step(head.mesh, head.step(transform)).reports.front();
  EXPECT_EQ(report.uniform_edges, 0);
  EXPECT_EQ(report.flipped, 0);
  EXPECT_EQ(report.folded, 0);
}

}  // namespace
}  // namespace lapedit
