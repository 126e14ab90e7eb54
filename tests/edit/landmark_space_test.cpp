// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/coordinate_space.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/edit/edit.h"
#include "lapedit/mesh/vertex_finder.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::landmark_space_test {
namespace {

TEST(LandmarkSpace, IsReadFromTheHeadersOfMeshFiles) {
  const std::string many(1 << 17, 'x');
  const std::pair<std::string, const char*> cases[] = {
      {"ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 0\nend_header\n", "LPS"},
      {"ply\r\nformat ascii 1.0\r\ncomment space=ras\r\nend_header\r\n", "RAS"},
      {"ply\nend_header\nSPACE=LPS\n", ""},
      {"ply\ncomment WORKSPACE=LPS\nend_header\n", ""},
      {"ply\ncomment WORKSPACE=LPS SPACE=RAS\nend_header\n", "RAS"},
      {"ply\ncomment SPACE=LPSX\nend_header\n", ""},
      {"ply\ncomment SPACE=LAS\nend_header\n", ""},
      {"ply\ncomment " + many + " SPACE=LPS\nend_header\n", ""},
      {"Visualization Toolkit generated SLA File SPACE=LPS" + std::string(300, '\0'), "LPS"},
      {"solid head SPACE=RAS\nfacet normal 0 0 1\n", "RAS"},
      {"# made\nmtllib a.mtl\n# SPACE=LPS\nv 0 0 0\n", "LPS"},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n" + std::string(80, '#') + "\n# SPACE=LPS\n", ""},
      {"OFF # SPACE=LPS\n3 1 0\n", "LPS"},
      {"OFF\n# SPACE=RAS", "RAS"},
      {"SPACE=LP", ""},
      {"", ""},
  };
  for (const auto& [bytes, space] : cases) {
    EXPECT_EQ(space_in_header(bytes), space) << bytes.substr(0, 80);
  }
}

Edit edit_of(const std::string& points, const std::string& targets) {
  HandleGroup group;
  group.names = {"a"};
  group.query.points = {{1, 2, 3}};
  group.targets = {{4, -5, 6}};
  group.spaces = {points, targets, {}};
  Edit edit;
  edit.steps.resize(1);
  edit.steps[0].handles = {group};
  return edit;
}

TEST(LandmarkSpace, LandmarksAreConvertedToThatOfTheMesh) {
  struct Case {
    const char *points, *targets, *mesh, *conversion;
    double x, y;  ///< of points and targets
  };
  for (const Case& one : {Case{"RAS", "RAS", "LPS", "from RAS to LPS", -1, -4},
                          {"LPS", "LPS", "RAS", "from LPS to RAS", -1, -4},
                          {"RAS", "RAS", "RAS", "", 1, 4},
                          {"RAS", "RAS", "", "", 1, 4},
                          {"", "", "LPS", "", 1, 4},
                          {"RAS", "LPS", "LPS", "points from RAS to LPS", -1, 4},
                          {"RAS", "", "LPS", "points from RAS to LPS", -1, 4},
                          {"", "RAS", "LPS", "targets from RAS to LPS", 1, -4},
                          {"", "RAS", "", "", 1, 4},
                          {"LPS", "RAS", "", "targets from RAS to LPS", 1, -4}}) {
    const HandleGroup group = in_space(edit_of(one.points, one.targets), one.mesh).steps[0].handles[0];
    EXPECT_EQ(group.spaces.conversion, one.conversion);
    EXPECT_EQ(group.query.points[0], Vector3(one.x, 2 * one.x, 3)) << one.points << one.mesh;
    EXPECT_EQ(group.targets[0], Vector3(one.y, -5 * one.y / 4, 6)) << one.targets << one.mesh;
    const HandleGroup again =
        in_space(in_space(edit_of(one.points, one.targets), one.mesh), one.mesh).steps[0].handles[0];
    EXPECT_EQ(again.targets, group.targets) << "nothing is converted twice";
  }
  EXPECT_EQ(support::expect_refusal(ErrorCause::BadParameter, [] { in_space(edit_of("LAS", "LAS"), "LPS"); }),
            "Landmarks in LAS coordinates cannot be converted to LPS: save them in the coordinate system of the mesh.");
  EXPECT_EQ(support::expect_refusal(ErrorCause::BadParameter, [] { in_space(edit_of("", ""), "XYZ"); }),
            "space: the coordinate system \"XYZ\" is unknown: give RAS or LPS, or none.");
  EXPECT_EQ(in_space(edit_of("LAS", "LAS"), "").steps[0].handles[0].targets[0], Vector3(4, -5, 6));
}

TEST(LandmarkSpace, LikelyMistakesAreNamed) {
  TriangleMesh mesh = shapes::icosphere(2);
  mesh.vertices.rowwise() += Eigen::RowVector3d(5, 3, 0);
  const VertexFinder finder(mesh);
  const auto mistake = [&](double factor, double sign, const std::string& space) {
    std::vector<Vector3> points;
    for (const int v : {0, 20, 90}) {
      points.emplace_back(factor * sign * mesh.vertices(v, 0), factor * sign * mesh.vertices(v, 1),
                          factor * mesh.vertices(v, 2));
    }
    return likely_mistake(finder, points, space, VertexFinder::kFar);
  };
  EXPECT_EQ(mistake(1000, 1, ""),
            "check the unit, since divided by 1000, as from millimetres to metres, all of them are near the surface");
  EXPECT_EQ(
      mistake(1, -1, "LPS"),
      "check the coordinate system, since with x and y negated, as from LPS to RAS, all of them are near the surface");
  EXPECT_EQ(mistake(0.1, -1, "RAS"),
            "check unit and coordinate system, since multiplied by 10, as from centimetres to millimetres and with x "
            "and y negated, "
            "as from RAS to LPS, all of them are near the surface");
  EXPECT_EQ(mistake(7, 1, ""), "");
  EXPECT_EQ(likely_mistake(finder, {{1e308, 1e308, 1e308}}, "", VertexFinder::kFar), "");
}

/// Refusals name the landmark, advice too; conversions and other units are in the report.
TEST(LandmarkSpace, ReportsAndRefusalsNameLandmarks) {
  const TriangleMesh mesh = shapes::icosphere(2);
  HandleGroup group;
  group.names = {"nose", "chin"};
  for (const int v : {40, 7}) {
    group.query.points.emplace_back(mesh.vertices.row(v).transpose());
  }
  group.targets = {group.query.points[0] + Vector3(0, 0, 0.2), group.query.points[1]};
  group.spaces.conversion = "from RAS to LPS";
  Edit edit;
  edit.steps.resize(1);
  EditStep& step = edit.steps[0];
  step.region.radius = 0.5;
  step.handles = {group};
  step.settings.handle_weight = 1e-3;
  const EditReport report = apply_edit(mesh, edit).reports[0];
  EXPECT_EQ(report.landmark_conversion, "from RAS to LPS");
  EXPECT_NE(report.text().find("\nLandmarks were converted to the coordinate system of the mesh: from RAS to LPS\n"),
            std::string::npos);
  EXPECT_NE(report.advice().find("at vertex 40 (\"nose\"): raise handle_weight"), std::string::npos) << report.advice();

  step.handles[0].targets = {1000 * group.targets[0] + Vector3(0, 0, 300), 1000 * group.targets[1]};
  step.settings = EditSettings::of(EditMethod::Linear);
  const std::string far = apply_edit(mesh, edit).reports[0].advice();
  EXPECT_NE(far.find(": for the targets check the unit, since divided by 1000, as from millimetres to metres, all of "
                     "them are near the surface."),
            std::string::npos)
      << far;
  step.handles[0] = group;
  step.region.kind = RegionSpec::Kind::Vertices;
  step.region.vertices = {40, 41, 42};
  const std::string sentence =
      support::expect_refusal(ErrorCause::HandleOutsideRegion, [&] { apply_edit(mesh, edit); });
  EXPECT_NE(sentence.find("the first is vertex 7: "), std::string::npos) << sentence;
  EXPECT_NE(sentence.find(" Vertex 7 is the landmark \"chin\"."), std::string::npos) << sentence;
}

/// The advice on a region that nothing holds.
TEST(LandmarkSpace, RegionsThatNothingHoldsHaveAdvice) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const auto advice = [&mesh](const RegionSpec& region, const std::vector<HandleGroup>& handles, double fraction = 1) {
    Edit edit;
    edit.steps.resize(1);
    edit.steps[0].region = region;
    edit.steps[0].handles = handles;
    return apply_edit(mesh, edit, fraction).reports[0].advice();
  };
  HandleGroup moves = {{40}, {}}, stays = {{7}, {}}, rotates = {{12, 13}, {}};
  moves.transform.translation = {0, 0, 0.1};
  rotates.transform.degrees = 360;
  RegionSpec region;
  region.radius = 350;
  const std::string unheld = "Nothing holds the surface, since the region reaches no vertex that stays";
  EXPECT_EQ(advice(region, {moves}).substr(0, unheld.size()), unheld);
  EXPECT_EQ(advice(region, {moves, rotates}).substr(0, unheld.size()), unheld);
  EXPECT_EQ(advice(region, {moves, stays}).find("Nothing"), std::string::npos);
  EXPECT_EQ(advice(region, {stays}), "");
  EXPECT_EQ(advice(region, {moves}, 0), "");
  region.held = {7};
  EXPECT_EQ(advice(region, {moves}).find("Nothing"), std::string::npos);
  region.held.clear();
  region.kind = RegionSpec::Kind::Component;
  EXPECT_EQ(advice(region, {moves}), "") << "that was asked for";
}

}  // namespace
}  // namespace lapedit::landmark_space_test
