// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lapedit_host/filter_action.h"
#include "lapedit_host/mesh_bridge.h"

/// Edits of a host mesh as filters and the batch program make them, and their reports for users.
namespace lapedit::host {

/// Receives the reports of an edit, one per step. May be empty.
using ReportSink = std::function<void(const std::vector<EditReport>&)>;

/// Makes the edit of a mesh that has passed validate().
using MakeEdit = std::function<Edit(const BridgedMesh&)>;

/// A host mesh as it was read, and the results of an edit.
struct EditedMesh {
  BridgedMesh bridged;
  Adjacency adjacency;            ///< of bridged.mesh
  std::vector<EditResult> poses;  ///< one per fraction
};

/// Reads the mesh, applies the edit and counts new self-intersections. Does not change the host mesh.
/// @param fractions      how far the handles go, 0 to 1 each
/// @param most_vertices  new self-intersections are counted in meshes of at most this size
/// @throws EditError as read_mesh(), validate() and apply_edit(), and what `make` throws
EditedMesh edit_mesh(const CMeshO& host, const MakeEdit& make, const std::vector<double>& fractions, int most_vertices,
                     const Progress& progress);

/// Writes the only pose into the host mesh and reports it.
FilterOutcome write_edited(CMeshO& host, const EditedMesh& edited, const ReportSink& sink);

/// The reports of an edit's steps as text for a log.
std::string text_of(const std::vector<EditReport>& reports);

/// Figures for MeshLab versions that take them, by the names in the program's report: those of the last step and, if
/// there are several steps, those of each, as in "step_1_folded". Texts and unknown figures are omitted.
std::map<std::string, QVariant> figures_of(const std::vector<EditReport>& reports);

}  // namespace lapedit::host
