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

/// The handles at a fraction from 0 to 1 of their path. @param rest  the mesh before the step
std::vector<HandleGroup> path_fraction(const StepPath& path, const TriangleMesh& rest);
/// The path of a step that is applied as it is.
StepPath path_of(const EditStep& step);

/// A mesh and the steps that made it what it is. Undo puts back what was there, so it is exact to the bit.
///
/// A mesh is never changed while another thread may be reading it. A change takes a mesh that nobody reads any more and
/// brings it up to date, O(changes); it copies the mesh only if there is none. References that are handed out last
/// until the next change.
class History {
 public:
  explicit History(TriangleMesh original);

  const TriangleMesh& original() const { return *original_; }
  const std::shared_ptr<const TriangleMesh>& mesh() const { return mesh_; }
  /// The mesh as the last step found it. There has to be one.
  std::shared_ptr<const TriangleMesh> before_last() const;
  const std::vector<AppliedStep>& steps() const { return steps_; }  ///< applied, the oldest first
  bool can_undo() const { return !steps_.empty(); }
  bool can_redo() const { return !undone_.empty(); }
  /// The steps with counts and connectivity of the mesh: applied to original() by apply_edit() they give mesh().
  Edit recorded() const;

  /// Puts vertices to their positions after a step; what was undone is gone. @param after  one row per vertex
  /// @param path  none: the step takes all of it
  const AppliedStep& apply(EditStep step, std::vector<int> vertices, Points after, std::optional<StepPath> path = {});
  /// As if this step had been applied in place of the last one.
  const AppliedStep& amend(EditStep step, std::vector<int> vertices, Points after, StepPath path);
  /// Takes the last step back. There has to be one. @return the step
  const AppliedStep& undo();
  /// Applies the step again that was taken back last. There has to be one. @return the step
  const AppliedStep& redo();
  /// Changes the faces of mesh() and of the meshes that follow it.
  void set_faces(Faces faces);

 private:
  struct Spares;
  std::shared_ptr<TriangleMesh> current(std::vector<int> to_change) const;
  void put(const std::vector<int>& vertices, const Points& positions);

  std::shared_ptr<const TriangleMesh> original_, mesh_;
  std::shared_ptr<Spares> spares_;
  std::vector<AppliedStep> steps_, undone_;
  mutable std::string checksum_;  // of the connectivity, once it was asked for
};

}  // namespace lapedit
