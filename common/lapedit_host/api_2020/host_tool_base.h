// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// GLEW has to precede all headers that include GL/gl.h.
#include <GL/glew.h>

#include <common/interfaces.h>

#include <string>

#include "lapedit_host/tool/tool_events.h"

/// The functions of a tool whose declarations in MeshLab 2020.09 differ from later versions.
namespace lapedit::host {

/// Ignores the layer that MeshLab passes by reference even if there is none; the view returns the current layer.
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
