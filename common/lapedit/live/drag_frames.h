// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/edit/laplacian_editor.h"

namespace lapedit {

/// Frames of a drag: pictures of the pose that LaplacianEditor::solve() gives, in a fraction of its time.
///
/// The cells' pose x0 is the frame until the region is prepared, and then the start of
///
///     x = x0 + A^-1 (b(R) - A x0),
///
/// with the residual through the edges of x0 in double precision and one solve with the factor that is there: x0 is off
/// by a few hundredths of the handle's way, so that five digits of the solve are enough for all that can be seen. The
/// first frame of a pose has rotations of the cells, with few passes on them; refine() goes through all that the editor
/// does. Frames depend on nothing that came before. For any number of groups, targets of single vertices, and
/// components without anchors.
///
/// Rotations that are not the cells' (smooth normals and surfaces) have no such frames: has_frames().
class DragFrames {
 public:
  /// x0 alone. @param mesh  rest pose; not kept
  /// @throws EditError (NoHandle, IllConditioned, Cancelled)
  DragFrames(const TriangleMesh& mesh, std::shared_ptr<const Region> region, const EditSettings& settings,
             const Progress& progress = {});
  /// The same with cells that are there already.
  DragFrames(std::shared_ptr<CellModel> cells, const EditSettings& settings);
  ~DragFrames();

  /// What an editor of the same region can be made with.
  const std::shared_ptr<CellModel>& cells() const;

  /// From now on with the correction. @param editor  made with cells(), or nothing: x0 alone. Must outlive its use; its
  ///                                                 pool is used
  /// Cost: O(vertices).
  void correct_with(const LaplacianEditor* editor);

  /// Whether there is a correction with these settings.
  static bool has_frames(const EditSettings& settings);

  /// @param handles  one motion per handle group
  /// @return         size() x 3, row i belongs to region.mesh_vertex[i]; valid until the next call
  /// Nothing is allocated after the first call, but for targets. @throws EditError (NoHandle, NotFinite)
  const Points& pose(const std::vector<HandleMotion>& handles);

  /// The pose again with the cells' rotations in full, then its next passes: never more than the editor's. @return
  /// whether there was one; it is in positions()
  /// Nothing is allocated after the first passes. @throws EditError (NotFinite)
  bool refine();
  const Points& positions() const;
  bool corrected() const;  ///< whether the last pose was

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
