// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <vector>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/drag_session.h"
#include "lapedit_host/pose_writer.h"

class LaplacianDragTool;

/// A dragging session with the mesh of one layer; writes poses into the mesh.
class LayerSession {
 public:
  /// @throws EditError if there is nothing to edit in the mesh
  LayerSession(const CMeshO& mesh, const lapedit::DragSession::Callbacks& callbacks);

  lapedit::DragSession& session() { return session_; }
  /// Returns whether vertices, faces and positions of the mesh are still as this session wrote them. Normals, colours,
  /// flags and transforms are not compared, since an edit does not depend on them.
  bool matches(const CMeshO& mesh) const { return writer_.matches(mesh); }
  /// As matches(), for some vertices only: O(1).
  bool seemsToMatch(const CMeshO& mesh) const { return writer_.seems_to_match(mesh); }

  /// Continues in a mesh that matches, but may have other normals than before.
  void resume(const CMeshO& mesh) { writer_.keep_normals(mesh); }

  enum class Update {
    Nothing,     ///< no vertex has moved
    Passing,     ///< a pose in progress was written
    Settled,     ///< an applied or undone step was written
    MeshChanged  ///< other code changed the mesh; nothing was written
  };
  /// Writes the vertices that have moved since the last call into the layer's mesh.
  Update update(CMeshO& mesh);

  /// Returns the vertices that are selected in MeshLab, or are corners of selected faces.
  std::vector<int> selected(const CMeshO& mesh) const {
    return lapedit::united(lapedit::host::selected_vertices(mesh, coreVertex_),
                           lapedit::host::vertices_of_selected_faces(mesh, coreVertex_));
  }

  QString inHistory;                    ///< the last edit in the document's history
  int historyPosition = -1;             ///< where it was in the history; -1: it is appended
  LaplacianDragTool* leftBy = nullptr;  ///< who left the session with a released drag to be solved; null: none

 private:
  LayerSession(const CMeshO& mesh, const lapedit::host::BridgedMesh& bridged,
               const lapedit::DragSession::Callbacks& callbacks);

  std::vector<int> coreVertex_;  // by numbers of MeshLab's mesh
  lapedit::DragSession session_;
  lapedit::host::PoseWriter writer_;
};
