// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <functional>
#include <string>
#include <vector>

#include "lapedit/session/drag_session.h"
#include "lapedit_host/pose_writer.h"

/// A dragging session with the mesh of one layer, whose poses are written into it.
class LayerSession {
 public:
  struct Callbacks {
    std::function<CMeshO*()> mesh;  ///< the layer's mesh, null if it is gone
    std::function<void(const std::string&)> log;
    std::function<void()> wake;  ///< as DragSession's
  };

  /// @throws EditError if there is nothing to edit in the mesh
  LayerSession(const CMeshO& mesh, Callbacks callbacks);

  lapedit::DragSession& session() { return session_; }
  /// Whether vertices, faces and positions of the mesh are still as this session wrote them.
  bool matches(const CMeshO& mesh) const { return writer_.matches(mesh); }
  /// The tool is left. wasLeftLike() then tells whether the mesh is still the same, normals included, which a filter
  /// may have made anew.
  void leave(const CMeshO& mesh) { normalsLeft_ = hashOfNormals(mesh); }
  bool wasLeftLike(const CMeshO& mesh) const { return matches(mesh) && hashOfNormals(mesh) == normalsLeft_; }

  /// Whether poses were written since the last call. @param settled  whether the last of them is there to stay
  bool takeWritten(bool& settled);
  double writeMilliseconds() const { return writeMilliseconds_; }  ///< of the last pose
  /// Whether a pose could not be written since somebody else had changed the mesh.
  bool foundChanged() const { return foundChanged_; }

  QString inHistory;  ///< the edit that was put into the document's history last

 private:
  LayerSession(const CMeshO& mesh, const lapedit::host::BridgedMesh& bridged, Callbacks callbacks);
  static uint hashOfNormals(const CMeshO& mesh);
  void write(const std::vector<int>& vertices, const lapedit::Points& positions, bool settled);

  Callbacks callbacks_;
  bool written_ = false, settled_ = true, foundChanged_ = false;
  double writeMilliseconds_ = 0;
  uint normalsLeft_ = 0;
  lapedit::DragSession session_;
  lapedit::host::PoseWriter writer_;
};
