// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "batch_plugins.h"
#include "host/batch_script.h"

namespace lapedit::host {

/// Sets a script's values in the list of a filter's parameters; the others keep their values.
/// @throws EditError (BadScript) for unknown names, other types, invalid numbers and numbers of no choice, for which
/// MeshLab would stop at an assertion, or not notice
void layOver(const ScriptFilter& filter, MeshDocument& document, RichParameterList& list);

}  // namespace lapedit::host
