// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "quality_scene.h"

/// The figures of a run as Markdown, to standard output, and as JSON.
namespace quality {

struct Row {
  std::string edit;
  EditClass kind;
  int vertices;             ///< of the region
  std::vector<Figures> of;  ///< one per method
};

void print_head();
void print_row(const Row& row, const std::vector<Method>& methods);

nlohmann::ordered_json as_json(const Row& row, const std::vector<Method>& methods);

}  // namespace quality
