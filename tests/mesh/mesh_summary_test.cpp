// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/mesh_summary.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"
#include "support.h"

namespace lapedit::mesh_summary_test {
namespace {

TEST(MeshSummary, CountsPiecesAndBorders) {
  TriangleMesh mesh = shapes::grid(5, 4);
  MeshSummary summary = summary_of(mesh);
  EXPECT_EQ(summary.vertices, 20);
  EXPECT_EQ(summary.faces, 24);
  EXPECT_EQ(summary.pieces, 1);
  EXPECT_EQ(summary.borders, 1);
  EXPECT_EQ(summary.border_edges, 14);
  EXPECT_EQ(summary.loose, 0);
  mesh.vertices(3, 1) = std::nan("");
  EXPECT_EQ(summary_of(mesh).not_finite, 1);

  summary = summary_of(shapes::two_pieces(1));
  EXPECT_EQ(summary.pieces, 2);
  EXPECT_EQ(summary.largest_piece, 42);
  EXPECT_EQ(summary.borders, 0);
  summary = summary_of(shapes::cylinder(6, 4));
  EXPECT_EQ(summary.pieces, 1);
  EXPECT_EQ(summary_of(shapes::degenerate_grid(12, 9)).loose, 5);

  mesh = shapes::grid(5, 4);
  mesh.faces.conservativeResize(26, 3);
  mesh.faces.row(24) = mesh.faces.row(0).reverse().eval();
  mesh.faces.row(25) << 0, 19, 0;
  summary = summary_of(mesh);
  EXPECT_EQ(summary.faces, 26);
  EXPECT_EQ(summary.ignored, 2);
  EXPECT_EQ(summary.border_edges, 14);

  TriangleMesh points;
  points.vertices = mesh.vertices;
  points.faces.resize(0, 3);
  EXPECT_EQ(summary_of(points).loose, 20);
  EXPECT_EQ(summary_of(points).pieces, 0);
  mesh.faces(0, 0) = 20;
  support::expect_refusal(ErrorCause::BadIndex, [&] { summary_of(mesh); });
}

}  // namespace
}  // namespace lapedit::mesh_summary_test
