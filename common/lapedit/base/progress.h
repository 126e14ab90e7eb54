// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace lapedit {

/// Called now and then during long work with the fraction done (0..1) and the stage's name; false asks to stop,
/// which raises EditError(Cancelled). May be empty.
using Progress = std::function<bool(double fraction, const char* stage)>;

/// Calls the progress function, if any. @throws EditError (Cancelled) when it answers "stop"
void report_progress(const Progress& progress, double fraction, const char* stage);

}  // namespace lapedit
