// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAction>

#include "host_tool_base.h"
#include "lapedit_host/tool/edit_tool.h"

/// Shared by the adapters of all MeshLab versions (edit_tool_plugin.h).
namespace lapedit::host {

/// Creates a tool for one view. Catches all exceptions of the tool, which would end the application. @return owned by
/// its view once it is started there
HostToolBase* makeHostTool(const EditToolAction& description);

/// Creates the entry of menu and toolbar.
QAction* makeAction(const EditToolAction& description, QObject* parent);

}  // namespace lapedit::host
