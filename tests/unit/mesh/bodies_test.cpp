// SPDX-License-Identifier: GPL-3.0-or-later
#include "bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <map>
#include <utility>

namespace lapedit::shapes::bodies_test {
namespace {

TEST(Bodies, AreClosedOrientedAndInOnePiece) {
  for (const TriangleMesh& body : {head(), hand(), creature(), dragon(), person()}) {
    std::map<std::pair<int, int>, int> edges;  // directed
    double volume = 0;
    for (const auto& f : body.faces.rowwise()) {
      for (int k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
      const Vector3 a = body.vertices.row(f[0]), b = body.vertices.row(f[1]), c = body.vertices.row(f[2]);
      volume += a.dot(b.cross(c)) / 6;
    }
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1);
      ASSERT_TRUE(edges.count({edge.second, edge.first}));
    }
    // A sphere's: one piece, no handles.
    EXPECT_EQ(body.vertices.rows() - static_cast<Eigen::Index>(edges.size()) / 2 + body.faces.rows(), 2);
    EXPECT_GT(volume, 0.5);
  }
}

}  // namespace
}  // namespace lapedit::shapes::bodies_test
