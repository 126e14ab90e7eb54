// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/drag_preview.h"
#include "lapedit/deform/edit_constraints.h"

namespace lapedit {

/// Frames of a drag from the maps of the handle groups. The unrotated result is linear in what the handles do: for each
/// column of a group's motion about the origin, linear part first, it is a scalar u per vertex (the response) times the
/// column. A group of one vertex has but one response, its way. Made once, by a solution per three responses.
class HandleResponses {
 public:
  /// @param solver  of the system. @return nothing if there are more responses than a preview takes
  static std::unique_ptr<HandleResponses> make(const LaplacianSystem& system, RefinedSolver& solver);

  /// The pose for handle motions without targets of their vertices, see DragPreview::pose().
  const Points& pose(const std::vector<HandleMotion>& handles);
  const Points& normals() { return preview_->normals(); }
  std::size_t bytes() const { return preview_->bytes(); }

 private:
  struct Response {
    int group;
    int column;  // of the group's motion about the origin; 3: its translation
    int vertex;  // local, of a group that is one vertex; else -1
  };
  explicit HandleResponses(const LaplacianSystem& system)
      : system_(system), paths_(system.region, system.rest.local, system.rest.origin) {}
  void list();
  Eigen::MatrixXd unit_motions() const;
  Eigen::MatrixXd fallen_off() const;
  Eigen::MatrixXd solve_for(const Eigen::MatrixXd& moved, RefinedSolver& solver) const;

  const LaplacianSystem& system_;
  std::vector<Response> responses_;
  Points motions_;
  GroupPaths paths_;
  std::unique_ptr<DragPreview> preview_;
};

}  // namespace lapedit
