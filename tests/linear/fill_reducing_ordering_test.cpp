// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/nested_dissection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/edit/laplacian_editor.h"
#include "lapedit/linear/sparse_cholesky.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

IndexLists graph_of(const TriangleMesh& mesh) {
  return support::adjacency_of(mesh).neighbours;
}

/// Vertices without faces, before, between and behind.
TriangleMesh with_lone_vertices(const TriangleMesh& mesh, int count) {
  TriangleMesh result = mesh;
  const auto n = static_cast<int>(mesh.vertices.rows());
  result.vertices.setZero(n + count, 3);
  result.vertices.topRows(n) = mesh.vertices;
  std::vector<int> numbers = support::shuffled(n + count, 2);
  std::swap(numbers[n], *std::find(numbers.begin(), numbers.end(), 0));  // the first is one of them
  return support::renumbered(result, numbers, 3);
}

struct Shape {
  const char* name;
  TriangleMesh mesh;
};

/// All of them large enough to be given an order: some 30,000 vertices.
const std::vector<Shape>& large_shapes() {
  static const std::vector<Shape> all = [] {
    const TriangleMesh sphere = shapes::icosphere(6), small = shapes::icosphere(1), bar = shapes::bar(60, 40, 20);
    const TriangleMesh pair = shapes::together(shapes::tapered_arm(120, 170), bar, {0, 0, 90});
    return std::vector<Shape>{{"grid", shapes::grid(170, 180)},
                              {"sphere, renumbered", support::renumbered(sphere, support::shuffled(40962, 1), 1)},
                              {"strip", shapes::grid(2, 15000)},
                              {"components", shapes::together(small, pair, {99, 9, 9})},
                              {"lone vertices", with_lone_vertices(shapes::letter_field(180, 160), 1500)},
                              {"nothing but lone vertices", {Points::Zero(30000, 3), Faces(0, 3)}},
                              {"non-manifold", shapes::non_manifold_grid(171, 175)}};
  }();
  return all;
}

/// Fails if small graphs are given an order, which costs more than it gains.
TEST(EliminationOrder, SmallGraphsNeedNone) {
  EXPECT_TRUE(fill_reducing_ordering(IndexLists(), 1).empty());
  EXPECT_TRUE(fill_reducing_ordering(graph_of(shapes::grid(1, 1)), 1).empty());
  EXPECT_TRUE(fill_reducing_ordering(graph_of(shapes::grid(30, 40)), 1).empty());
  EXPECT_TRUE(fill_reducing_ordering(graph_of(shapes::two_pieces(3)), 2).empty());
  EXPECT_FALSE(fill_reducing_ordering(graph_of(shapes::grid(250, 200)), 1).empty());
}

/// Fails if a vertex is missing or named twice, above all one that no edge leads to.
TEST(EliminationOrder, IsAPermutation) {
  for (const Shape& shape : large_shapes()) {
    std::vector<int> order = fill_reducing_ordering(graph_of(shape.mesh), 1);
    std::sort(order.begin(), order.end());
    std::vector<int> all(shape.mesh.vertices.rows());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_TRUE(order == all) << shape.name << ": " << order.size() << " of " << all.size();
  }
}

/// Fails if threads, what was ordered before, or where the graph's lists stand in memory enters.
TEST(EliminationOrder, DependsOnTheGraphAlone) {
  for (const Shape& shape : large_shapes()) {
    const IndexLists graph = graph_of(shape.mesh);
    const std::vector<int> order = fill_reducing_ordering(graph, 1);
    for (const int threads : {2, 3}) {
      const IndexLists copy = graph;
      ASSERT_TRUE(fill_reducing_ordering(copy, threads) == order) << shape.name << ", " << threads << " threads";
    }
  }
}

/// The lower half of M^T M + 1/100, M the umbrella operator.
SparseMatrix system_of(const TriangleMesh& mesh) {
  const Region region = support::whole_region(mesh, {{0}}, {});
  const SparseMatrix m = differential_operator(LaplacianKind::Umbrella, region, {}).matrix;
  SparseMatrix identity(m.rows(), m.cols());
  identity.setIdentity();
  const SparseMatrix whole = SparseMatrix(m.transpose()) * m + 0.01 * identity;
  return whole.triangularView<Eigen::Lower>();
}

/// Fails if the order is one that fills the factor: it is there for no other reason. On a narrow limb, where minimum
/// degree is at its best, it is 11 % worse.
TEST(EliminationOrder, FillsHardlyMoreThanMinimumDegreeOrLess) {
  const auto fill_over_minimum_degree = [](const TriangleMesh& mesh) {
    const SparseMatrix system = system_of(mesh);
    CholeskyOptions options;
    options.single_precision = true;
    const auto by_degree = static_cast<double>(SparseCholesky(system, options).factor_nonzeros());
    options.order = fill_reducing_ordering(graph_of(mesh), 1);
    return static_cast<double>(SparseCholesky(system, options).factor_nonzeros()) / by_degree;
  };
  EXPECT_LT(fill_over_minimum_degree(shapes::grid(180, 170)), 1);
  EXPECT_LT(fill_over_minimum_degree(shapes::tapered_arm(120, 260)), 1.2);
}

/// Fails if the factorisation ignores an order, reads it the other way round, or hands it back wrong.
TEST(EliminationOrder, IsTheOneTheFactorHas) {
  constexpr int kSize = 300;
  // A star: eliminating its centre first fills the whole factor, eliminating it last fills nothing.
  SparseMatrix star(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    star.insert(i, i) = i == 5 ? kSize : 2 + 0.01 * i;
    star.coeffRef(std::max(i, 5), std::min(i, 5)) += i == 5 ? 0 : -0.5;
  }
  star.makeCompressed();
  std::mt19937 random(6);
  const Points expected = Points::NullaryExpr(kSize, 3, [&] { return random() / 2147483648.0 - 1; });
  const Points right = star.selfadjointView<Eigen::Lower>() * expected;
  std::vector<int> all = support::shuffled(kSize, 8), good = all;
  std::swap(good.back(), *std::find(good.begin(), good.end(), 5));
  const std::vector<int> bad(good.rbegin(), good.rend());
  std::sort(all.begin(), all.end());
  for (const CholeskyBackend backend : {CholeskyBackend::Supernodal, CholeskyBackend::Eigen}) {
    for (const bool single : {false, true}) {
      for (const std::vector<int>& order : {bad, good, std::vector<int>()}) {
        CholeskyOptions options;
        options.backend = backend;
        options.single_precision = single;
        options.order = order;
        SparseCholesky factor(star, options);
        EXPECT_EQ(factor.factor_nonzeros() > kSize * (kSize - 2) / 2U, order == bad) << factor.backend_name();
        Points x;
        factor.solve(right, x);
        EXPECT_LT((x - expected).norm(), (factor.single_precision() ? 1e-5 : 1e-13) * expected.norm());
        std::vector<int> back = factor.order();
        EXPECT_TRUE(backend != CholeskyBackend::Eigen || order.empty() || back == order);
        std::sort(back.begin(), back.end());
        EXPECT_EQ(back, all) << factor.backend_name();
      }
    }
  }
}

// --- what an editor takes over from another one ---

struct Job {
  TriangleMesh mesh = shapes::letter_field(60, 30);
  Region region;
  EditSettings settings;

  explicit Job(double radius = 0.9) {
    RegionSpec spec;
    spec.radius = radius;
    region = build_region(mesh, support::adjacency_of(mesh), spec, {{support::vertex_at(mesh, {2, 1, 0})}});
  }
  /// Other handles in the same region with the same anchors, given by their numbers among the free vertices.
  void set_handles(const std::vector<int>& numbers) {
    std::vector<int> free;
    for (int i = 0; i < region.size(); ++i) {
      if (region.classes[i] != VertexClass::Anchor) {
        region.classes[i] = VertexClass::Free;
        region.group[i] = -1;
        free.push_back(i);
      }
    }
    for (const int number : numbers) {
      region.classes[free[number]] = VertexClass::Handle;
      region.group[free[number]] = 0;
    }
  }
  std::unique_ptr<LaplacianEditor> editor(std::unique_ptr<LaplacianEditor> previous = nullptr) const {
    return std::make_unique<LaplacianEditor>(mesh, region, settings, Progress(), std::move(previous));
  }
};

/// Expects that a job comes out the same, whatever has been done before.
void expect_same(const std::string& what, const Job& before, const Job& job) {
  const std::vector<HandleMotion> maps{support::rigid(20, {0, 1, 1}, {0.1, 0.2, 0.4}, {2, 1, 0})};
  std::unique_ptr<LaplacianEditor> fresh = job.editor(), previous = before.editor();
  previous->solve(maps);
  const auto taken = job.editor(std::move(previous));
  for (int time = 0; time < 2; ++time) {
    EXPECT_TRUE(support::same_bits(taken->solve(maps), fresh->solve(maps))) << what;
    EXPECT_TRUE(taken->rotations() == fresh->rotations()) << what;
  }
}

/// Fails if nothing is taken over: all else would come out the same, only later.
TEST(TakingOver, SmallHandlesFindTheFactorReady) {
  const Job before;
  Job job, patch;
  std::vector<int> many(20);
  std::iota(many.begin(), many.end(), 90);
  patch.set_handles(many);
  for (const std::vector<int>& handles : {std::vector<int>{77}, {100, 3, 55}}) {
    job.set_handles(handles);
    EXPECT_FALSE(job.editor()->report().factor_taken_over);
    EXPECT_TRUE(job.editor(before.editor())->report().factor_taken_over);
    EXPECT_FALSE(job.editor(patch.editor())->report().factor_taken_over) << "it knows its handle";
  }
  EXPECT_FALSE(patch.editor(before.editor())->report().factor_taken_over);
}

/// Fails if something is taken over that does not fit, or is left from before.
TEST(TakingOver, OtherHandlesComeOutTheSame) {
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    for (const CholeskyBackend backend : {CholeskyBackend::Supernodal, CholeskyBackend::Eigen}) {
      for (const DetailRotation rotation :
           {DetailRotation::None, DetailRotation::SmoothNormals, DetailRotation::SmoothSurface}) {
        Job before, job;
        before.settings.laplacian = laplacian;
        before.settings.backend = backend;
        before.settings.rotation = rotation;
        job.settings = before.settings;
        std::vector<int> patch(20);
        std::iota(patch.begin(), patch.end(), 90);
        for (const std::vector<int>& handles : {std::vector<int>{77}, {100, 3, 55}, patch}) {
          job.set_handles(handles);
          const std::string what = std::string(name(laplacian)) + ", " + name(rotation) + ", " +
                                   std::to_string(handles.size()) + " handles after ";
          expect_same(what + "one", before, job);
          Job twice = before;
          twice.set_handles(patch);
          expect_same(what + "a patch", twice, job);
        }
      }
    }
  }
}

/// Fails if the shape that something was made for is not compared. Only edges decide on the umbrella's factor.
TEST(TakingOver, OtherShapesComeOutTheSame) {
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    Job before;
    before.settings.laplacian = laplacian;
    Job bent = before, turned = before, wider(1.0);
    wider.settings = before.settings;
    for (auto vertex : bent.mesh.vertices.rowwise()) {
      vertex[2] += 0.1 * vertex[0] * vertex[0];
    }
    bent.set_handles({60});
    // The other diagonal of every cell: the same vertices, other edges.
    for (Eigen::Index f = 0; f + 1 < turned.mesh.faces.rows(); f += 2) {
      const int q = turned.mesh.faces.row(f).minCoeff(), far = turned.mesh.faces.row(f + 1).maxCoeff();
      turned.mesh.faces.row(f) << q, far - 1, far;
      turned.mesh.faces.row(f + 1) << q, far, q + 1;
    }
    const std::string what = name(laplacian);
    expect_same(what + ", bent", before, bent);
    expect_same(what + ", back", bent, before);
    expect_same(what + ", wider", before, wider);
    expect_same(what + ", narrower", wider, before);
    const std::vector<int> inside = before.region.mesh_vertex;
    RegionSpec spec;
    spec.kind = RegionSpec::Kind::Vertices;
    spec.vertices = inside;
    const std::vector<std::vector<int>> handle{{support::vertex_at(before.mesh, {2, 1, 0})}};
    before.region = build_region(before.mesh, support::adjacency_of(before.mesh), spec, handle);
    turned.region = build_region(turned.mesh, support::adjacency_of(turned.mesh), spec, handle);
    ASSERT_EQ(before.region.mesh_vertex, turned.region.mesh_vertex);
    ASSERT_NE(before.region.neighbours.values, turned.region.neighbours.values);
    expect_same(what + ", other edges", before, turned);
  }
}

/// Fails if a setting that something was made for is not compared.
TEST(TakingOver, OtherSettingsComeOutTheSame) {
  std::vector<EditSettings> all(12);
  all[1].order = 2;
  all[2].laplacian = LaplacianKind::Cotangent;
  all[3].handle_weight = 3;
  all[4].anchor_weight = 3;
  all[5].backend = CholeskyBackend::Eigen;
  all[6].rotation = DetailRotation::None;
  all[7].rotation = DetailRotation::SmoothNormals;
  all[8].normal_radius = 0.2;
  all[9].threads = 1;
  all[10].iterations = 3;
  all[11].order = 2;
  all[11].laplacian = LaplacianKind::Cotangent;
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = 0; b < all.size(); ++b) {
      Job before(0.6), job(0.6);
      before.settings = all[a];
      job.settings = all[b];
      job.set_handles({20});
      expect_same("settings " + std::to_string(b) + " after " + std::to_string(a), before, job);
    }
  }
}

}  // namespace
}  // namespace lapedit
