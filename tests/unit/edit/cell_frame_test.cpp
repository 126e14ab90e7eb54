// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "shapes.h"
#include "support.h"

namespace lapedit::cell_frame_test {
namespace {

using Maps = std::vector<HandleMotion>;
using support::around;
using support::rigid;
using support::shift;
using support::within;

struct Scene {
  std::string name;
  TriangleMesh mesh;
  std::shared_ptr<const Region> region;
  Maps maps;
  EditSettings settings;
  double largest_rms, largest_error;  // of the handle's displacement

  Points frame() const {
    StepSolver solver(mesh, {region}, settings);
    solver.make_cells();
    Points positions;
    solver.frame(maps, positions);
    return positions;
  }
  Points rest() const { return support::rows(mesh.vertices, region->mesh_vertex); }
};

Scene scene(const std::string& name, const TriangleMesh& mesh, const RegionSpec& spec,
            const std::vector<std::vector<int>>& handles, Maps maps, const EditSettings& settings, double rms,
            double largest) {
  return {
      name, mesh,   std::make_shared<const Region>(support::region_of(mesh, spec, handles)), std::move(maps), settings,
      rms,  largest};
}

EditSettings with(LaplacianKind kind, EditMethod method) {
  EditSettings settings = EditSettings::of(method);
  settings.laplacian = kind;
  return settings;
}

/// Every kind of handle, order, operator and rotation on some thousand vertices, and every kind of handle by default.
/// The bounds are what is seen, and a half on top.
std::vector<Scene> scenes() {
  const TriangleMesh letters = shapes::letter_field(254, 127), grid = shapes::bumpy_grid();
  const TriangleMesh ball = shapes::icosphere(5);
  const auto at = [](const TriangleMesh& mesh, const Vector3& p) { return support::vertex_at(mesh, p); };
  const Vector3 middle = Vector3(2, 1, 0);
  std::vector<int> line;
  for (int v = 60 * 50 + 20; v <= 60 * 50 + 40; ++v) {
    line.push_back(v);
  }
  const auto umbrella = LaplacianKind::Umbrella, cotangent = LaplacianKind::Cotangent;
  const auto paper = EditMethod::Paper, linear = EditMethod::Linear;
  return {
      scene("vertex", letters, within(0.9), {{at(letters, middle)}}, {shift({0.2, 0.1, 0.5})}, with(umbrella, paper),
            0.14, 0.33),
      scene("unrotated", letters, within(0.9), {{at(letters, middle)}}, {shift({0.2, 0.1, 0.5})},
            with(umbrella, linear), 0.09, 0.32),
      scene("turned", letters, within(0.8), {around(letters, middle, 0.15)},
            {rigid(30, {0, 1, 0}, {0, 0.1, 0.3}, middle)}, with(umbrella, paper), 0.08, 0.28),
      scene("two groups", letters, within(0.55),
            {around(letters, {1.4, 1, 0}, 0.12), around(letters, {2.6, 1, 0}, 0.12)},
            {shift({0, 0, 0.4}), rigid(25, {1, 0, 0}, {0, 0, -0.2}, {2.6, 1, 0})}, with(cotangent, paper), 0.066, 0.19),
      scene("curve", grid, within(25), {line}, {shift({0, 0, 8})}, with(umbrella, paper), 0.13, 0.33),
      scene("cotangent", ball, within(1.5), {{at(ball, {0, 0, 1})}}, {shift({0.2, 0, 0.5})}, with(cotangent, paper),
            0.063, 0.16),
      scene("vertex by default", letters, within(0.9), {{at(letters, middle)}}, {shift({0.2, 0.1, 0.5})}, {}, 0.09,
            0.25),
      scene("turned by default", letters, within(0.8), {around(letters, middle, 0.15)},
            {rigid(30, {0, 1, 0}, {0, 0.1, 0.3}, middle)}, {}, 0.08, 0.28),
      scene("two groups by default", letters, within(0.6),
            {around(letters, {1.4, 1, 0}, 0.12), around(letters, {2.6, 1, 0}, 0.12)},
            {shift({0, 0, 0.4}), rigid(25, {1, 0, 0}, {0, 0, -0.2}, {2.6, 1, 0})}, {}, 0.08, 0.38),
      scene("curve by default", grid, within(25), {line}, {shift({0, 0, 8})}, {}, 0.036, 0.125),
      scene("ball by default", ball, within(1.5), {{at(ball, {0, 0, 1})}}, {shift({0.2, 0, 0.5})}, {}, 0.05, 0.106),
  };
}

double longest_displacement(const Scene& s, const Points& pose) {
  double longest = 0;
  const Points rest = s.rest();
  for (int i = 0; i < s.region->size(); ++i) {
    if (s.region->classes[i] == VertexClass::Handle) {
      longest = std::max(longest, (pose.row(i) - rest.row(i)).norm());
    }
  }
  return longest;
}

TEST(CellFrame, IsNearTheFullPoseForEveryKindOfHandle) {
  for (const Scene& s : scenes()) {
    const Points full = support::Prepared(s.mesh, *s.region, s.settings).pose(s.maps);
    const Points difference = s.frame() - full;
    const double way = longest_displacement(s, full);
    const double rms = std::sqrt(difference.squaredNorm() / static_cast<double>(difference.rows())) / way;
    const double most = difference.rowwise().norm().maxCoeff() / way;
    std::cout << s.name << ": " << s.region->size() << " vertices, RMS " << 100 * rms << " %, largest " << 100 * most
              << " % of the handle's displacement\n";
    EXPECT_LT(rms, s.largest_rms) << s.name;
    EXPECT_LT(most, s.largest_error) << s.name;
  }
}

/// A handle is weighed against the surface, as in the solution.
TEST(CellFrame, HandleAndBoundaryAreAtTheirTargets) {
  for (const Scene& s : scenes()) {
    const Points pose = s.frame(), rest = s.rest();
    int boundary = 0;
    for (int i = 0; i < s.region->size(); ++i) {
      if (s.region->classes[i] == VertexClass::Handle) {
        const Vector3 wanted = s.maps[s.region->group[i]].map * Vector3(rest.row(i));
        EXPECT_LT((pose.row(i).transpose() - wanted).norm(), 1e-3 * longest_displacement(s, pose)) << s.name;
      } else if (s.region->anchor_depth[i] == 1) {
        EXPECT_EQ(pose.row(i), rest.row(i)) << s.name;
        ++boundary;
      }
    }
    EXPECT_GT(boundary, 0) << s.name;
  }
}

}  // namespace
}  // namespace lapedit::cell_frame_test
