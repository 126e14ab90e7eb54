// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "batch_plugins.h"
#include "host/batch_script.h"

namespace lapedit::host {

/// Lays a script's values over the list of a filter's parameters; those that it does not mention keep theirs.
/// @throws EditError (BadScript) for unknown names, other types, what is no number, and numbers of no choice: the host
///         itself would stop at an assertion, or not see it
void layOver(const ScriptFilter& filter, MeshDocument& document, RichParameterList& list);

}  // namespace lapedit::host
