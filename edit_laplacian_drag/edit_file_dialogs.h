// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QString>
#include <optional>
#include <string>

#include "lapedit/edit/edit.h"

/// How an edit leaves the window, and comes back.

class QWidget;

/// Asks for a file and writes the edit into it as JSON. @return a line for the user, empty if no file was chosen
std::string saveEdit(QWidget* parent, const lapedit::Edit& edit);

/// Asks for a file and reads it. @return nothing if no file was chosen
/// @throws EditError (BadScript)
std::optional<lapedit::Edit> loadEdit(QWidget* parent);

/// Text of an .mlx script that replays an edit, given as JSON, with the filter Laplacian Edit Replay.
QString filterScript(const QByteArray& edit);
