// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lapedit/deform/edit_settings.h"
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

/// Sums, means and medians over the edits for which every method has a result.
void print_summary(const std::vector<Row>& all, const std::vector<Method>& methods);

/// One method's figures compared with those of ARAP and ARAP100, for each class of edits and with the project's
/// targets; missed ones are bold.
void print_targets(const std::vector<Row>& all, const std::vector<Method>& methods, const std::string& whose);

/// Prints how steady this library's poses are; what misses its target is bold. README.md describes the options --jumps,
/// --renumbered and --frames.
void print_steadiness(const std::string& option, const std::vector<const NamedEdit*>& edits,
                      const lapedit::EditSettings& settings);

nlohmann::ordered_json as_json(const Row& row, const std::vector<Method>& methods);

}  // namespace quality
