// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <optional>
#include <vector>

#include "options.h"

/// A line of a list. Lists may be long: this is what is kept of each.
struct ListedJob {
  int line = 0;
  QByteArray input, output, edit;  ///< absolute paths, as the file system has them
  QByteArray report;               ///< empty: none
  std::optional<double> fraction;  ///< instead of what holds for all
};

/// Reads a list and checks all of it. A line has the names IN, OUT and EDIT with tabs between, or is a JSON object with
/// the keys in, out, edit and, where wanted, fraction and report. Empty lines and those that begin with # are left out.
/// No output may be that of another job, or what any job reads: so jobs can be done in any order, and again.
/// @param common  what holds for all; also the list's name
/// @throws Failure (Unreadable, WrongUsage), which tells the line
std::vector<ListedJob> readJobList(const Options& common);

/// The options of one job of a list; it prints no reports.
Options optionsOf(const ListedJob& job, const Options& common);
