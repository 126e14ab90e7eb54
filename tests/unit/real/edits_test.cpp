// SPDX-License-Identifier: GPL-3.0-or-later
// The edits proposed with the real meshes, as a host would make them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"
#include "mesh_loader.h"
#include "support.h"

namespace lapedit::edits_test {
namespace {

struct ProposedEdit {
  const char* name;
  const char* file;
  int handle;
  double radius;
  int vertices;  ///< of the region
  Vector3 way;
  double frame_rms;  ///< bound of a frame's RMS error, over the handle's way: what is seen, and a half on top
  bool held = true;  ///< some of the surface lies outside and holds the region
};

// The paper's sizes 1,201 and 12,774. On the regular grid sizes come in steps of four.
const ProposedEdit kEdits[] = {
    {"mannequin_small", "mannequin.off", 8624, 0.5873, 1201, Vector3(0, -0.9, 0), 0.019},
    {"mannequin_large", "mannequin.off", 8624, 1.1485, 3395, Vector3(0, -0.9, 0), 0.023},
    {"mannequin_far", "mannequin.off", 8624, 1.1485, 3395, Vector3(0, -1.29, 0), 0.021},
    {"octopus_most_of_a_tentacle", "octopus.off", 3175, 0.59351, 1385, Vector3(0, 0.437, 0), 0.117},
    {"octopus_tentacle", "octopus.off", 3175, 0.7842, 1818, Vector3(0, 0.437, 0), 0.14},
    {"octopus_4684", "octopus.off", 3175, 0.95984, 4684, Vector3(0, 0.437, 0), 0.064},
    {"octopus_12774", "octopus.off", 3175, 1.41216, 12774, Vector3(0, 0.437, 0), 0.059},
    {"octopus_body", "octopus.off", 3175, 1.74, 16554, Vector3(0, 0.437, 0), 0.36, false},
    {"bumpy_plane_5949", "bumpy_plane.off", 20200, 27.6535, 5949, Vector3(0, 0, 42.5), 0.04},
    {"bumpy_plane_11219", "bumpy_plane.off", 20200, 36.036, 11219, Vector3(0, 0, 42.5), 0.045},
    {"bumpy_plane_32281", "bumpy_plane.off", 20200, 57.1874, 32281, Vector3(0, 0, 42.5), 0.066},
    {"bunny_ear", "bunny.ply", 23637, 0.05643, 1905, Vector3(0.03, -0.05, 0.03), 0.054},
    {"igea_5482", "igea.ply", 31536, 0.018746, 5482, Vector3(0, 0, 0.02), 0.024},
    {"igea_19997", "igea.ply", 31536, 0.035247, 19997, Vector3(0, 0, 0.02), 0.024},
};

std::ostream& operator<<(std::ostream& out, const ProposedEdit& edit) {
  return out << edit.name;
}

class RealEdit : public ::testing::TestWithParam<ProposedEdit> {};
INSTANTIATE_TEST_SUITE_P(Proposed, RealEdit, ::testing::ValuesIn(kEdits),
                         [](const auto& edit) { return std::string(edit.param.name); });

TEST_P(RealEdit, LandsHoldsAndStaysWhole) {
  const ProposedEdit& edit = GetParam();
  const TriangleMesh mesh = real::load(edit.file);
  const Adjacency adjacency = support::adjacency_of(mesh);
  EditStep step;
  step.region.radius = edit.radius;
  step.handles.push_back({{edit.handle}, {}});
  step.handles[0].transform.translation = edit.way;
  const EditResult result = support::apply_step(mesh, step, 1, StoredScalar::Float);
  ASSERT_TRUE(result.positions.allFinite());
  ASSERT_EQ(result.vertices.size(), static_cast<std::size_t>(edit.vertices));
  Points after = mesh.vertices;
  std::vector<char> inside(mesh.vertices.rows(), 0);
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    after.row(result.vertices[i]) = result.positions.row(static_cast<Eigen::Index>(i));
    inside[result.vertices[i]] = 1;
  }
  double jump = 0;  // largest way of a region vertex with a neighbour outside
  bool held = false;
  for (const int v : result.vertices) {
    for (const int w : adjacency.neighbours[v]) {
      if (!inside[w]) {
        held = true;
        jump = std::max(jump, (after.row(v) - mesh.vertices.row(v)).norm());
      }
    }
  }
  const double way = edit.way.norm();
  const double miss = (after.row(edit.handle) - mesh.vertices.row(edit.handle) - edit.way.transpose()).norm();
  EXPECT_EQ(held, edit.held);
  EXPECT_LT(miss, 0.005 * way);
  EXPECT_LT(jump, 0.002 * way);

  const EditReport& report = result.reports.front();
  EXPECT_EQ(report.handle + report.free + report.anchors, static_cast<int>(result.vertices.size()));
  // A limb pulled sideways by one vertex folds at its tip; rotating the details undoes most of it.
  step.settings.method = EditMethod::Linear;
  const EditReport unrotated = support::apply_step(mesh, step, 1, StoredScalar::Float).reports.front();
  EXPECT_LE(report.flipped, std::max(unrotated.flipped / 2, 15));
  EXPECT_LE(report.flipped, 0.025 * 2 * static_cast<double>(result.vertices.size())) << "of about two per vertex";
}

/// A frame before the region is prepared, against the full pose.
TEST_P(RealEdit, FrameIsNearTheFullPose) {
  const ProposedEdit& edit = GetParam();
  const TriangleMesh mesh = real::load(edit.file);
  RegionSpec spec;
  spec.radius = edit.radius;
  StepSolver solver(mesh, find_region(mesh, support::adjacency_of(mesh), spec, {{edit.handle}}), EditSettings());
  const std::vector<HandleMotion> maps = {support::shift(edit.way)};
  solver.make_cells();
  Points frame;
  solver.frame(maps, frame);
  solver.prepare(mesh);
  const Points full = solver.pose(maps);
  const Region& region = solver.region();
  for (int i = 0; i < region.size(); ++i) {
    const Points rest = mesh.vertices.row(region.mesh_vertex[i]);
    if (region.classes[i] == VertexClass::Handle) {
      EXPECT_LT((frame.row(i) - rest - edit.way.transpose()).norm(), 0.01 * edit.way.norm());
    } else if (region.anchor_depth[i] == 1) {
      EXPECT_EQ(frame.row(i), rest);
    }
  }
  const double rms = (frame - full).norm() / std::sqrt(static_cast<double>(full.rows())) / edit.way.norm();
  EXPECT_LT(rms, edit.frame_rms);
}

}  // namespace
}  // namespace lapedit::edits_test
