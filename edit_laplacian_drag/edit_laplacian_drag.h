// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "edit_tool_plugin.h"

class EditLaplacianDrag : public lapedit::host::HostToolPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID LAPEDIT_EDIT_IID)
  Q_INTERFACES(LAPEDIT_EDIT_INTERFACE)

 public:
  EditLaplacianDrag();

 private:
  lapedit::host::HostInterface* newTool() override;
};
