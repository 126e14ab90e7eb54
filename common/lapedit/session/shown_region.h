// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// The shown region and its pose.
class ShownRegion {
 public:
  /// Shows a region as it is in the mesh; null: none. @param part_of_piece  HoverSearch::part_of_piece(); 0: unknown
  void show(std::shared_ptr<const Region> region, const TriangleMesh& mesh, double part_of_piece = 0);
  /// Stores a region that is shown together with its first pose; until then the old one stays.
  void await(std::shared_ptr<const Region> region) { awaited_ = std::move(region); }
  std::shared_ptr<const Region> take_awaited() { return std::move(awaited_); }
  /// Shows a pose that differs from the mesh, swapping it with the old one. Allocates nothing.
  void pose(Points& positions);
  /// Records that the shown pose has become the mesh.
  void settle();
  /// Shows the mesh again. @return whether the pose was another one
  bool rest(const TriangleMesh& mesh);

  const std::shared_ptr<const Region>& region() const { return region_; }
  const Points& pose() const { return pose_; }  ///< one row per vertex of the region
  int serial() const { return serial_; }        ///< counts the changes of region() and pose()
  int region_serial() const { return region_serial_; }
  /// Returns the number of vertices of a class, 0 without a region.
  int count(VertexClass c) const { return counts_[static_cast<int>(c)]; }
  /// Returns the number of vertices in pieces that a single handle would move rigidly, since nothing else holds them.
  int held_by_nothing() const { return held_by_nothing_; }
  double part_of_piece() const { return part_of_piece_; }
  bool away() const { return away_; }  ///< the pose differs from the mesh

 private:
  std::shared_ptr<const Region> region_, awaited_;
  Points pose_;
  int counts_[4] = {};
  int held_by_nothing_ = 0;
  double part_of_piece_ = 0;
  int serial_ = 0, region_serial_ = 0;
  bool away_ = false;
};

}  // namespace lapedit
