// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <string>
#include <vector>

#include "host_parameters.h"
#include "lapedit_host/filter_action.h"

class FilterScript;

/// Shared by the adapters of all MeshLab versions (vertex_filter_plugin.h).
namespace lapedit::host {

/// Returns MeshLab's list of a filter's parameters. @param mesh  the current layer's, null if there is none
/// @param layers  of the document: MeshLab's window lists them for a Parameter::Kind::Layer
RichParameterList parameter_list(const FilterAction& filter, const CMeshO* mesh,
                                 const std::vector<DocumentLayer>& layers);

/// Returns whether a layer was chosen from a list.
bool has_chosen_layer(const FilterAction& filter, const RichParameterList& given);

/// Replaces layers chosen from a list by their names in the last entry of the history, if it is of the filter, since
/// scripts have names.
void name_layers(const FilterAction& filter, FilterScript& history);

/// Runs a filter. The mesh is not changed if this throws.
/// @param mesh      the current layer's, null if there is none
/// @param layers    of the document
/// @param callback  MeshLab's progress callback, may be null
/// @throws EditError  also for values of the wrong type, for which MeshLab would stop at an assertion
FilterOutcome run_filter(const FilterAction& filter, const RichParameterList& parameters, CMeshO* mesh,
                         std::vector<DocumentLayer> layers, bool (*callback)(int, const char*));

/// Returns the message for the user of the exception that is being handled.
QString sentence_of_current_exception();

}  // namespace lapedit::host
