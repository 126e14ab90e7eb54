// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_laplacian_drag.h"

#include "laplacian_drag_tool.h"

EditLaplacianDrag::EditLaplacianDrag()
    : EditToolPlugin(
          {LaplacianDragTool::kTitle,
           "bends the surface by dragging a handle; details keep their shape and rotate with it (Laplacian editing for "
           "MeshLab " LAPEDIT_VERSION ")",
           ":/laplacian_drag/icon.png", QKeySequence("Ctrl+Alt+L"),
           [](lapedit::host::HostWindow& window) { return std::make_unique<LaplacianDragTool>(window); }}) {}
