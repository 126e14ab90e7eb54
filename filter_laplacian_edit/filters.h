// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit_host/filter_action.h"

/// One handle, one region, typed numbers.
lapedit::host::FilterAction laplacianEdit();

/// An edit recorded as JSON, see lapedit_host/edit_script.h.
lapedit::host::FilterAction laplacianEditReplay();

/// What a user should know about the method, HTML.
QString aboutTheMethod();
