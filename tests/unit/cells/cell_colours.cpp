// SPDX-License-Identifier: GPL-3.0-or-later
// Prints for each vertex of the generated limb a colour of its cell, as common/demo/render.py knows colours of
// vertices; neighbouring cells differ. For the picture of the cells in common/docs/method.md
// (tests/bench/pictures.py).
//
// usage: cell_colours RADIUS VERTEX...   the handle's vertices, and the region's radius
#include <cstdio>
#include <cstdlib>
#include <set>
#include <vector>

#include "lapedit/cells/cell_pose.h"
#include "lapedit/cells/region_cells.h"
#include "mesh_support.h"
#include "shapes.h"

using namespace lapedit;

int main(int argc, char** argv) {
  constexpr int kFirst = 4, kFixed = 0;  // the renderer's colours of cells, and that of vertices outside
  if (argc < 3) {
    return 2;
  }
  RegionSpec spec;
  spec.radius = std::atof(argv[1]);
  std::vector<int> handle;
  for (int k = 2; k < argc; ++k) {
    handle.push_back(std::atoi(argv[k]));
  }
  const TriangleMesh mesh = shapes::tapered_arm(120, 140);
  const Region region = build_region(mesh, support::adjacency_of(mesh), spec, {handle});
  const Points rest = support::rows(mesh.vertices, region.mesh_vertex);
  ThreadPool pool(1);
  const RegionCells cells = make_cells(region, rest, CellPose::wanted_cells(region.size()), pool);
  std::vector<int> of_cell(cells.count(), -1);
  for (int c = 0; c < cells.count(); ++c) {
    std::set<int> taken;
    for (const int near : cells.neighbours[c]) {
      taken.insert(of_cell[near]);
    }
    for (of_cell[c] = 0; taken.count(of_cell[c]) > 0;) {
      ++of_cell[c];
    }
  }
  std::vector<int> colours(mesh.vertices.rows(), kFixed);
  for (int i = 0; i < region.size(); ++i) {
    colours[region.mesh_vertex[i]] = kFirst + of_cell[cells.of[i]];
  }
  for (const int colour : colours) {
    std::printf("%d\n", colour);
  }
  std::fprintf(stderr, "%d cells of %d vertices\n", cells.count(), region.size());
  return 0;
}
