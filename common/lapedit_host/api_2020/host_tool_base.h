// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Before anything that includes GL/gl.h.
#include <GL/glew.h>

#include <common/interfaces.h>

#include <string>

#include "lapedit_host/tool/tool_events.h"

/// The functions of a tool that MeshLab 2020.09 declares differently.
namespace lapedit::host {

/// MeshLab passes the current layer by reference even if there is none: the view returns it instead.
class HostToolBase : public MeshEditInterface, protected ToolEvents {
 public:
  bool StartEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext* shared) final { return start(area, shared); }
  void EndEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext*) final { end(area); }
  void LayerChanged(MeshDocument&, MeshModel&, GLArea* area, MLSceneGLSharedDataContext* shared) final {
    changeLayer(area, shared);
  }
  void Decorate(MeshModel&, GLArea* area, QPainter*) final { draw(area); }
};

inline void write_log(MeshDocument& document, const std::string& line) {
  document.Log.Log(GLLogStream::FILTER, line);
}
inline FilterScript* history_of(MeshDocument& document) {
  return document.filterHistory;
}

}  // namespace lapedit::host
