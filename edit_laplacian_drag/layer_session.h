// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

#include "lapedit/session/drag_session.h"
#include "lapedit_host/pose_writer.h"

/// A dragging session with the mesh of one layer, whose poses are written into it.
class LayerSession {
 public:
  /// @throws EditError if there is nothing to edit in the mesh
  LayerSession(const CMeshO& mesh, const lapedit::DragSession::Callbacks& callbacks);

  lapedit::DragSession& session() { return session_; }
  /// Whether vertices, faces and positions of the mesh are still as this session wrote them.
  bool matches(const CMeshO& mesh) const { return writer_.matches(mesh); }
  /// To be called when the tool is left. wasLeftLike() then returns whether the mesh is still the same, normals
  /// included, which a filter may have recomputed.
  void leave(const CMeshO& mesh) { normalsLeft_ = hashOfNormals(mesh); }
  bool wasLeftLike(const CMeshO& mesh) const { return matches(mesh) && hashOfNormals(mesh) == normalsLeft_; }

  enum class Update {
    Nothing,     ///< no vertex has moved
    Passing,     ///< a pose in progress was written
    Settled,     ///< what was applied or taken back was written
    MeshChanged  ///< the mesh was changed elsewhere; it was left as it is
  };
  /// Writes what the session has moved since the last call into the layer's mesh.
  Update update(CMeshO& mesh);
  double writeMilliseconds() const { return writeMilliseconds_; }  ///< of the last pose

  QString inHistory;  ///< the edit that was put into the document's history last

 private:
  LayerSession(const CMeshO& mesh, const lapedit::host::BridgedMesh& bridged,
               const lapedit::DragSession::Callbacks& callbacks);
  static uint hashOfNormals(const CMeshO& mesh);

  double writeMilliseconds_ = 0;
  uint normalsLeft_ = 0;
  lapedit::DragSession session_;
  lapedit::host::PoseWriter writer_;
};
