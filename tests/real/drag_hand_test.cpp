// SPDX-License-Identifier: GPL-3.0-or-later
// What is in the hand before a region is prepared, against the full pose: the recorded edits on real meshes.
#include "lapedit/live/drag_frames.h"

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

/// Those of regions for which there is a stand-in. Where a limb is thinner than the smoothing, or a group turns a mesh
/// that nothing holds, the rotations are not what the cells resolve.
const Recorded kRecorded[] = {
    {"bumpy_plane.off", "crest", 0.06, 0.037},
    {"bumpy_plane.off", "hill_cotangent", 0.009, 0.014},
    {"bumpy_plane.off", "hill_to_the_border", 0.035, 0.035},
    {"igea.ply", "all_held_at_the_back", 0.125, 0.12},
    {"igea.ply", "nose_and_face", 0.015, 0.029},
    {"igea.ply", "nose_order_3", 0.16, 0.039},
    {"octopus.off", "body_held_by_another_tentacle", 0.34, 1.13},
    {"octopus.off", "most_of_the_body", 0.027, 0.069},
    {"octopus.off", "tentacle_and_root_order_2", 0.037, 0.11},
};

TEST(RealDragHand, AreNearTheFullPose) {
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
      const FoundRegion found = find_region({mesh, adjacency, step.region, groups, settings});
      const Region& region = *found.region;
      LaplacianEditor editor(mesh, region, settings);
      const Points full = editor.solve(maps);
      DragFrames frames(mesh, found.region, settings);
      const Points pose = frames.pose(maps);
      double way = 0;
      for (int i = 0; i < region.size(); ++i) {
        const Vector3 rest = mesh.vertices.row(region.mesh_vertex[i]).transpose();
        if (region.classes[i] == VertexClass::Handle) {
          way = std::max(way, (full.row(i).transpose() - rest).norm());
          EXPECT_LT((pose.row(i).transpose() - maps[region.group[i]].map * rest).norm(), 0.01 * way);
        } else if (region.anchor_depth[i] == 1) {
          EXPECT_EQ(pose.row(i).transpose(), rest);
        }
      }
      const Points difference = pose - full;
      const double rms = std::sqrt(difference.squaredNorm() / static_cast<double>(difference.rows())) / way;
      std::cout << recorded.mesh << ", " << recorded.edit << (by_default ? " by default: " : ": ") << region.size()
                << " vertices, " << frames.cells()->cells().count() << " cells, RMS " << 100 * rms << " %, largest "
                << 100 * difference.rowwise().norm().maxCoeff() / way << " % of the handle's way\n";
      EXPECT_LT(rms, by_default ? recorded.by_default : recorded.rms) << recorded.mesh << ", " << recorded.edit;
    }
  }
}

}  // namespace
}  // namespace lapedit
