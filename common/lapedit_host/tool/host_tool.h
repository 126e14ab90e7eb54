// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAction>

#include "host_tool_base.h"
#include "lapedit_host/tool/edit_tool.h"

/// What the adapters of all hosts need to present a tool (edit_tool_plugin.h of each).
namespace lapedit::host {

/// A tool for one view, as the host calls it. Catches everything that the tool throws: an exception would end the
/// application. @return owned by its view, once it is started there
HostToolBase* makeHostTool(const EditToolAction& description);

/// The entry of menu and toolbar.
QAction* makeAction(const EditToolAction& description, QObject* parent);

}  // namespace lapedit::host
