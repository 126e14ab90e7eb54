// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/edit/edit.h"

/// Edits as JSON text, so that interactive and scripted edits can be replayed exactly.
///
/// The page docs/json-format.md lists the keys. Settings are read and written by settings_table().
///
/// Example: the steps of a file on a mesh, half of the path.
///
///     const Edit edit = load_edit("bend.json");
///     const EditResult half = apply_edit(mesh, edit, 0.5);
///
namespace lapedit {

/// Reads UTF-8 text, with or without a byte order mark. Checks keys, types, finite numbers and vertex lists (which may
/// not be longer than the mesh). apply_edit() checks the ranges of settings.
/// @param folder  folder of relative names of landmark files; empty: the current folder
/// @param mesh    the mesh that will be edited, so that lists beyond it take no memory; null: unknown
/// @param files   gets the paths of the landmark files and scans that the text names; may be null
/// @throws EditError (BadScript) whose message says where ("steps[1].handles[0]", or line and column); (MeshMismatch)
///         if the text names another number of vertices than the mesh has
Edit read_edit(const std::string& json, const std::string& folder = {}, const TriangleMesh* mesh = nullptr,
               std::vector<std::string>* files = nullptr);

/// Reads JSON text (UTF-8) if the argument begins with "{" (after white space), else the file of that path.
/// @throws EditError as read_edit()
Edit load_edit(const std::string& text_or_path, const TriangleMesh* mesh = nullptr);

/// Writes keys in the order of that page, all settings of the method explicitly (a later change of defaults does not
/// change an old file) and numbers such that read_edit() gives the same doubles (only a zero's sign is lost). Vertices
/// keep their order. A group with targets is written without a transform, and a transform with a matrix without its
/// other members.
/// @throws EditError (NotFinite, BadScript) if read_edit() could not read the result
std::string write_edit(Edit edit);

}  // namespace lapedit
