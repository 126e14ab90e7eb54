// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QIcon>
#include <QPalette>

/// Returns the icon of a button or choice of the panel, by <part> of its name, in the palette's colours; empty if
/// there is none.
QIcon panelIcon(const QString& part, const QPalette& palette);
