// SPDX-License-Identifier: GPL-3.0-or-later
// What a StepSolver reuses of the system of an earlier one.
#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "shapes.h"
#include "support.h"

namespace lapedit::reused_system_test {
namespace {

using support::Prepared;

struct Job {
  TriangleMesh mesh = shapes::letter_field(60, 30);
  Region region;
  EditSettings settings;
  SolverOptions options;

  explicit Job(double radius = 0.9) {
    region = support::region_of(mesh, support::within(radius), {{support::vertex_at(mesh, {2, 1, 0})}});
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
  Prepared solver(const LaplacianSystem* previous = nullptr) const {
    return {mesh, region, settings, {StoredScalar::Double, {}, options}, previous};
  }
  std::shared_ptr<const LaplacianSystem> system(const LaplacianSystem* previous = nullptr) const {
    return solver(previous).system();
  }
};

/// Expects that a job comes out the same, whatever has been done before, and leaves the solver before it as it was.
void expect_same(const std::string& what, const Job& before, const Job& job) {
  const std::vector<HandleMotion> maps{support::rigid(20, {0, 1, 1}, {0.1, 0.2, 0.4}, {2, 1, 0})};
  Prepared fresh = job.solver(), previous = before.solver();
  const Points kept = previous.pose(maps);
  Prepared reusing = job.solver(previous.system().get());
  for (int time = 0; time < 2; ++time) {
    EXPECT_TRUE(support::same_bits(reusing.pose(maps), fresh.pose(maps))) << what;
    EXPECT_TRUE(reusing.rotations() == fresh.rotations()) << what;
    EXPECT_TRUE(support::same_bits(previous.pose(maps), kept)) << what;
  }
}

TEST(ReusedSystem, SmallHandlesFindTheFactorReady) {
  const Job before;
  Job job, patch;
  std::vector<int> many(20);
  std::iota(many.begin(), many.end(), 90);
  patch.set_handles(many);
  for (const std::vector<int>& handles : {std::vector<int>{77}, {100, 3, 55}}) {
    job.set_handles(handles);
    const auto one = before.system(), other = patch.system();
    EXPECT_EQ(job.system(one.get())->matrix, one->matrix);
    EXPECT_NE(job.system(other.get())->matrix, other->matrix) << "it has its handle in the factor";
    EXPECT_NE(patch.system(one.get())->matrix, one->matrix);
  }
}

/// Each component is shared if all that it is made from is the same.
TEST(ReusedSystem, OnlyWhatFitsIsShared) {
  Job before, job;
  before.settings = EditSettings::of(EditMethod::Paper);
  job.set_handles({77});
  const auto first = before.system();
  const auto next = [&](auto change) {
    job.settings = before.settings;
    change(job.settings);
    return job.system(first.get());
  };
  const auto heavier = next([](EditSettings& s) { s.anchor_weight = 20; });
  EXPECT_EQ(heavier->powers.m, first->powers.m);
  EXPECT_NE(heavier->matrix, first->matrix);
  const auto wider = next([](EditSettings& s) { s.normal_radius = 0.7; });
  EXPECT_EQ(wider->matrix, first->matrix);
  EXPECT_EQ(wider->normal_radius, 0.7);
  const auto cotangent = next([](EditSettings& s) { s.laplacian = LaplacianKind::Cotangent; });
  EXPECT_NE(cotangent->powers.m, first->powers.m);
  EXPECT_NE(cotangent->matrix, first->matrix);
  const auto higher = next([](EditSettings& s) { s.order = 2; });
  EXPECT_NE(higher->powers.m, higher->powers.first);
  EXPECT_NE(higher->matrix, first->matrix);
  const auto stretched = next([](EditSettings& s) { s.membrane = 100; });
  EXPECT_NE(stretched->powers.m, first->powers.m);
  EXPECT_NE(stretched->matrix, first->matrix);
  const auto plain = next([](EditSettings& s) { s.method = EditMethod::Linear; });
  EXPECT_EQ(plain->kernel, nullptr);
  EXPECT_EQ(plain->matrix, first->matrix);
}

TEST(ReusedSystem, OtherHandlesComeOutTheSame) {
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    for (const EditMethod method : {EditMethod::Linear, EditMethod::Paper, EditMethod::Default}) {
      Job before, job;
      before.settings = EditSettings::of(method);
      before.settings.laplacian = laplacian;
      job.settings = before.settings;
      std::vector<int> patch(20);
      std::iota(patch.begin(), patch.end(), 90);
      for (const std::vector<int>& handles : {std::vector<int>{77}, {100, 3, 55}, patch}) {
        job.set_handles(handles);
        const std::string what = std::string(name(laplacian)) + ", " + name(method) + ", " +
                                 std::to_string(handles.size()) + " handles after ";
        expect_same(what + "one", before, job);
        Job twice = before;
        twice.set_handles(patch);
        expect_same(what + "a patch", twice, job);
      }
    }
  }
}

/// Fails if the shape that something was made for is not compared. Only edges decide on the umbrella's factor.
TEST(ReusedSystem, OtherShapesComeOutTheSame) {
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    Job before;
    before.settings.laplacian = laplacian;
    Job bent = before, flipped = before, wider(1.0);
    wider.settings = before.settings;
    for (auto vertex : bent.mesh.vertices.rowwise()) {
      vertex[2] += 0.1 * vertex[0] * vertex[0];
    }
    bent.set_handles({60});
    // The other diagonal of every cell: the same vertices, other edges.
    for (Eigen::Index f = 0; f + 1 < flipped.mesh.faces.rows(); f += 2) {
      const int q = flipped.mesh.faces.row(f).minCoeff(), far = flipped.mesh.faces.row(f + 1).maxCoeff();
      flipped.mesh.faces.row(f) << q, far - 1, far;
      flipped.mesh.faces.row(f + 1) << q, far, q + 1;
    }
    const std::string what = name(laplacian);
    expect_same(what + ", bent", before, bent);
    expect_same(what + ", back", bent, before);
    expect_same(what + ", wider", before, wider);
    expect_same(what + ", narrower", wider, before);
    const std::vector<int> inside = before.region.mesh_vertex;
    const RegionSpec spec = support::given(inside);
    const std::vector<std::vector<int>> handle{{support::vertex_at(before.mesh, {2, 1, 0})}};
    before.region = build_region(before.mesh, support::adjacency_of(before.mesh), spec, handle);
    flipped.region = build_region(flipped.mesh, support::adjacency_of(flipped.mesh), spec, handle);
    ASSERT_EQ(before.region.mesh_vertex, flipped.region.mesh_vertex);
    ASSERT_NE(before.region.neighbours.values, flipped.region.neighbours.values);
    expect_same(what + ", other edges", before, flipped);
  }
}

TEST(ReusedSystem, OtherSettingsComeOutTheSame) {
  std::vector<EditSettings> all(4, EditSettings());
  all[1].laplacian = LaplacianKind::Cotangent;
  all[2].handle_weight = 3;
  all[3].anchor_weight = 3;
  for (const EditMethod method : {EditMethod::Paper, EditMethod::Linear}) {
    for (int k = 0; k < 4; ++k) {
      EditSettings& settings = all.emplace_back(EditSettings::of(method));
      settings.order = 1 + k / 2;
      settings.laplacian = k % 2 == 0 ? LaplacianKind::Umbrella : LaplacianKind::Cotangent;
    }
  }
  all[5].normal_radius = 0.2;
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
}  // namespace lapedit::reused_system_test
