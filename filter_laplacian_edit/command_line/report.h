// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QString>
#include <QStringList>
#include <optional>
#include <vector>

#include "lapedit/deform/edit_report.h"
#include "options.h"

/// The steps that led to one output.
struct Pose {
  double fraction = 1;
  std::vector<lapedit::EditReport> steps;
  /// By how much coordinates in the file differ from the result, at most; null where that is not known.
  std::optional<double> lost = {};
};

struct JobReport {
  int vertices = 0, faces = 0;  ///< of the mesh that was read
  double readMs = 0, editMs = 0, writeMs = 0;
  std::vector<Pose> poses;
  QStringList notKept;  ///< what outputs lack of the mesh that was read: customProperties(), or "faces"
};

/// All figures as JSON text.
QByteArray reportText(const Options& options, const JobReport& report);
