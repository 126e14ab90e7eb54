// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <optional>
#include <vector>

#include "options.h"

/// A line of a list, stored compactly since lists may be long.
struct ListedJob {
  int line = 0;
  QByteArray input, output, edit;  ///< absolute paths, in the file system's bytes
  QByteArray report;               ///< empty: none
  std::optional<double> fraction;  ///< overrides the common fraction
};

/// Reads a list and checks all of it. A line has the names IN, OUT and EDIT with tabs between, or is a JSON object with
/// the keys in, out, edit and, where wanted, fraction and report. Empty lines and those that begin with # are skipped.
/// No output may be that of another job, or an input of any job, so jobs can run in any order, and again. @param common
/// options of all jobs, and the list's name @throws Failure (Unreadable, WrongUsage) with the line's number
std::vector<ListedJob> readJobList(const Options& common);

/// Returns the options of one job of a list; it prints no reports.
Options optionsOf(const ListedJob& job, const Options& common);
