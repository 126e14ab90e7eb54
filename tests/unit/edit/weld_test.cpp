// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/weld.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

/// A pull at one place, with the region's radius, of all vertices that are there.
EditStep pull(const TriangleMesh& mesh, const Vector3& at, double radius) {
  EditStep step;
  step.region.radius = radius;
  step.handles = {{{support::vertex_at(mesh, at)}, {}}};
  step.handles.front().transform.translation = Vector3(0.1, 0.05, 0.3) * radius;
  return step;
}

TEST(Weld, NamesTheFirstOfEachPlace) {
  const double nan = std::nan(""), far = std::numeric_limits<double>::infinity();
  Points points(10, 3);
  points << 0, 0, 0, 1, 0, 0, -0.0, 0, -0.0, 1, 0, 0, 1, 1e-300, 0, nan, 0, 0, nan, 0, 0, 1, 0, 0, 0, far, 0, 0, far, 0;
  const Weld weld(points);
  ASSERT_FALSE(weld.empty());
  const std::vector<int> first = {0, 1, 0, 1, 4, 5, 6, 1, 8, 9};
  for (int v = 0; v < 10; ++v) {
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

}  // namespace
}  // namespace lapedit::weld_test
