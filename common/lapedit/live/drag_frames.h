// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/edit/laplacian_editor.h"

namespace lapedit {

/// Frames of a drag: approximations of the pose of LaplacianEditor::solve(), in a fraction of its time.
///
/// The cells' pose x0 is the frame until the region is prepared. Afterwards the frame is
///
///     x = x0 + A^-1 (b(R) - A x0),
///
/// where the residual is computed in double precision and one solve with the existing factor follows. The error of x0
/// is a few hundredths of the handle's displacement, so a solve with five digits is enough for a picture. The first
/// frame of a pose uses rotations of the cells after few passes; refine() makes the editor's remaining passes. Frames
/// do not depend on earlier ones. They exist for any number of groups, for targets of single vertices, and for
/// components without anchors.
///
/// Smooth normals and smooth surfaces have no such frames: see has_frames().
class DragFrames {
 public:
  /// Makes the cells; frames are x0.
  /// @param mesh  rest pose; not kept after construction
  /// @throws EditError (NoHandle, IllConditioned, Cancelled)
  DragFrames(const TriangleMesh& mesh, std::shared_ptr<const Region> region, const EditSettings& settings,
             const Progress& progress = {});
  /// The same with existing cells.
  DragFrames(std::shared_ptr<CellModel> cells, const EditSettings& settings);
  ~DragFrames();

  /// Returns the cells, with which an editor of the same region can be constructed.
  const std::shared_ptr<CellModel>& cells() const;

  /// Adds the correction to later frames.
  /// @param editor  made with cells(); must outlive its use, and its solver is used. Null: frames are x0
  /// Cost: O(vertices).
  void correct_with(const LaplacianEditor* editor);

  /// Returns whether frames exist with these settings.
  static bool has_frames(const EditSettings& settings);

  /// @param handles  one motion per handle group
  /// @return         size() x 3, row i belongs to region.mesh_vertex[i]; valid until the next call
  /// After the first call memory is allocated for targets only. @throws EditError (NoHandle, NotFinite)
  const Points& pose(const std::vector<HandleMotion>& handles);

  /// Improves the last pose: first with all passes of the cells, then with one more pass over the vertices per call, up
  /// to the editor's number.
  /// @return  whether there was such a pass; the result is in positions()
  /// Nothing is allocated after the first passes. @throws EditError (NotFinite)
  bool refine();
  const Points& positions() const;
  bool corrected() const;  ///< whether the last pose has the correction

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
