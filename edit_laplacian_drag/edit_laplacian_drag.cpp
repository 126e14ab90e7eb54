// SPDX-License-Identifier: GPL-3.0-or-later
// Includes GLEW, which has to precede all headers that include GL/gl.h.
#include "edit_tool_plugin.h"

#include "laplacian_drag_tool.h"

using namespace lapedit::host;

namespace {

/// Passes events of MeshLab's view to the tool. MeshLab never deletes a tool: it is a child of its view.
class ViewTool final : public HostTool<LaplacianDragTool> {
 public:
  void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea*) override { input(*event); }
  void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea*) override { input(*event); }
  void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea*) override { input(*event); }
  void wheelEvent(QWheelEvent* event, MeshModel&, GLArea*) override { input(*event); }
  void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea*) override { input(*event); }
  void keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea*) override { input(*event); }
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

class EditLaplacianDrag : public HostToolPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID LAPEDIT_EDIT_IID)
  Q_INTERFACES(LAPEDIT_EDIT_INTERFACE)

 public:
  EditLaplacianDrag() : HostToolPlugin(newAction()) {}

 private:
  HostInterface* newTool() override { return new ViewTool; }
};

#include "edit_laplacian_drag.moc"
