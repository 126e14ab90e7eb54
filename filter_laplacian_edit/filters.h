// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit_host/mesh_edit.h"

/// Returns the filter that moves one handle of one region, by numbers.
lapedit::host::FilterAction laplacianEdit();

/// Returns the filter that replays an edit in JSON, see lapedit/json/edit_script.h.
lapedit::host::FilterAction laplacianEditReplay();

/// Returns the filter that fits a template to a scan in another layer.
lapedit::host::FilterAction laplacianFit();

/// Returns a description of the method for users, HTML.
QString aboutTheMethod();
