// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/weld.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lapedit/base/error.h"
#include "lapedit/edit/edit.h"
#include "lapedit/edit/positions.h"
#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"
#include "support.h"
#include "torn_mesh.h"

namespace lapedit::weld_test {
namespace {

using support::same_bits;
using support::soup;
using support::Torn;
using support::with_islands;

struct Case {
  std::string what;
  Torn torn;
};

std::vector<Case> cases() {
  return {{"a soup", soup(shapes::icosphere(3))},
          {"a soup of a torus-like tube", soup(shapes::cylinder(16, 20))},
          {"islands", with_islands(shapes::grid(21, 21), 10)},
          {"islands of a ball", with_islands(shapes::icosphere(3), 0.1)}};
}

/// A pull at one place, with the region's radius, of all vertices that are there.
EditStep pull(const TriangleMesh& mesh, const Vector3& at, double radius) {
  EditStep step;
  step.region.radius = radius;
  step.handles = {{{support::vertex_at(mesh, at)}, {}}};
  step.handles.front().transform.translation = Vector3(0.1, 0.05, 0.3) * radius;
  return step;
}

TEST(Weld, NamesTheFirstOfEachPlace) {
  const double nan = std::nan("");
  Points points(8, 3);
  points << 0, 0, 0, 1, 0, 0, -0.0, 0, -0.0, 1, 0, 0, 1, 1e-300, 0, nan, 0, 0, nan, 0, 0, 1, 0, 0;
  const Weld weld(points);
  ASSERT_FALSE(weld.empty());
  const std::vector<int> first = {0, 1, 0, 1, 4, 5, 6, 1};
  for (int v = 0; v < 8; ++v) {
    EXPECT_EQ(weld.representative(v), first[static_cast<std::size_t>(v)]) << v;
  }
  std::vector<int> vertices = {1, 4}, rows;
  weld.add_others(vertices, rows);
  EXPECT_EQ(vertices, (std::vector<int>{1, 3, 4, 7}));
  EXPECT_EQ(rows, (std::vector<int>{0, 0, 1, 0}));
  Points positions(4, 3);
  positions << 1, 1, 1, 1, 1, 1, 4, 4, 4, 1, 1, 1;
  const Points before = positions;
  weld.add_others(vertices, positions);
  EXPECT_EQ(positions, before) << "they are there already";
  EXPECT_TRUE(Weld(shapes::icosphere(2).vertices).empty());
}

/// The method takes a torn mesh for the sound one, to the last bit.
TEST(Weld, ResultIsThatOfTheSoundMesh) {
  for (const Case& one : cases()) {
    const TriangleMesh &mesh = one.torn.mesh, &sound = one.torn.sound;
    const Vector3 place = sound.vertices.row(sound.vertices.rows() / 2).transpose();
    const double radius = 0.45 * bounding_box(sound.vertices).diagonal().norm();
    EditStep step = pull(mesh, place, radius), same = pull(sound, place, radius);
    for (const bool given : {false, true}) {
      if (given) {
        same.region = support::given(support::around(sound, place, radius));
        step.region = support::given(support::around(mesh, place, radius));
      }
      const EditResult result = support::apply_step(mesh, step);
      const Points moved = support::edited(mesh, result),
                   expected = support::edited(sound, support::apply_step(sound, same));
      // Sums follow the order of numbers, which a soup changes.
      EXPECT_LT((moved - gather(expected, one.torn.of)).cwiseAbs().maxCoeff(), 1e-9 * radius) << one.what << given;
      const Weld weld(mesh.vertices);
      for (int v = 0; v < static_cast<int>(moved.rows()); ++v) {
        ASSERT_EQ(moved.row(v), moved.row(weld.representative(v))) << one.what;
      }
      EXPECT_EQ(result.reports.front().welded,
                static_cast<int>(result.vertices.size()) - support::apply_step(sound, same).vertices.size())
          << one.what;
    }
  }
}

/// The mesh with faces that name a vertex twice, and with each fourth face again, from another corner on or reversed.
TriangleMesh with_ignored_faces(const TriangleMesh& mesh) {
  std::vector<int> corners;
  const auto add = [&corners](int a, int b, int c) { corners.insert(corners.end(), {a, b, c}); };
  const int n = static_cast<int>(mesh.vertices.rows());
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    const int a = mesh.faces(f, 0), b = mesh.faces(f, 1), c = mesh.faces(f, 2);
    f % 3 == 0 ? add(a, a, (a + 7 * f) % n) : add(b, f % n, b);
    add(a, b, c);
    f % 2 == 0 ? add(c, b, b) : add(c, c, c);
    for (int k = 0; f % 4 == 0 && k < 1 + f % 5; ++k) {
      k % 2 == 0 ? add(b, c, a) : add(c, b, a);
    }
  }
  return {mesh.vertices, Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3)};
}

/// Fails if such a face changes the region, a distance, a weight, a normal or a figure.
TEST(Surface, CountsEachFaceOnceAndNoneThatNamesAVertexTwice) {
  for (const TriangleMesh& mesh : {shapes::grid(21, 21), shapes::cylinder(16, 20), soup(shapes::icosphere(3)).mesh}) {
    const TriangleMesh bad = with_ignored_faces(mesh);
    const double size = bounding_box(mesh.vertices).diagonal().norm();
    for (const EditMethod method : {EditMethod::Default, EditMethod::Paper, EditMethod::Linear}) {
      EditStep step = pull(mesh, mesh.vertices.row(mesh.vertices.rows() / 2).transpose(), 0.4 * size);
      step.settings = EditSettings::of(method);
      for (int times = 0; times < 2; ++times) {
        const EditResult result = support::apply_step(bad, step), expected = support::apply_step(mesh, step);
        ASSERT_EQ(result.vertices, expected.vertices) << name(method);
        EXPECT_TRUE(same_bits(result.positions, expected.positions)) << name(method);
        for (const Figure& figure : report_table()) {
          const std::string key = figure.key == nullptr ? "" : figure.key;
          if (key.rfind("milliseconds", 0) != 0) {
            EXPECT_EQ(figure.get(result.reports[0]), figure.get(expected.reports[0])) << name(method) << key;
          }
        }
        step.region.tips = step.region.pieces = true;
        step.region.connect_gap = 0.1 * size;
      }
    }
  }
}

TEST(Weld, OtherVerticesOfAPlaceCanBeNamed) {
  const Torn torn = with_islands(shapes::grid(21, 21), 10);
  const Weld weld(torn.mesh.vertices);
  int other = 0;
  while (weld.representative(other) == other || torn.mesh.vertices(other, 1) != 10) {
    ++other;
  }
  EditStep step = pull(torn.mesh, Vector3(10, 10, 0), 6);
  const EditResult first = support::apply_step(torn.mesh, step);
  step.handles.front().vertices = {other};
  const EditResult same = support::apply_step(torn.mesh, step);
  EXPECT_EQ(first.vertices, same.vertices);
  EXPECT_TRUE(same_bits(first.positions, same.positions));
  step.handles.front().vertices = {other, weld.representative(other)};
  EXPECT_TRUE(same_bits(first.positions, support::apply_step(torn.mesh, step).positions));

  const auto refusal = [&](const EditStep& refused) {
    try {
      support::apply_step(torn.mesh, refused);
    } catch (const EditError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EditStep targets = step;
  targets.handles.front().transform = {};
  targets.handles.front().targets = {Vector3(10, 10, 1), Vector3(10, 10, 2)};
  const std::string names = "Vertices " + std::to_string(other) + " and " + std::to_string(weld.representative(other));
  EXPECT_NE(refusal(targets).find(names), std::string::npos) << refusal(targets);
  EXPECT_NE(refusal(targets).find("different targets"), std::string::npos);
  EditStep groups = step;
  groups.handles.front().vertices = {other};
  groups.handles.push_back({{weld.representative(other)}, {}});
  EXPECT_NE(refusal(groups).find(names), std::string::npos) << refusal(groups);
}

/// A disc of a query reaches across a seam.
TEST(Weld, QueriesReachAcross) {
  const Torn torn = with_islands(shapes::grid(21, 21), 10);
  Edit edit;
  EditStep& step = edit.steps.emplace_back();
  step.region.radius = 5;
  step.handles.resize(1);
  step.handles[0].query.within = VertexQuery::Disc{Vector3(10, 10, 0), 2};
  const auto found = [&edit](const TriangleMesh& mesh) {
    return located(mesh, support::adjacency_of(mesh), edit).steps[0].handles[0].vertices.size();
  };
  EXPECT_EQ(found(torn.mesh), found(torn.sound));
}

/// Of a shell with its back at the same place each pair of vertices is one, whatever the faces' orientation.
TEST(Weld, DoubledShellMovesAsOne) {
  const TriangleMesh front = shapes::grid(15, 15);
  TriangleMesh both = shapes::together(front, front, Vector3::Zero());
  both.faces.bottomRows(front.faces.rows()).col(0).swap(both.faces.bottomRows(front.faces.rows()).col(1));
  for (const EditMethod method : {EditMethod::Default, EditMethod::Paper, EditMethod::Linear}) {
    EditStep step = pull(both, Vector3(7, 7, 0), 6);
    step.settings = EditSettings::of(method);
    const Points moved = support::edited(both, support::apply_step(both, step));
    ASSERT_TRUE(moved.allFinite());
    const Eigen::Index n = front.vertices.rows();
    EXPECT_EQ(moved.topRows(n), moved.bottomRows(n)) << name(method);
    EXPECT_GT((moved - both.vertices).col(2).maxCoeff(), 1.5) << name(method);
  }
}

}  // namespace
}  // namespace lapedit::weld_test
