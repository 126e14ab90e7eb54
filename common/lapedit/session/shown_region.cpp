// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/shown_region.h"

#include <algorithm>

#include "lapedit/mesh/region.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

void ShownRegion::show(std::shared_ptr<const Region> region, const TriangleMesh& mesh, double part_of_piece) {
  region_ = std::move(region);
  part_of_piece_ = part_of_piece;
  std::fill(std::begin(counts_), std::end(counts_), 0);
  held_by_nothing_ = 0;
  if (region_) {
    pose_ = gather(mesh.vertices, region_->mesh_vertex);
    for (const VertexClass c : region_->classes) {
      ++counts_[static_cast<int>(c)];
    }
    held_by_nothing_ = lapedit::held_by_nothing(*region_);
  }
  away_ = false;
  ++serial_;
  ++region_serial_;
}

void ShownRegion::pose(Points& positions) {
  pose_.swap(positions);
  away_ = true;
  ++serial_;
}

void ShownRegion::settle() {
  away_ = false;
  ++serial_;
}

bool ShownRegion::rest(const TriangleMesh& mesh) {
  if (!away_ || !region_) {
    return false;
  }
  pose_ = gather(mesh.vertices, region_->mesh_vertex);
  settle();
  return true;
}

}  // namespace lapedit
