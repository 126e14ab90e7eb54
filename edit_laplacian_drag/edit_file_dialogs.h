// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <optional>
#include <string>

#include "lapedit/edit/edit.h"
#include "lapedit_host/tool/edit_tool.h"

/// Saving and loading edits in the window.

class QWidget;

/// Returns the default file of a layer's edit: <mesh>.laplacian.json in the folder of the mesh.
QString editFileFor(const lapedit::host::Layer& layer);

/// Asks for a file and writes the edit into it, as JSON or, if its name ends in .mlx, as a
/// filter script. @param suggested  the file that the dialog proposes
/// @return a line for the user, empty if no file was chosen
std::string saveEdit(QWidget* parent, const lapedit::Edit& edit, const QString& suggested);

/// Asks for a file and reads it. @return `std::nullopt` if no file was chosen
/// @throws EditError (BadScript)
std::optional<lapedit::Edit> loadEdit(QWidget* parent, const QString& suggested, const lapedit::TriangleMesh& mesh);
