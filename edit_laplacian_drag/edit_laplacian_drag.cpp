// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_laplacian_drag.h"

#include "laplacian_drag_tool.h"

using namespace lapedit::host;

namespace {

/// Passes events of MeshLab's view to the tool. MeshLab never deletes a tool: it is a child of its view.
class ViewTool final : public LaplacianDragTool, public HostTool {
 public:
  void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { mousePress(*event); });
  }
  void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { mouseMove(*event); });
  }
  void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { mouseRelease(*event); });
  }
  void wheelEvent(QWheelEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { wheel(*event); });
  }
  void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { keyPress(*event); });
  }
  void keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { keyRelease(*event); });
  }

 private:
  bool start(GLArea* area, MLSceneGLSharedDataContext* shared) override {
    return LaplacianDragTool::start(area, shared);
  }
  void end() override { LaplacianDragTool::end(); }
  void changeLayer(GLArea* area, MLSceneGLSharedDataContext* shared) override {
    LaplacianDragTool::changeLayer(area, shared);
  }
  void draw() override { LaplacianDragTool::draw(); }
};

QAction* newAction() {
  const QString description =
      "bends the surface by dragging a handle; details keep their shape and rotate with it (Laplacian editing for "
      "MeshLab " LAPEDIT_VERSION ")";
  auto* const action = new QAction(QIcon(":/laplacian_drag/icon.png"), LaplacianDragTool::kTitle);
  action->setCheckable(true);
  action->setShortcut(QKeySequence("Ctrl+Alt+L"));
  action->setToolTip(action->text() + " (" + action->shortcut().toString(QKeySequence::NativeText) +
                     "): " + description);
  action->setWhatsThis(description);
  return action;
}

}  // namespace

EditLaplacianDrag::EditLaplacianDrag() : HostToolPlugin(newAction()) {}

HostTool* EditLaplacianDrag::newTool() {
  return new ViewTool;
}
