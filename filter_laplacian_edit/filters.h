// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit_host/mesh_edit.h"

/// One handle, one region, typed numbers.
lapedit::host::FilterAction laplacianEdit();

/// An edit recorded as JSON, see lapedit/json/edit_script.h.
lapedit::host::FilterAction laplacianEditReplay();

/// A template is fitted to a scan in another layer.
lapedit::host::FilterAction laplacianFit();

/// Returns a description of the method for users, HTML.
QString aboutTheMethod();
