// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/blended_rotations.h"
#include "lapedit/linear/refined_solver.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// What a drag preview is made from; all of it is read while it is made, none of it kept but factor and pool.
struct PreviewBase {
  const Region* region = nullptr;
  const Points* world = nullptr;        ///< rest pose, size() x 3
  const Points* smooth_rest = nullptr;  ///< the smoothed surface at rest; nothing: details are not to be turned
  const Points* delta = nullptr;        ///< differential coordinates of order 1
  const OperatorRows* first = nullptr;  ///< M of order 1
  const WoodburyCorrection* correction = nullptr;  ///< of the factor; may be nothing
  const BlendedRotations* blended = nullptr;       ///< in place of smooth_rest, for DetailRotation::LocalGlobal
  bool turns_edges = false;                        ///< then: or whole coordinates
};

/// Frames of a drag, in single precision, for order 1 and the rotations of the smoothed surface: the pose that
/// LaplacianEditor::solve() gives with one pass, to about 1e-5 of the region's size, in a fraction of its time.
///
/// What makes it fast. Where the handles go enters a frame by a few vectors only: the unrotated result is a sum of
/// responses u_k, scalars per vertex, times vectors w_k. So is the smoothed one; the covariances that rotations are
/// fitted to are C0 + sum w_k g_k^T, and with one response even the sums of face normals are a0 + b x w. All of u, g,
/// a0, b, also averaged over the four one-rings where that is linear, is worked out once. A frame then takes four
/// passes over the edges, closed formulas of sixteen vertices at a time, and one solve, all in the order of
/// elimination.
class DragPreview {
 public:
  /// At most so many responses: beyond, a plain solve is not much slower.
  static constexpr int kMostResponses = 12;

  /// @param responses         size() x responses: what the unrotated result moves for a unit motion
  /// @param smooth_responses  the same, smoothed
  /// Cost: O(edges), and about 400 bytes per vertex.
  DragPreview(const PreviewBase& base, const Eigen::MatrixXd& responses, const Eigen::MatrixXd& smooth_responses,
              SparseCholesky& factor, std::shared_ptr<ThreadPool> pool);
  ~DragPreview();

  /// Positions for motions w_k of the responses, one row per response; zero rows cost nothing.
  /// @param blended  whose cells' rotations details are turned by, if the preview was made with one
  /// @return size() x 3, in the region's order; valid until the next call. Not finite if a motion is beyond single
  ///         precision
  /// Nothing is allocated.
  const Points& pose(const Points& motions, const BlendedRotations* blended = nullptr);

  /// Unit vertex normals of the last pose, area-weighted over the region's faces; zero where there are none. Nothing is
  /// allocated after the first call.
  const Points& normals();

  std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
