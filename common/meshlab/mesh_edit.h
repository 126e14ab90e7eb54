// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lapedit/edit/fit_step.h"
#include "lapedit_host/filter_action.h"
#include "lapedit_host/mesh_bridge.h"

/// Edits of a host mesh as filters make them, and their reports for users.
namespace lapedit::host {

/// Returns the coordinate system that a mesh file names, see space_in_header(); empty if the file cannot be read.
/// MeshLab does not keep it.
std::string space_of_file(const std::string& path);

/// Returns the layer with a label or a file name; for an empty name the only other layer.
/// @param except  the mesh of a layer to skip
/// @throws EditError (BadParameter) if there is no such layer, or several
const DocumentLayer& layer_named(const std::vector<DocumentLayer>& layers, const std::string& name,
                                 const CMeshO& except);

/// Returns the map from a layer's own coordinates to those of another, by their transforms. @throws EditError
/// (BadParameter) if the other transform has no inverse
Affine map_between(const CMeshO& from, const CMeshO& to);

/// Returns what to add to the refusal of a point off the surface: a sentence if the layer has a transform, since users
/// may give the point as they see it.
std::string transform_note(const CMeshO& layer);

/// Reads scans from layers, in the coordinates of a layer. The arguments must outlive the result.
ScanReader layer_reader(const std::vector<DocumentLayer>& layers, const CMeshO& into);

/// Makes the edit of a mesh that has passed validate().
using MakeEdit = std::function<Edit(const BridgedMesh&)>;

/// A host mesh as it was read, and the result of an edit.
struct EditedMesh {
  BridgedMesh bridged;
  Adjacency adjacency;  ///< of bridged.mesh
  EditResult pose;
};

/// Reads the mesh, applies the edit and counts new self-intersections in meshes of up to 20,000 moved vertices, which
/// takes up to a fifth of the time. Does not change the host mesh.
/// @param fraction  how far the handles go, 0 to 1
/// @throws EditError as read_mesh(), validate() and apply_edit(), and what `make` throws; OffSurface with
///         transform_note()
EditedMesh edit_mesh(const CMeshO& host, const MakeEdit& make, double fraction, const Progress& progress);

/// Writes the pose into the host mesh and reports it.
FilterOutcome write_edited(CMeshO& host, const EditedMesh& edited);

/// Returns figures for MeshLab versions that take them, by the names in the program's report: those of the last step
/// and, if there are several steps, those of each, as in "step_1_folded". Texts and unknown figures are omitted.
std::map<std::string, QVariant> figures_of(const std::vector<EditReport>& reports);

}  // namespace lapedit::host
