// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/laplacian_system.h"

#include <gtest/gtest.h>

#include <numeric>

#include "shapes.h"
#include "support.h"

namespace lapedit::laplacian_system_test {
namespace {

using System = std::shared_ptr<const LaplacianSystem>;

/// A field of letters whose handle moves on while region and anchors stay.
struct Scene {
  TriangleMesh mesh = shapes::letter_field(60, 40);
  Region first, second;

  Scene() {
    first = support::whole_region(mesh, {{1200}}, boundary());
    second = support::whole_region(mesh, {{1321}}, boundary());
    second.max_distance = first.max_distance;  // as where anchors are kept
  }
  std::vector<int> boundary() const {
    std::vector<int> vertices;
    for (int v = 0; v < 2400; ++v) {
      if (v < 80 || v >= 2320) {
        vertices.push_back(v);
      }
    }
    return vertices;
  }
};

System prepared(const TriangleMesh& mesh, const Region& region, const EditSettings& settings,
                const LaplacianSystem* previous = nullptr) {
  return prepare_system(mesh, support::rest_pose(mesh, region), settings, {}, previous);
}

const EditSettings kSettings[] = {EditSettings(), EditSettings::of(EditMethod::Paper)};

/// Each component is shared if all that it is made from is the same.
TEST(LaplacianSystem, OnlyWhatFitsIsShared) {
  const Scene scene;
  const System first = prepared(scene.mesh, scene.first, EditSettings::of(EditMethod::Paper));
  const auto next = [&](auto change) {
    EditSettings settings = EditSettings::of(EditMethod::Paper);
    change(settings);
    return prepared(scene.mesh, scene.second, settings, first.get());
  };
  const System heavier = next([](EditSettings& s) { s.anchor_weight = 20; });
  EXPECT_EQ(heavier->powers.m, first->powers.m);
  EXPECT_NE(heavier->matrix, first->matrix);
  const System wider = next([](EditSettings& s) { s.normal_radius = 0.7; });
  EXPECT_EQ(wider->matrix, first->matrix);
  EXPECT_EQ(wider->normal_radius, 0.7);
  const System cotangent = next([](EditSettings& s) { s.laplacian = LaplacianKind::Cotangent; });
  EXPECT_NE(cotangent->powers.m, first->powers.m);
  EXPECT_NE(cotangent->matrix, first->matrix);
  const System higher = next([](EditSettings& s) { s.order = 2; });
  EXPECT_NE(higher->powers.m, higher->powers.first);
  EXPECT_NE(higher->matrix, first->matrix);
  const System stretched = next([](EditSettings& s) { s.membrane = 100; });
  EXPECT_NE(stretched->powers.m, first->powers.m);
  EXPECT_NE(stretched->matrix, first->matrix);
  const System plain = next([](EditSettings& s) { s.method = EditMethod::Linear; });
  EXPECT_EQ(plain->kernel, nullptr);
  EXPECT_EQ(plain->matrix, first->matrix);
}

/// A disc of a CAD program at the end of a tube. Its middle has the square of its neighbours in the matrix of order 2.
TEST(LaplacianSystem, FanTakesMemoryOfItsSizeOrIsRefused) {
  constexpr int kAround = 4000;
  TriangleMesh mesh = shapes::cylinder(kAround, 3);  // its first vertex is the middle of a disc, and its last one
  mesh.vertices.col(0) *= 0.05;
  std::vector<int> boundary(kAround + 1);
  std::iota(boundary.begin(), boundary.end(), 2 * kAround + 1);
  const Region region = support::whole_region(mesh, {{7}}, boundary);
  for (const EditMethod method : {EditMethod::Default, EditMethod::Linear}) {
    const System system = prepared(mesh, region, EditSettings::of(method));
    EXPECT_EQ(system->matrix->long_rows.size(), 2U);
    EXPECT_LT(system->matrix->cholesky.factor_nonzeros(), 100U * mesh.vertices.rows()) << name(method);
  }
  EditSettings second;
  second.order = 2;
  const std::string refusal =
      support::expect_refusal(ErrorCause::BadParameter, [&] { prepared(mesh, region, second); });
  support::expect_contains(refusal, "Vertex 0 has 4000 neighbours");
}

}  // namespace
}  // namespace lapedit::laplacian_system_test
