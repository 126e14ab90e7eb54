// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <string>

#include "lapedit/edit/edit.h"
#include "lapedit_host/tool/host_view.h"

/// Saving and loading edits in the window.

class QFileDialog;
class QWidget;

/// Returns the default file of a layer's edit: <mesh>.laplacian.json in the folder of the mesh.
QString editFileFor(const lapedit::host::Layer& layer);

/// Opens a dialog that asks for a file, and returns at once: QFileDialog::fileSelected() has the answer. The dialog
/// deletes itself.
/// @param suggested  the file that the dialog proposes, to load only if it exists
QFileDialog* saveDialog(QWidget* parent, const QString& suggested);
QFileDialog* loadDialog(QWidget* parent, const QString& suggested);

/// Writes an edit as JSON or, if the file's name ends in .mlx, as a filter script. @return a line for the user
std::string saveEdit(const QString& path, const lapedit::Edit& edit);
