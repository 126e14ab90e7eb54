// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/edit_report.h"
#include "lapedit/json/json_text.h"

namespace lapedit {

/// Returns a list with an object for each step: the figures of report_table() and `landmarks`.
Json report_json(const std::vector<EditReport>& steps);

}  // namespace lapedit
