// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// A region that was made by hand, before its distances are known: its rim as anchors. O(region).
Region region_by_hand(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups);

/// The region on the screen and the pose that it is shown in.
class ShownRegion {
 public:
  /// Shows a region as it is in the mesh; null: none.
  void show(std::shared_ptr<const Region> region, const TriangleMesh& mesh);
  /// Takes a region that is to be shown together with its first pose: until then the old one stays.
  void await(std::shared_ptr<const Region> region) { awaited_ = std::move(region); }
  std::shared_ptr<const Region> take_awaited() { return std::move(awaited_); }
  /// Swaps the pose for another one, which is not the mesh's. Allocates nothing.
  void pose(Points& places);
  /// What is shown has become the mesh.
  void settle();
  /// Goes back to the mesh. @return whether the pose was another one
  bool rest(const TriangleMesh& mesh);

  const std::shared_ptr<const Region>& region() const { return region_; }
  const Points& pose() const { return pose_; }  ///< one row per vertex of the region
  int serial() const { return serial_; }        ///< counts the changes of region() and pose()
  int region_serial() const { return region_serial_; }
  /// Vertices of a class, 0 without a region.
  int count(VertexClass c) const { return counts_[static_cast<int>(c)]; }
  /// Vertices of pieces that a single handle would carry along as a whole, since nothing else holds them.
  int held_by_nothing() const { return held_by_nothing_; }
  bool away() const { return away_; }  ///< the pose is another one than the mesh's

 private:
  std::shared_ptr<const Region> region_, awaited_;
  Points pose_;
  int counts_[4] = {};
  int held_by_nothing_ = 0;
  int serial_ = 0, region_serial_ = 0;
  bool away_ = false;
};

}  // namespace lapedit
