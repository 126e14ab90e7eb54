// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filters.h"
#include "vertex_filter_plugin.h"

class FilterLaplacianEdit : public lapedit::host::VertexFilterPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID LAPEDIT_FILTER_IID)
  Q_INTERFACES(LAPEDIT_FILTER_INTERFACE)

 public:
  FilterLaplacianEdit();
};
