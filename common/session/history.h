// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"

namespace lapedit {

/// The whole path of the handles of a step, where the step takes a fraction of it.
struct StepPath {
  std::vector<HandleGroup> whole;
  std::vector<int> moved;  ///< those that the user moved, ascending
  double fraction = 1;
};

/// A step with its changes.
struct AppliedStep {
  EditStep step;
  std::vector<int> vertices;  ///< mesh vertex numbers
  Points before, after;       ///< one row per entry of vertices
  StepPath path;
};

/// Returns the handles at a fraction from 0 to 1 of their path. @param rest  the mesh before the step
std::vector<HandleGroup> path_fraction(const StepPath& path, const TriangleMesh& rest);
/// Returns the path of a step that takes all of it.
StepPath path_of(const EditStep& step);

/// A mesh and the steps applied to it. Undo restores stored positions, so it is exact to the bit.
///
/// A mesh is never changed while another thread may be reading it: a step copies the positions into a mesh that no
/// thread reads any more, and the whole mesh only if there is none. References that are handed out last until the next
/// change.
class History {
 public:
  explicit History(TriangleMesh original);

  const TriangleMesh& original() const { return *original_; }
  const std::shared_ptr<const TriangleMesh>& mesh() const { return mesh_; }
  /// Returns the mesh before the last step. There has to be one.
  std::shared_ptr<const TriangleMesh> before_last() const;
  const std::vector<AppliedStep>& steps() const { return steps_; }  ///< applied, the oldest first
  bool can_undo() const { return !steps_.empty(); }
  bool can_redo() const { return !undone_.empty(); }
  /// Returns the steps with counts and connectivity of the mesh: applied to original() by apply_edit() they give
  /// mesh().
  Edit recorded() const;

  /// Applies a step that was solved, and deletes undone steps. @param after  one row per vertex
  /// @param path  none: the step takes all of it
  const AppliedStep& apply(EditStep step, std::vector<int> vertices, Points after, std::optional<StepPath> path = {});
  /// Undoes the last step. There has to be one. @return the step
  const AppliedStep& undo();
  /// Redoes the step that was undone last. There has to be one. @return the step
  const AppliedStep& redo();
  /// Changes the faces of mesh() and of the meshes that follow it.
  void set_faces(Faces faces);

 private:
  struct Spares;
  /// Returns a copy of mesh() with other positions of some vertices.
  std::shared_ptr<const TriangleMesh> with(const std::vector<int>& vertices, const Points& positions) const;

  std::shared_ptr<const TriangleMesh> original_, mesh_;
  std::shared_ptr<Spares> spares_;
  std::vector<AppliedStep> steps_, undone_;
  mutable std::string checksum_;  // of the connectivity; empty until recorded() needs it
};

}  // namespace lapedit
