// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_report.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "lapedit/deform/edit_quality.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::edit_report_test {
namespace {

/// A mesh taken whole, with vertex 0 as its handle.
Region whole(const TriangleMesh& mesh) {
  return build_region(mesh, build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces), support::component(),
                      {{0}});
}

std::vector<Matrix3> all_turned(const Region& region, const Matrix3& rotation = Matrix3::Identity()) {
  return std::vector<Matrix3>(static_cast<std::size_t>(region.size()), rotation);
}

Matrix3 rotation_by(double radians) {
  return Eigen::AngleAxisd(radians, Vector3(1, 2, 3).normalized()).toRotationMatrix();
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

TEST(EditReport, SurfaceTurnedAsAWholeIsNotFolded) {
  const TriangleMesh mesh = shapes::bar(10, 3, 3);
  const Region region = whole(mesh);
  ThreadPool pool(1);
  const Points turned = mesh.vertices * rotation_by(2.5).transpose();
  const std::vector<Matrix3> rotations = surface_rotations(region, mesh.vertices, turned, pool);
  EXPECT_LT(largest_rotation(rotations, all_turned(region, rotation_by(2.5))), 1e-6);
  EXPECT_NEAR(largest_rotation(rotations, {}), 2.5 * 180 / std::acos(-1.0), 1e-6);
  EXPECT_GT(flipped_triangles(region, mesh.vertices, turned, all_turned(region)), 0);
  EXPECT_EQ(flipped_triangles(region, mesh.vertices, turned, rotations), 0);
}

TEST(EditReport, OpenSurfacesChangeTheirVolumeByWhatIsAdded) {
  const TriangleMesh mesh = shapes::grid(3, 3);  // its middle vertex is the tip of six triangles of 1/2 each
  const Region region = whole(mesh);
  Points after = mesh.vertices;
  after(4, 2) += 0.7;
  for (const Vector3& position : {Vector3(0, 0, 0), Vector3(1e3, -1e3, 1e3)}) {
    const Points there = mesh.vertices.rowwise() + position.transpose(), tip = after.rowwise() + position.transpose();
    EXPECT_NEAR(enclosed_volume(region, tip).volume - enclosed_volume(region, there).volume, 0.7, 1e-9);
  }
  // A dome that moves as a whole, border and all, encloses what it did.
  const Points moved = (after * rotation_by(1).transpose()).rowwise() + Vector3(10, 20, 30).transpose();
  EXPECT_NEAR(enclosed_volume(region, moved).volume, enclosed_volume(region, after).volume, 1e-12);
  // So do two of them that move apart.
  TriangleMesh both = shapes::together({after, mesh.faces}, {after, mesh.faces}, Vector3(9, 0, 0));
  const Region region_of_both = support::whole_region(both, {{0}, {9}}, {});
  EXPECT_NEAR(enclosed_volume(region_of_both, both.vertices).volume, 2 * enclosed_volume(region, after).volume, 1e-12);
  both.vertices.bottomRows(9) = moved;
  EXPECT_NEAR(enclosed_volume(region_of_both, both.vertices).volume, 2 * enclosed_volume(region, after).volume, 1e-12);
}

/// Expects advice that has these parts, in their order.
void expect_advice(const EditReport& report, const std::vector<std::string>& parts) {
  const std::string advice = report.advice();
  std::size_t at = 0;
  for (const std::string& part : parts) {
    at = advice.find(part, at);
    ASSERT_NE(at, std::string::npos) << advice << "\nhas no " << part;
  }
}

TEST(AdviceOnAnEdit, NamesTheRemediesInOrder) {
  EditReport r;
  r.new_intersections = 0;
  EXPECT_EQ(r.advice(), "");
  r.new_intersections = 1;
  expect_advice(r, {"1 pair of triangles", "make the edit in two steps."});
  r.folded = 12;
  r.causes.near = 4711;
  r.causes.lone_handle = true;
  r.causes.reach = 1;
  r.causes.rotation = 100;
  expect_advice(r, {"12 triangles folded over near vertex 4711: use a group", "or make the edit in two steps."});
  r.has_targets = true;
  expect_advice(r, {"4711: check the targets near it, lower the weights", "or make the edit in two steps."});
  r.has_targets = false;
  r.handle_displacement = 1.5;
  r.folded = 1;
  expect_advice(r,
                {"1 triangle folded over", "4711: use a larger region, use a group", "or make the edit in two steps."});
}

TEST(AdviceOnAnEdit, IsAtMostTwoSentencesTheFirstOnTheShape) {
  EditReport r;
  r.handle_displacement = 2;
  r.causes.reach = 3;
  r.stretch_max = 5;
  r.causes.stretched = 17;
  r.causes.distance = 0.2;
  r.causes.behind = 4;
  r.iterations = r.settings.iterations = 6;
  r.rotation_left = 10;
  EXPECT_EQ(r.advice(), "");
  r.rotation_left = 10.5;
  const std::string rotations =
      "not converged after 6 passes, the last of which rotated a detail by 10.5 degrees: raise";
  expect_advice(r, {rotations});
  r.settings.iterations = 0;
  EXPECT_EQ(r.advice(), "") << "the automatic number stops early on purpose";
  r.rotation_left = 45.5;
  r.causes.unsettled = 12;
  r.causes.unsettled_group = 2;
  expect_advice(
      r, {"The rotations at vertex 12, nearest to handle group 2, have", "by 45.5 degrees: make the edit in two"});
  r.causes.unsettled = r.causes.unsettled_group = -1;
  r.rotation_left = 10.5;
  r.iterations = r.settings.iterations = 100;  // there are no more
  expect_advice(r, {"after 100 passes", "by 10.5 degrees: make the edit in two "});
  r.iterations = r.settings.iterations = 6;
  r.causes.distance = 0.25;
  const std::string handle = "The handle is 0.25, or 12.5 % of its displacement, from its target at vertex 4: raise";
  expect_advice(r, {handle, rotations});
  r.stretch_max = 5.25;
  r.settings.order = 2;
  expect_advice(r, {"An edge at vertex 17 became 6.25 times as long: use order 1. " + handle});
  r.settings.order = 1;
  r.folded = 2;
  r.causes.near = 5;
  r.causes.lone_handle = true;
  expect_advice(r, {"2 triangles folded over near vertex 5, and an edge at vertex 17", "use a group", handle});
  EXPECT_EQ(r.advice().find("passes"), std::string::npos);
}

TEST(EditReport, TextHoldsEveryNumber) {
  for (const char* absent : {"stay", "move along", "normal radius", "stopped", "Fit to"}) {
    EXPECT_EQ(EditReport().text().find(absent), std::string::npos) << absent;
  }
  EditReport r;
  int number = 900;  // %.3g shows three digits
  for (int* count : {&r.handle, &r.free, &r.anchors, &r.fixed, &r.mesh_vertices, &r.left_out, &r.welded, &r.iterations,
                     &r.flipped, &r.folded, &r.causes.near, &r.new_intersections.emplace()}) {
    *count = ++number;
  }
  r.settings = EditSettings::of(EditMethod::Paper);
  for (double* figure : {&r.settings.membrane, &r.normal_radius, &r.handle_displacement, &r.handle_residual,
                         &r.anchor_residual, &r.handle_point_distance.emplace(), &r.rotation_max, &r.volume_change,
                         &r.rotation_left, &r.region_ms, &r.operator_ms, &r.factor_ms, &r.rotations_ms, &r.solve_ms}) {
    *figure = ++number;
  }
  for (; number > 900; --number) {
    support::expect_contains(r.text(), std::to_string(number));
  }
  r.settings.order = 3;
  r.landmarks = {{"nose", 3, 0.3}, {"chin", 4, 0.4}};
  r.landmark_conversion = "from RAS to LPS";
  r.stretch_rms = 0.0875;
  r.stretch_max = 0.5;
  r.volume = 4;
  r.volume_change = -0.3125;
  r.is_body = true;
  for (const char* part : {"order 3", "Landmarks: 2", "0.354", "0.4 at \"chin\" (vertex 4)", "from RAS to LPS",
                           "8.75 %", "50 %", "-0.312 (-7.81 %)"}) {
    support::expect_contains(r.text(), part);
  }
  r.fit = FitReport();
  r.fit->mode = "shape";
  r.fit->scan = "scan.ply";
  r.fit->aligned = "rigid";
  r.fit->to_scan = {0.75, 11, 12, 13, 14};
  r.fit->from_scan = {0.625, 15, 16, 17, 18};
  r.fit->alignment = 1.5;
  r.fit->orientations.second = 2.5;
  r.fit->by_landmarks = 0.5;
  r.fit->reversed_normals = true;
  r.fit->size = 1000;
  r.fit->hidden = 19;
  for (const char* part : {"scan.ply", "mode shape", "rigid by landmarks", "RMS 1.5", "2.5", "reversed", "19 pieces",
                           "75 %", "RMS 11", "median 12", "95 % 13", "largest 14", "62.5 %", "15", "16", "17", "18"}) {
    support::expect_contains(r.text(), part);
  }
}

}  // namespace
}  // namespace lapedit::edit_report_test
