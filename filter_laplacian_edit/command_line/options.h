// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <optional>
#include <string>
#include <vector>

#include "host/batch_host.h"
#include "lapedit/base/types.h"

/// Many jobs in one call.
struct ListOptions {
  QString file;  ///< one job per line, see job_list.h; empty: a single job
  int jobs = 0;  ///< number of concurrent jobs, or of processes that write poses; 0: not given
  QString log;   ///< path of the job log, empty: none
  bool resume = false;
};

/// A job; with a list, the options of all its jobs.
struct Options {
  QString input, output, edit;  ///< absolute paths
  QString targets;              ///< landmarks: edit is the file of the points, this that of their targets; or empty
  bool fromStream = false;      ///< the mesh is read from the standard input, as PLY
  bool toStream = false;        ///< the mesh is written to the standard output, as PLY
  std::vector<lapedit::Vector3> nearest;  ///< only the vertices nearest to these are asked for
  bool info = false;                      ///< only what the mesh is is asked for
  bool isScript = false;                  ///< the edit is a filter script, not JSON
  std::vector<double> fractions = {1};
  bool numbered = false;  ///< one output per fraction, its number in the name
  QString report;         ///< path, empty: none
  QString plugins;        ///< folder, empty: MeshLab's own
  lapedit::host::KeptAttributes kept;
  bool quiet = false;
  bool strict = false;   ///< advice on a result is an error
  bool quality = false;  ///< counts new self-intersections
  ListOptions list;
  double timeout = 0;  ///< seconds, 0: none

  QStringList outputs() const;  ///< one path per fraction
};

/// Returns whether an edit is a filter script, by the suffix, otherwise by the beginning of the text.
bool isScript(const QString& path);

/// @return the options, or `std::nullopt` if only a text for the user was requested
/// @throws Failure (WrongUsage)
std::optional<Options> readOptions(QStringList arguments, std::string& text);
