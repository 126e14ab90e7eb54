// SPDX-License-Identifier: GPL-3.0-or-later
// Frames before a region is prepared, against the full pose: the recorded edits on real meshes.
#include "lapedit/edit/step_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/json/edit_script.h"
#include "mesh_loader.h"
#include "support.h"

namespace lapedit {
namespace {

/// An edit of tests/hosts/edits, and half as much again as its RMS error is seen to be, over the handle's way: as it
/// was recorded, and by default.
struct Recorded {
  const char *mesh, *edit;
  double rms, by_default;
};

const Recorded kRecorded[] = {
    {"bumpy_plane.off", "crest", 0.07, 0.057},
    {"bumpy_plane.off", "hill_cotangent", 0.069, 0.018},
    {"bumpy_plane.off", "hill_to_the_border", 0.092, 0.05},
    {"igea.ply", "all_held_at_the_back", 0.17, 0.044},
    {"igea.ply", "nose_and_face", 0.016, 0.024},
    {"igea.ply", "nose_order_3", 0.18, 0.024},
    {"octopus.off", "body_held_by_another_tentacle", 0.23, 0.143},
    {"octopus.off", "most_of_the_body", 0.032, 0.042},
};

TEST(RealCellFrame, AreNearTheFullPose) {
  for (const Recorded& recorded : kRecorded) {
    const TriangleMesh mesh = real::load(recorded.mesh);
    const Edit edit = load_edit(std::string(LAPEDIT_SOURCE_DIR) + "/tests/hosts/edits/" + recorded.mesh + "/" +
                                recorded.edit + ".json");
    const EditStep& step = edit.steps[0];
    std::vector<std::vector<int>> groups;
    std::vector<HandleMotion> maps;
    for (const HandleGroup& handle : step.handles) {
      groups.push_back(handle.vertices);
      maps.push_back(resolve(handle.transform, centroid(mesh.vertices, handle.vertices)));
    }
    const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
    for (const EditSettings& settings : {step.settings, EditSettings()}) {
      const bool by_default = settings == EditSettings();
      StepSolver solver(mesh, find_region(mesh, adjacency, step.region, groups), settings);
      const Region& region = solver.region();
      Points pose;
      solver.make_cells(mesh);
      solver.frame(maps, pose);
      solver.prepare(mesh);
      const Points full = solver.pose(maps);
      double way = 0, handle_off = 0;
      for (int i = 0; i < region.size(); ++i) {
        const Vector3 rest = mesh.vertices.row(region.mesh_vertex[i]).transpose();
        if (region.classes[i] == VertexClass::Handle) {
          way = std::max(way, (full.row(i).transpose() - rest).norm());
          handle_off = std::max(handle_off, (pose.row(i).transpose() - maps[region.group[i]].map * rest).norm());
        } else if (region.anchor_depth[i] == 1) {
          EXPECT_EQ(pose.row(i).transpose(), rest);
        }
      }
      EXPECT_LT(handle_off, 0.01 * way) << recorded.mesh << ", " << recorded.edit;
      const Points difference = pose - full;
      const double rms = std::sqrt(difference.squaredNorm() / static_cast<double>(difference.rows())) / way;
      std::cout << recorded.mesh << ", " << recorded.edit << (by_default ? " by default: " : ": ") << region.size()
                << " vertices, " << solver.cells()->cells().count() << " cells, RMS " << 100 * rms << " %, largest "
                << 100 * difference.rowwise().norm().maxCoeff() / way << " % of the handle's way\n";
      EXPECT_LT(rms, by_default ? recorded.by_default : recorded.rms) << recorded.mesh << ", " << recorded.edit;
    }
  }
}

}  // namespace
}  // namespace lapedit
