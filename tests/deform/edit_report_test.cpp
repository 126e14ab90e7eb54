// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_report.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "lapedit/deform/edit_quality.h"
#include "lapedit/edit/edit.h"
#include "shapes.h"

namespace lapedit {
namespace {

/// A mesh taken whole, with vertex 0 as its handle.
Region whole(const TriangleMesh& mesh) {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  return build_region(mesh, build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces), spec, {{0}});
}

std::vector<Matrix3> all_turned(const Region& region, const Matrix3& rotation = Matrix3::Identity()) {
  return std::vector<Matrix3>(static_cast<std::size_t>(region.size()), rotation);
}

Matrix3 turn(double radians) {
  return Eigen::AngleAxisd(radians, Vector3(1, 2, 3).normalized()).toRotationMatrix();
}

TEST(EditReport, RigidMotionStretchesNoEdge) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const Region region = whole(mesh);
  const Points moved = (mesh.vertices * turn(1).transpose()).rowwise() + Vector3(1, 2, 3).transpose();
  EXPECT_EQ(edge_stretch(region, mesh.vertices, mesh.vertices).rms, 0);
  EXPECT_LT(edge_stretch(region, mesh.vertices, moved).rms, 1e-14);
}

TEST(EditReport, ScalingStretchesEachEdgeAlike) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const Region region = whole(mesh);
  EXPECT_NEAR(edge_stretch(region, mesh.vertices, 1.25 * mesh.vertices).rms, 0.25, 1e-14);
  EXPECT_NEAR(edge_stretch(region, mesh.vertices, 1.25 * mesh.vertices).largest, 0.25, 1e-14);
  EXPECT_NEAR(edge_stretch(region, mesh.vertices, 0.75 * mesh.vertices).rms, 0.25, 1e-14);
  EXPECT_EQ(edge_stretch(region, mesh.vertices, 0.75 * mesh.vertices).largest, 0);
}

TEST(EditReport, StretchIsTheRootMeanSquareOverTheEdges) {
  const TriangleMesh mesh = shapes::grid(2, 2);  // edges of the square and one diagonal
  const Region region = whole(mesh);
  Points after = mesh.vertices;
  after.col(0) *= 3;
  const double diagonal = std::sqrt(10.0) / std::sqrt(2.0) - 1;
  EXPECT_NEAR(edge_stretch(region, mesh.vertices, after).rms, std::sqrt((2 * 4 + 0 + 0 + diagonal * diagonal) / 5),
              1e-14);
}

TEST(EditReport, EdgesWithoutLengthAreLeftOut) {
  const TriangleMesh mesh = shapes::grid(2, 2);
  const Region region = whole(mesh);
  Points before = mesh.vertices;
  before.row(1) = before.row(0);
  Points after = before;
  after.row(1) += Vector3(0, 0, 1e-9).transpose();
  EXPECT_LT(edge_stretch(region, before, after).rms, 1e-9);
  EXPECT_EQ(edge_stretch(region, Points::Zero(4, 3), mesh.vertices).rms, 0);
  after = 2 * before;
  EXPECT_NEAR(edge_stretch(region, before, after).rms, 1, 1e-14);
}

TEST(EditReport, TurnedTrianglesAreFlippedUnlessTheirDetailTurned) {
  const TriangleMesh mesh = shapes::grid(5, 6);
  const Region region = whole(mesh);
  const int all = static_cast<int>(mesh.faces.rows());
  for (const double degrees : {0.0, 80.0, 100.0, 180.0}) {
    const Matrix3 rotation = Eigen::AngleAxisd(degrees * 3.14159265358979323846 / 180, Vector3(0.6, 0.8, 0)).matrix();
    const Points turned = mesh.vertices * rotation.transpose();
    EXPECT_EQ(flipped_triangles(region, mesh.vertices, turned, all_turned(region, rotation)), 0) << degrees;
    EXPECT_EQ(flipped_triangles(region, mesh.vertices, turned, all_turned(region)), degrees > 90 ? all : 0) << degrees;
    EXPECT_EQ(flipped_triangles(region, mesh.vertices, mesh.vertices, all_turned(region, rotation)),
              degrees > 90 ? all : 0)
        << degrees;
  }
}

TEST(EditReport, SingleFoldedTriangleIsCounted) {
  const TriangleMesh mesh = shapes::grid(3, 3);
  const Region region = whole(mesh);
  Points after = mesh.vertices;
  after.row(0) = Vector3(2, 2, 0).transpose();  // the corner folded over its only triangle
  EXPECT_EQ(flipped_triangles(region, mesh.vertices, after, all_turned(region)), 1);
}

TEST(EditReport, TrianglesWithoutAreaAreNotFlipped) {
  const TriangleMesh mesh = shapes::grid(3, 3);
  const Region region = whole(mesh);
  EXPECT_EQ(flipped_triangles(region, Points::Zero(9, 3), mesh.vertices, all_turned(region)), 0);
  EXPECT_EQ(flipped_triangles(region, mesh.vertices, Points::Zero(9, 3), all_turned(region)), 0);
}

class ReportOfAnEdit : public testing::Test {
 protected:
  EditReport report(const EditSettings& settings, double lift = 10) {
    EditStep step;
    step.region.radius = 25;
    step.settings = settings;
    step.handles.resize(1);
    step.handles[0].vertices = {50 * 60 + 30, 50 * 60 + 31};
    step.handles[0].transform.translation = {0, 0, lift};
    Edit edit;
    edit.steps = {step};
    return apply_edit(mesh_, edit).reports.at(0);
  }

  const TriangleMesh mesh_ = shapes::bumpy_grid();
};

TEST_F(ReportOfAnEdit, CountsAddUp) {
  const EditReport r = report(EditSettings());
  EXPECT_EQ(r.mesh_vertices, 6000);
  EXPECT_EQ(r.handle, 2);
  EXPECT_GT(r.free, 100);
  EXPECT_GT(r.anchors, 100);
  EXPECT_GT(r.fixed, 100);
  EXPECT_EQ(r.handle + r.free + r.anchors + r.fixed, r.mesh_vertices);
  EXPECT_EQ(r.uniform_edges, 0);
}

TEST_F(ReportOfAnEdit, NumbersAreThoseOfTheEdit) {
  const EditReport r = report(EditSettings());
  EXPECT_NEAR(r.handle_displacement, 10, 1e-12);
  EXPECT_GT(r.handle_residual, 0);
  EXPECT_LT(r.handle_residual, 0.005 * 10);
  EXPECT_GT(r.anchor_residual, 0);
  EXPECT_LT(r.anchor_residual, 1);
  EXPECT_LT(r.normal_equation_residual, 1e-13);  // rounding level
  EXPECT_GT(r.rotation_mean, 1);
  EXPECT_GT(r.rotation_max, r.rotation_mean);
  EXPECT_LT(r.rotation_max, 90);
  EXPECT_GT(r.stretch_rms, 0.01);
  EXPECT_GT(r.normal_radius, 0);
  EXPECT_EQ(r.iterations, 1);
  for (const double ms :
       {r.region_ms, r.operator_ms, r.factor_ms, r.kernel_ms, r.unrotated_ms, r.rotate_ms, r.solve_ms}) {
    EXPECT_GT(ms, 0);
    EXPECT_LT(ms, 60000);
  }
}

TEST_F(ReportOfAnEdit, SettingsAreNamed) {
  EditSettings settings;
  settings.laplacian = LaplacianKind::Cotangent;
  settings.order = 2;
  settings.rotation = DetailRotation::None;
  settings.backend = CholeskyBackend::Eigen;
  const EditReport r = report(settings);
  EXPECT_EQ(r.laplacian, "cotangent");
  EXPECT_EQ(r.order, 2);
  EXPECT_EQ(r.rotation, name(DetailRotation::None));
  EXPECT_NE(r.backend.find("Eigen"), std::string::npos);
  EXPECT_EQ(r.iterations, 0);
  EXPECT_EQ(r.normal_radius, 0);
  EXPECT_EQ(r.rotation_max, 0);
  EXPECT_EQ(r.turning, "vertex");
  EXPECT_EQ(r.rough, "unrotated");
}

TEST_F(ReportOfAnEdit, WhatIsNotTheDefaultIsInTheText) {
  EditSettings settings;
  EXPECT_EQ(report(settings).text().find("turned by"), std::string::npos);
  EXPECT_EQ(report(settings).text().find("first from"), std::string::npos);
  settings.turning = DetailTurning::Edge;
  settings.rough = RoughDeformation::Falloff;
  EXPECT_NE(report(settings).text().find("smooth surface, turned by edge, first from the falloff, 1 pass"),
            std::string::npos);
  settings.rotation = DetailRotation::None;  // nothing is turned
  EXPECT_EQ(report(settings).text().find("turned by"), std::string::npos);
}

TEST_F(ReportOfAnEdit, NothingMovedReportsZero) {
  const EditReport r = report(EditSettings(), 0);
  EXPECT_EQ(r.handle_displacement, 0);
  EXPECT_EQ(r.handle_residual, 0);
  EXPECT_EQ(r.anchor_residual, 0);
  EXPECT_EQ(r.rotation_max, 0);
  EXPECT_EQ(r.stretch_rms, 0);
  EXPECT_EQ(r.flipped, 0);
}

TEST(EditReport, TextHoldsEveryNumber) {
  EditReport r;
  r.mesh_vertices = 90001;
  r.handle = 90002;
  r.free = 90003;
  r.anchors = 90004;
  r.fixed = 90005;
  r.left_out = 90006;
  r.laplacian = "some operator";
  r.rotation = "some rotation";
  r.turning = "some turning";
  r.rough = "some way";
  r.backend = "some backend";
  r.order = 3;
  r.iterations = 7;
  r.passes_dropped = 90010;
  r.normal_radius = 0.00125;
  r.uniform_edges = 90007;
  r.region_ms = 101.5;
  r.operator_ms = 102.5;
  r.factor_ms = 103.5;
  r.kernel_ms = 104.5;
  r.unrotated_ms = 105.5;
  r.normals_ms = 106.5;
  r.rotate_ms = 107.5;
  r.solve_ms = 108.5;
  r.normal_equation_residual = 2.5e-17;
  r.handle_displacement = 0.625;
  r.handle_residual = 3.5e-4;
  r.anchor_residual = 4.5e-5;
  r.rotation_mean = 11.5;
  r.rotation_max = 77.5;
  r.stretch_rms = 0.0875;
  r.flipped = 90008;
  const std::string text = r.text();
  for (const char* part :
       {"some turning",  "some way",      "90001",        "90002",   "90003", "90004",   "90005", "90006",
        "some operator", "some rotation", "some backend", "order 3", "7 ",    "0.00125", "90007", "101.5",
        "102.5",         "103.5",         "104.5",        "105.5",   "106.5", "107.5",   "108.5", "2.5e-17",
        "0.625",         "0.00035",       "4.5e-05",      "11.5",    "77.5",  "8.75",    "90008", "90010 of 90017"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in:\n" << text;
  }
  EXPECT_NE(text.back(), '\n');
  EXPECT_LT(text.size(), 4096U);  // MeshLab's log line
}

}  // namespace
}  // namespace lapedit
