// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace lapedit {

/// Called repeatedly during long work with the fraction done, 0 to 1, and the name of the stage. If it returns false,
/// the work stops with EditError (Cancelled). May be empty.
using Progress = std::function<bool(double fraction, const char* stage)>;

/// Calls the progress function, if any. @throws EditError (Cancelled) if it returns false
void report_progress(const Progress& progress, double fraction, const char* stage);

}  // namespace lapedit
