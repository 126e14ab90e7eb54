// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/weld.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::connect_test {
namespace {

/// A ball of 642 vertices, and a smaller, coarser one of 42 inside it, 0.1 away.
TriangleMesh ball_in_ball() {
  TriangleMesh inner = shapes::icosphere(1);
  inner.vertices *= 0.9;
  return shapes::together(shapes::icosphere(3), inner, Vector3::Zero());
}

using Links = std::vector<std::pair<int, int>>;

Links links_at(const TriangleMesh& mesh, double gap) {
  const CompressedRows before = support::adjacency_of(mesh).neighbours, after = linked_neighbours(mesh, before, gap);
  Links links;
  for (int v = 0; v < before.rows(); ++v) {
    for (const int w : after[v]) {
      if (!std::binary_search(before[v].begin(), before[v].end(), w)) {
        links.emplace_back(v, w);
      }
    }
  }
  return links;
}

/// A tube that was cut open, with `around` columns, and a gap at the seam.
TriangleMesh cut_tube(int around) {
  TriangleMesh mesh = shapes::grid(20, around);
  for (auto p : mesh.vertices.rowwise()) {
    const double angle = 6.1 * p[0] / (around - 1);
    p = Eigen::RowVector3d(std::cos(angle), std::sin(angle), 0.15 * p[1]);
  }
  return mesh;
}

Links sorted(Links links) {
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

/// Links of each vertex as defined, by looking at all pairs. @return sorted, both directions
Links links_of_all_pairs(const TriangleMesh& mesh, double gap) {
  const CompressedRows neighbours = support::adjacency_of(mesh).neighbours;
  std::vector<int> labels;
  connected_components(neighbours, labels);
  std::vector<char> is_border(labels.size(), 0);
  for (const auto& [a, b] : single_edges({mesh.faces.data(), mesh.faces.data() + mesh.faces.size()})) {
    is_border[a] = is_border[b] = 1;
  }
  GeodesicSearch search({neighbours, mesh.vertices});
  std::map<int, std::vector<std::tuple<double, int>>> into;
  for (int v = 0; v < neighbours.rows(); ++v) {
    if (is_border[v]) {
      search.run({v}, kUnreached);
    }
    std::tuple<double, int> best(kUnreached, -1);
    for (int w = 0; w < neighbours.rows(); ++w) {
      const double length = (mesh.vertices.row(v) - mesh.vertices.row(w)).norm();
      const bool is_far = is_border[v] && is_border[w] && v != w && search.distance(w) > 3 * length &&
                          !std::binary_search(neighbours[v].begin(), neighbours[v].end(), w);
      if (length <= gap && (labels[v] != labels[w] || is_far)) {
        best = std::min(best, {length, w});
      }
    }
    if (std::get<1>(best) >= 0) {
      into[std::get<1>(best)].emplace_back(std::get<0>(best), v);
    }
  }
  Links links;
  for (auto& [to, all] : into) {
    std::sort(all.begin(), all.end());
    all.resize(std::min<std::size_t>(all.size(), kMostLinks));
    for (const auto& [length, from] : all) {
      links.emplace_back(from, to);
      links.emplace_back(to, from);
    }
  }
  return sorted(std::move(links));
}

TEST(Connect, LinksAreThoseOfLookingAtAllPairs) {
  for (const TriangleMesh& mesh :
       {ball_in_ball(), cut_tube(60), shapes::together(cut_tube(30), cut_tube(17), Vector3(0.2, 0.1, 0.05)),
        shapes::together(shapes::two_pieces(2), shapes::icosphere(1), Vector3(1.5, 0.1, 0))}) {
    for (const double gap : {0.05, 0.25, 1.0, 50.0}) {
      EXPECT_EQ(links_at(mesh, gap), links_of_all_pairs(mesh, gap)) << mesh.vertices.rows() << " vertices, gap " << gap;
    }
  }
}

double work_per_vertex(const TriangleMesh& mesh) {
  const CompressedRows neighbours = support::adjacency_of(mesh).neighbours;
  double calls = 0;
  const Progress count = [&calls](double, const char*) { return ++calls > 0; };
  const ProgressScope scope(count);
  linked_neighbours(mesh, neighbours, 1000);
  return calls * kWorkPerCall / static_cast<double>(mesh.vertices.rows());
}

TEST(Connect, PairsGrowWithTheVerticesHoweverLongTheGapIs) {
  constexpr double kMost = 150;
  for (const int n : {30, 90}) {
    TriangleMesh triangles{Points::Random(9 * n, 3),
                           Faces(3 * n, 3)};  // all meet in one point, with vertices of their own
    for (int f = 0; f < 3 * n; ++f) {
      triangles.faces.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
      triangles.vertices.row(3 * f).setZero();
    }
    EXPECT_LT(work_per_vertex(triangles), kMost) << n;
    EXPECT_LT(work_per_vertex(shapes::grid(n, n)), 2 * kMost) << n;
    EXPECT_LT(work_per_vertex(shapes::together(shapes::grid(n, n), shapes::grid(n, n), Vector3(0, 0, 3 * n))),
              2 * kMost)
        << n;
  }
  for (const int levels : {3, 4}) {
    EXPECT_LT(work_per_vertex(shapes::two_pieces(levels)), kMost) << levels;
    TriangleMesh small = shapes::icosphere(levels);
    small.vertices *= 1e-6;
    EXPECT_LT(work_per_vertex(shapes::together(shapes::icosphere(levels), small, Vector3::Zero())), 5 * kMost)
        << levels;
  }
}

TEST(Connect, LinksTheSidesOfAClosedWall) {
  constexpr int kCells = 20;
  TriangleMesh plate = shapes::bar(kCells, kCells, 1);
  plate.vertices.col(2) *= 0.2;
  const auto links = links_at(plate, 0.3);
  EXPECT_EQ(links.size(), 2U * (kCells - 1) * (kCells - 1)) << "all but those at its boundary";
  for (const auto& [v, w] : links) {
    EXPECT_NEAR((plate.vertices.row(v) - plate.vertices.row(w)).norm(), 0.2, 1e-12);
  }
  EXPECT_TRUE(links_at(plate, 0.1).empty()) << "thicker than the gap";
  TriangleMesh inverted = plate;
  inverted.faces.col(0).swap(inverted.faces.col(1));
  EXPECT_EQ(links_at(inverted, 0.3), links);
  TriangleMesh disagreeing = plate;
  for (Eigen::Index f = 0; f < plate.faces.rows(); ++f) {
    if ((plate.vertices(plate.faces(f, 0), 2) > 0 && plate.vertices(plate.faces(f, 1), 2) > 0) || f % 7 == 0) {
      disagreeing.faces.row(f).reverseInPlace();
    }
  }
  EXPECT_EQ(links_at(disagreeing, 0.3), links);
  const std::vector<int> numbers = support::shuffled(static_cast<int>(plate.vertices.rows()), 1);
  Links renumbered = links;
  for (auto& [v, w] : renumbered) {
    v = numbers[v];
    w = numbers[w];
  }
  EXPECT_EQ(links_at(support::renumbered(plate, numbers, 2), 0.3), sorted(renumbered));
}

TEST(Connect, LinksTheSidesOfAWallWithAHole) {
  TriangleMesh plate = shapes::bar(20, 20, 1);
  plate.vertices.col(2) *= 0.2;
  const auto far_from_hole = [&plate](Links links) {
    const Eigen::RowVector3d hole(9, 9, 0.2);
    const auto is_near = [&](const auto& link) { return (plate.vertices.row(link.first) - hole).norm() < 3; };
    links.erase(std::remove_if(links.begin(), links.end(), is_near), links.end());
    return links;
  };
  const auto expected = far_from_hole(links_at(plate, 0.3));
  EXPECT_GT(expected.size(), 600U);
  const Eigen::Index all = plate.faces.rows();
  plate = support::without_faces(plate, [](const Eigen::RowVector3d& centre) {
    return centre.z() > 0.1 && (centre - Eigen::RowVector3d(9, 9, 0.2)).cwiseAbs().maxCoeff() < 1;
  });
  ASSERT_EQ(plate.faces.rows(), all - 8);
  EXPECT_EQ(far_from_hole(links_at(plate, 0.3)), expected);
}

/// Fails if the orientation of one body is carried over to another one across an edge that both have.
TEST(Connect, LinksTheSidesOfTwoWallsThatShareAnEdge) {
  TriangleMesh plate = shapes::bar(20, 20, 1), other = plate;
  plate.vertices.col(2) *= 0.2;
  other.vertices.col(0) = 40 - plate.vertices.col(0).array();
  other.vertices.col(2) = -plate.vertices.col(2);
  other.faces.colwise().reverseInPlace();
  TriangleMesh both = shapes::together(plate, other, Vector3::Zero());
  const Weld weld(both.vertices);
  both.faces = both.faces.unaryExpr([&](int v) { return weld.representative(v); }).eval();
  EXPECT_EQ(links_at(both, 0.3).size(), 2 * links_at(plate, 0.3).size());
}

TEST(Connect, LinksNoSidesOfBallsAndLimbs) {
  for (const TriangleMesh& body :
       {shapes::icosphere(3), shapes::cylinder(24, 30), shapes::bar(30, 4, 4), shapes::tapered_arm(24, 60)}) {
    EXPECT_TRUE(links_at(body, 1000).empty()) << body.vertices.rows() << " vertices";
  }
}

TEST(Connect, RegionOfARadiusHasTheLinksOfTheWholeMesh) {
  const TriangleMesh mesh = ball_in_ball();
  const Adjacency adjacency = support::adjacency_of(mesh);
  RegionSpec spec = support::within(0.5);
  for (const double gap : {0.12, 0.2}) {
    spec.connect_gap = gap;
    const CompressedRows linked = linked_neighbours(mesh, adjacency.neighbours, gap);
    const Region region = build_region(mesh, adjacency, spec, {{support::vertex_at(mesh, {0, 0, 1})}});
    for (int i = 0; i < region.size(); ++i) {
      std::size_t inside = 0;
      for (const int w : linked[region.mesh_vertex[i]]) {
        inside += index_in(region.mesh_vertex, w) >= 0;
      }
      EXPECT_EQ(static_cast<std::size_t>(region.neighbours[i].size()), inside) << "vertex " << i;
    }
  }
}

/// What is linked but not in a given set does not hold it.
TEST(Connect, LinksOutOfAGivenSetMakeNoBoundary) {
  const TriangleMesh mesh = ball_in_ball();
  const Adjacency adjacency = support::adjacency_of(mesh);
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.connect_gap = 0.2;
  spec.vertices.resize(642);
  std::iota(spec.vertices.begin(), spec.vertices.end(), 0);
  EXPECT_EQ(build_region(mesh, adjacency, spec, {{5}}).count(VertexClass::Anchor), 0);
}

}  // namespace
}  // namespace lapedit::connect_test
