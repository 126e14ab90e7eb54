// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Frames of a drag before a region is prepared: about the pose that LaplacianEditor::solve() gives, without a factor
/// of the region. Unrotated result, rotations and result are worked out on some thousand cells (RegionCells) and
/// blended onto the vertices, which carry their details turned along (an embedded deformation). Handles and the
/// region's rim are exactly in place. For every setting, region and kind of handle.
class CoarsePreview {
 public:
  /// @param mesh  rest pose; not kept
  /// Cost: O(edges), a small part of LaplacianEditor's.
  /// @throws EditError (NoHandle, IllConditioned, Cancelled)
  CoarsePreview(const TriangleMesh& mesh, std::shared_ptr<const Region> region, const EditSettings& settings,
                const Progress& progress = {});
  ~CoarsePreview();

  /// @param handles  one motion per handle group
  /// @return         size() x 3, row i belongs to region.mesh_vertex[i]; valid until the next call
  /// Nothing is allocated after the first call. @throws EditError (NoHandle, NotFinite)
  const Points& pose(const std::vector<HandleMotion>& handles);

  int cells() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
