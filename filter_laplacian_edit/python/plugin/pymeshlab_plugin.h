// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filters.h"
#include "vertex_filter_plugin.h"

/// The filters for PyMeshLab, which hands on numbers only: whole reports are had by laplacian_edit_report().
class PyMeshLabPlugin : public lapedit::host::VertexFilterPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID LAPEDIT_FILTER_IID)
  Q_INTERFACES(LAPEDIT_FILTER_INTERFACE)

 public:
  PyMeshLabPlugin();
};

extern "C" {

/// Returns the report of this thread's last edit as JSON text, an object with `mesh` and `steps`; empty before any.
/// Valid until this thread's next call.
Q_DECL_EXPORT const char* laplacian_edit_report();

/// Frees what this thread keeps of its last edit.
Q_DECL_EXPORT void laplacian_edit_forget();
}
