// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

class GLArea;
class MLSceneGLSharedDataContext;

namespace lapedit::host {

/// Events of a tool of MeshLab's window, under names that no version of MeshLab has.
class ToolEvents {
 public:
  ToolEvents() = default;
  virtual ~ToolEvents() = default;
  ToolEvents(const ToolEvents&) = delete;
  ToolEvents& operator=(const ToolEvents&) = delete;

 protected:
  virtual bool start(GLArea* area, MLSceneGLSharedDataContext* shared) = 0;
  virtual void end(GLArea* area) = 0;
  virtual void changeLayer(GLArea* area, MLSceneGLSharedDataContext* shared) = 0;
  virtual void draw(GLArea* area) = 0;
};

}  // namespace lapedit::host
