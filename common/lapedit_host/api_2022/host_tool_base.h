// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// GLEW has to precede all headers that include GL/gl.h.
#include <GL/glew.h>

#include <common/plugins/interfaces/edit_plugin.h>

#include <string>

#include "lapedit_host/tool/tool_events.h"

/// The functions of a tool whose declarations in MeshLab since 2021 differ from earlier versions.
namespace lapedit::host {

/// Ignores the layer that MeshLab passes by reference even if there is none; the view returns the current layer.
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
