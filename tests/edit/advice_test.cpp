// SPDX-License-Identifier: GPL-3.0-or-later
// Advice on results that are no success: turned inside out, collapsed, landmarks exchanged; and none on rigid results.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"
#include "lapedit/mesh/surface_measures.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::advice_test {
namespace {

using support::component;
using support::rigid;
using support::shift;
using support::vertices_where;

// --- Heads ----------------------------------------------------------------------------------------------------------

TriangleMesh head(int levels, bool open = false) {
  TriangleMesh mesh = shapes::icosphere(levels);
  mesh.vertices.col(0) *= 0.75;
  mesh.vertices.col(2) *= 1.1;
  if (open) {  // at the neck
    std::vector<int> kept;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      if (mesh.vertices(mesh.faces(f, 0), 2) > -0.95) {
        kept.push_back(static_cast<int>(f));
      }
    }
    mesh.faces = Faces(mesh.faces(kept, Eigen::all));
  }
  return mesh;
}

const char* const kNames[] = {"nose", "crown", "chin", "nape", "left eye", "right eye", "left ear", "right ear"};

/// Landmarks on a head that looks to y, with their own positions as targets.
EditStep landmarks_of(const TriangleMesh& mesh) {
  EditStep step;
  step.region = component();
  step.handles.resize(1);
  for (const Vector3& direction :
       {Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(0, 0.6, -0.8), Vector3(0, -1, -0.2), Vector3(0.3, 0.9, 0.3),
        Vector3(-0.3, 0.9, 0.3), Vector3(1, 0, 0), Vector3(-1, 0, 0)}) {
    HandleGroup& group = step.handles[0];
    const int vertex = support::vertex_at(mesh, direction.cwiseProduct(Vector3(0.75, 1, 1.1)));
    group.names.emplace_back(kNames[group.vertices.size()]);
    group.vertices.push_back(vertex);
    group.targets.emplace_back(mesh.vertices.row(vertex).transpose());
  }
  return step;
}

EditReport report_of(const TriangleMesh& mesh, const EditStep& step, double fraction = 1,
                     StoredScalar scalar = StoredScalar::Double) {
  return support::apply_step(mesh, step, fraction, scalar).reports.front();
}

std::string advice_of(const TriangleMesh& mesh, const EditStep& step) {
  return report_of(mesh, step).advice();
}

TEST(AdviceOnVolume, ExchangedLandmarksAreNamed) {
  for (const bool open : {false, true}) {
    for (const double size : {1.0, 1000.0}) {
      TriangleMesh mesh = head(open ? 4 : 3, open);
      mesh.vertices = (size * mesh.vertices).rowwise() + size * Eigen::RowVector3d(5, 6, 7);
      EditStep right;
      {
        TriangleMesh at_origin = head(open ? 4 : 3, open);
        right = landmarks_of(at_origin);
        for (std::size_t k = 0; k < right.handles[0].targets.size(); ++k) {
          right.handles[0].targets[k] = mesh.vertices.row(right.handles[0].vertices[k]).transpose();
        }
      }
      for (Vector3& target : right.handles[0].targets) {
        target = rigid(40, Vector3(1, 1, 0), Vector3(1, 0, 0)) * target;
      }
      EXPECT_EQ(advice_of(mesh, right), "");
      EditStep wrong = right;
      std::swap(wrong.handles[0].targets[4], wrong.handles[0].targets[5]);
      std::swap(wrong.handles[0].targets[6], wrong.handles[0].targets[7]);
      for (const EditMethod method : {EditMethod::Default, EditMethod::Linear}) {
        wrong.settings = EditSettings::of(method);
        const EditReport report = report_of(mesh, wrong);
        const std::string advice = report.advice();
        EXPECT_LT(report.volume * (report.volume + report.volume_change), 0);
        support::expect_contains(advice, "The surface of vertex 0 turned inside out, from a volume of ");
      }
    }
  }
}

TEST(AdviceOnVolume, MirroringMapsTurnInsideOut) {
  const TriangleMesh meshes[] = {head(2), head(4, true), shapes::bar(6, 4, 3), shapes::tapered_arm(16, 40)};
  for (const TriangleMesh& mesh : meshes) {
    EditStep step;
    step.region = component();
    const double middle = mesh.vertices.col(0).mean();
    step.handles = {{vertices_where(mesh, [middle](const Vector3& p) { return p[0] > middle; }), {}}};
    Affine mirror = rigid(25, Vector3(1, 2, 3), Vector3(1, 1, 1));
    mirror.linear().col(0) *= -1;
    step.handles[0].transform.matrix = mirror.matrix();
    support::expect_contains(advice_of(mesh, step), "turned inside out, from a volume of ");
    support::expect_contains(advice_of(mesh, step), ": give maps that do not mirror, or reverse the orientation");
    mirror.linear().col(0) *= -1;
    step.handles[0].transform.matrix = mirror.matrix();
    EXPECT_EQ(advice_of(mesh, step), "");
  }
}

TEST(AdviceOnVolume, MirroringGroupIsRefusedUnlessAllMirror) {
  const TriangleMesh mesh = shapes::bar(12, 4, 3);
  EditStep step;
  step.region = component();
  step.handles = {{vertices_where(mesh, [](const Vector3& p) { return p[0] == 0; }), {}},
                  {vertices_where(mesh, [](const Vector3& p) { return p[0] == 12; }), {}},
                  {{support::vertex_at(mesh, Vector3(6, 0, 0))}, {}}};
  Affine mirror = Affine::Identity();
  mirror.linear()(1, 1) = -1;
  mirror.translation()[1] = 4;
  step.handles[1].transform.matrix = mirror.matrix();
  const std::string sentence = support::expect_refusal(ErrorCause::BadParameter, [&] { advice_of(mesh, step); });
  support::expect_contains(sentence,
                           "The matrix of handle group 1 mirrors, since its determinant is negative, but handle "
                           "group 0 does not mirror");
  step.handles[0].transform.matrix = mirror.matrix();
  EXPECT_NE(advice_of(mesh, step), "");
  step.handles[0].transform.matrix.reset();
  for (const int v : step.handles[0].vertices) {
    step.handles[0].targets.emplace_back(mesh.vertices.row(v).transpose());
  }
  support::expect_refusal(ErrorCause::BadParameter, [&] { advice_of(mesh, step); });
  step.handles[0].targets.clear();
  step.handles[1].transform.matrix.reset();
  step.handles[2].transform.matrix = mirror.matrix();  // of a single vertex, which only moves
  EXPECT_EQ(advice_of(mesh, step), "");
  mirror.linear()(1, 1) = -1e-18;  // flattens
  step.handles[1].transform.matrix = mirror.matrix();
  advice_of(mesh, step);
}

TEST(AdviceOnVolume, CollapsedTubeHasAdviceUnlessItWasToShrink) {
  for (const auto& [around, rings] : {std::pair(16, 31), std::pair(32, 61)}) {
    const TriangleMesh tube = support::open_tube(around, rings, 4);
    EditStep step;
    step.region = component();
    step.handles = {{vertices_where(tube, [](const Vector3& p) { return p[0] < 0.01; }), {}},
                    {vertices_where(tube, [](const Vector3& p) { return p[0] > 3.99; }), {}}};
    step.handles[1].transform.axis = Vector3(1, 0, 0);
    step.handles[1].transform.degrees = 360;  // boundaries alone are no grip
    const EditReport twisted = report_of(tube, step);
    EXPECT_LT(twisted.volume_change, -0.5 * twisted.volume);
    support::expect_contains(twisted.advice(), "The surface of vertex ");
    support::expect_contains(twisted.advice(), " % of its volume: make the edit in two steps.");
    EXPECT_EQ(report_of(tube, step, 0.2).advice().find("volume"), std::string::npos);
    // Shorter, to two thirds and to a quarter, which is what these motions ask for.
    step.handles[1].transform = {};
    for (const double length : {-1.3, -3.0}) {
      step.handles[1].transform.translation = Vector3(length, 0, 0);
      EXPECT_EQ(report_of(tube, step).advice().find("volume"), std::string::npos) << report_of(tube, step).advice();
    }
    // Smaller as a whole.
    step.handles.resize(1);
    step.handles[0].transform.scale = 0.4;
    const EditReport smaller = report_of(tube, step);
    EXPECT_LT(smaller.volume_change, -0.9 * smaller.volume);
    EXPECT_EQ(smaller.advice(), "");
  }
}

/// A template that is fitted to a smaller person, in any direction, was to lose volume.
TEST(AdviceOnVolume, SmallerTargetsAskForAVolume) {
  const TriangleMesh mesh = head(3);
  for (const Vector3& scale : {Vector3(0.5, 0.5, 0.5), Vector3(1, 0.3, 1), Vector3(0.7, 0.6, 0.4)}) {
    EditStep step;
    step.region = component();
    step.handles.resize(1);
    for (int v = 0; v < mesh.vertices.rows(); v += 4) {
      step.handles[0].vertices.push_back(v);
      step.handles[0].targets.emplace_back(Vector3(mesh.vertices.row(v)).cwiseProduct(scale) + Vector3(1, 2, 3));
    }
    const EditReport report = report_of(mesh, step);
    EXPECT_LT(report.volume_change, -0.5 * report.volume);
    EXPECT_EQ(report.advice(), "");
  }
}

/// What has no inside cannot turn inside out: hills become valleys, and domes bowls.
TEST(AdviceOnVolume, OpenSurfacesHaveNone) {
  TriangleMesh dome = shapes::grid(21, 21);
  for (auto p : dome.vertices.rowwise()) {
    p[2] = 8 * std::exp(-((p[0] - 10) * (p[0] - 10) + (p[1] - 10) * (p[1] - 10)) / 30);
  }
  EditStep step;
  step.region.radius = 8;
  step.handles = {{support::around(dome, Vector3(10, 10, 8), 2.5), {}}};
  step.handles[0].transform.translation = Vector3(0, 0, -14);
  const EditReport report = report_of(dome, step);
  EXPECT_LT(report.volume * (report.volume + report.volume_change), 0);
  EXPECT_EQ(report.advice().find("volume"), std::string::npos) << report.advice();
}

TEST(AdviceOnVolume, ComponentsAreMeasuredOneByOne) {
  const TriangleMesh ball = shapes::icosphere(2);
  const TriangleMesh both = shapes::together(shapes::bar(6, 6, 6), ball, Vector3(20, 0, 0));
  const Region region = support::whole_region(both, {{0}, {218}}, {});
  const std::vector<ComponentVolume> volumes = component_volumes(region, both.vertices);
  ASSERT_EQ(volumes.size(), 2U);
  EXPECT_NEAR(volumes[0].volume, 216, 1e-9);
  EXPECT_NEAR(volumes[1].volume, enclosed_volume(support::whole_region(ball, {{0}}, {}), ball.vertices), 1e-9);
  EXPECT_TRUE(volumes[0].is_body && volumes[1].is_body);
  EditStep step;
  step.region = component();
  step.handles = {{{0, 1, 2, 3}, {}}, {vertices_where(both, [](const Vector3& p) { return p[0] > 19.5; }), {}}};
  step.handles[1].transform.scale = 2;
  step.handles[1].transform.center = Vector3(20, 0, 0);
  EXPECT_EQ(advice_of(both, step), "");
}

// --- Corners --------------------------------------------------------------------------------------------------------

/// Pulls the end of a wire aside.
EditReport pulled_wire(int rings, double by, double radius) {
  const TriangleMesh wire = support::open_tube(12, rings, 40);
  EditStep step;
  step.region.radius = radius;
  step.handles = {{vertices_where(wire, [](const Vector3& p) { return p[0] > 38.5; }), {}}};
  step.handles[0].transform.translation = Vector3(0, by, 0);
  return report_of(wire, step);
}

TEST(AdviceOnCorners, IsGivenWhereTheRegionEndsInOne) {
  for (const int rings : {81, 161}) {
    const EditReport corner = pulled_wire(rings, 8, 6);
    EXPECT_NEAR(corner.causes.bend, 53, 2);
    EXPECT_NEAR(corner.causes.bent / 12 * 40.0 / (rings - 1), 33.4, 0.2);
    support::expect_contains(corner.advice(), "The surface bends by 5");
    EXPECT_EQ(pulled_wire(rings, 8, 30).advice(), "");
  }
}

// --- Rigid results --------------------------------------------------------------------------------------------------

/// Needles, whose corners are so near that rounding turns them.
TriangleMesh needles() {
  TriangleMesh mesh = shapes::grid(20, 20);
  for (int v = 0; v + 1 < mesh.vertices.rows(); v += 7) {
    mesh.vertices.row(v) = mesh.vertices.row(v + 1) + Eigen::RowVector3d(2e-7, 0, 1e-7);
  }
  mesh.vertices.col(2) += 3 * (0.3 * mesh.vertices.col(0)).array().sin().matrix();
  return mesh;
}

TEST(AdviceOnRigidResults, IsNotGivenAtAnyOrder) {
  const TriangleMesh meshes[] = {shapes::grid(5, 5), head(2), needles()};
  for (const TriangleMesh& given : meshes) {
    for (const double away : {0.0, 30.0}) {
      TriangleMesh mesh = given;
      mesh.vertices.array() += away;
      Points stored = mesh.vertices;
      round_to(StoredScalar::Float, stored);
      mesh.vertices = stored;
      for (const Affine& map : {shift(Vector3(3.1, 2.2, 4.3)), rigid(100, Vector3(1, 2, 3), Vector3(1, 0, 2)),
                                rigid(180, Vector3(0, 1, 0), Vector3(0.1, 0, 0))}) {
        for (const EditMethod method : {EditMethod::Linear, EditMethod::Paper, EditMethod::Default}) {
          for (int order = 1; order <= (method == EditMethod::Default ? 1 : 3); ++order) {
            EditStep step;
            step.region = component();
            step.settings = EditSettings::of(method);
            step.settings.order = order;
            step.settings.membrane = method == EditMethod::Paper ? 0 : 500;
            const int n = static_cast<int>(mesh.vertices.rows());
            step.handles = {{{0, n / 5, n / 3, n / 2, n - 2}, {}}};
            step.handles[0].transform.matrix = map.matrix();
            const EditReport report = report_of(mesh, step, 1, StoredScalar::Float);
            EXPECT_EQ(report.advice(), "") << name(method) << ", order " << order;
            for (const int v : step.handles[0].vertices) {
              step.handles[0].targets.emplace_back(map * Vector3(mesh.vertices.row(v)));
            }
            if (method != EditMethod::Paper || &given != &meshes[2]) {  // whose frames at needles are rounding
              EXPECT_EQ(report_of(mesh, step, 1, StoredScalar::Float).advice(), "")
                  << name(method) << ", order " << order;
            }
          }
        }
      }
    }
  }
}

TEST(AdviceOnRigidResults, RigidIsMeasuredByComponent) {
  const TriangleMesh both = shapes::together(shapes::grid(6, 6), shapes::icosphere(2), Vector3(20, 0, 0));
  const Region region = support::whole_region(both, {{0}, {40}}, {});
  Points after = both.vertices;
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 0));
  after.bottomRows(162) = support::moved(rigid(120, Vector3(1, 2, 3), Vector3(5, 6, 7)), Points(after.bottomRows(162)));
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 0));
  after(100, 1) += 1e-3;
  EXPECT_FALSE(moved_rigidly(region, both.vertices, after, 0));
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 1e-3));
  after = both.vertices;
  after.col(0) *= -1;
  EXPECT_FALSE(moved_rigidly(region, both.vertices, after, 0)) << "a mirror image";
}

}  // namespace
}  // namespace lapedit::advice_test
