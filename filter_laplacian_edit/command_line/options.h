// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <optional>
#include <string>
#include <vector>

#include "batch_host.h"

struct Options {
  QString input, output, edit;  ///< absolute paths
  bool isScript = false;        ///< the edit is a filter script, not JSON
  std::vector<double> fractions = {1};
  bool numbered = false;  ///< one output per fraction, its number in the name
  QString report;         ///< path, empty: none
  QString plugins;        ///< folder, empty: the host's own
  lapedit::host::KeptAttributes kept;
  bool quiet = false;
  bool quality = false;  ///< counts new self-intersections
  double timeout = 0;    ///< seconds, 0: none

  QStringList outputs() const;  ///< one path per fraction
};

/// @return the options, or nothing where a text for the user was asked for
/// @throws Failure (WrongUsage)
std::optional<Options> readOptions(const QStringList& arguments, std::string& text);
