// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QJsonArray>
#include <vector>

#include "lapedit/deform/edit_report.h"

/// All figures of an edit's steps, as the program's report and PyMeshLab's users get them.
QJsonArray jsonOfSteps(const std::vector<lapedit::EditReport>& reports);
