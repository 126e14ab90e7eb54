// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Before anything that includes GL/gl.h.
#include <GL/glew.h>

#include <common/plugins/interfaces/edit_plugin.h>

#include <string>

#include "lapedit_host/tool/tool_events.h"

/// The functions of a tool that MeshLab since 2021 declares differently.
namespace lapedit::host {

/// MeshLab passes the current layer by reference even if there is none: the view returns it instead.
class HostToolBase : public ::EditTool, protected ToolEvents {
 public:
  using ::EditTool::decorate;
  using ::EditTool::endEdit;
  using ::EditTool::startEdit;

  bool startEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext* shared) final { return start(area, shared); }
  void endEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext*) final { end(area); }
  void layerChanged(MeshDocument&, MeshModel&, GLArea* area, MLSceneGLSharedDataContext* shared) final {
    changeLayer(area, shared);
  }
  void decorate(MeshModel&, GLArea* area, QPainter*) final { draw(area); }
};

inline void write_log(MeshDocument& document, const std::string& line) {
  document.Log.log(GLLogStream::FILTER, line);
}
inline FilterScript* history_of(MeshDocument& document) {
  return &document.filterHistory;
}

}  // namespace lapedit::host
