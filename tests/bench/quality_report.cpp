// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_report.h"

#include "table.h"

namespace quality {
namespace {

using table::number;
using Value = double (*)(const Figures&);

struct Column {
  const char *head, *format;
  Value value;
};
constexpr Column kColumns[] = {{"RMS stretch %", "%.1f", [](const Figures& f) { return 100 * f.rms; }},
                               {"largest %", "%.0f", [](const Figures& f) { return 100 * f.largest; }},
                               {"dihedral, degrees", "%.1f", [](const Figures& f) { return f.dihedral; }},
                               {"by area %", "%.1f", [](const Figures& f) { return 100 * f.area_rms; }},
                               {"shear %", "%.1f", [](const Figures& f) { return 100 * f.shear; }},
                               {"worst 1 % of area, %", "%.0f", [](const Figures& f) { return 100 * f.worst; }},
                               {"tilt, degrees", "%.1f", [](const Figures& f) { return f.tilt; }},
                               {"far %", "%.2g", [](const Figures& f) { return 100 * f.far; }},
                               {"uneven twist %", "%.0f", [](const Figures& f) { return 100 * f.twist; }},
                               {"asymmetry %", "%.1f", [](const Figures& f) { return 100 * f.asymmetry; }},
                               {"flipped", "%.0f", [](const Figures& f) -> double { return f.flipped; }},
                               {"new pairs", "%.0f", [](const Figures& f) -> double { return f.pairs; }},
                               {"volume %", "%+.1f", [](const Figures& f) { return 100 * f.volume; }},
                               {"handle off %", "%.2g", [](const Figures& f) { return 100 * f.behind; }},
                               {"settled ms", "%.1f", [](const Figures& f) { return f.prepare_ms + f.solve_ms; }},
                               {"preparing", "%.1f", [](const Figures& f) { return f.prepare_ms; }},
                               {"solving", "%.1f", [](const Figures& f) { return f.solve_ms; }},
                               {"frame", "%.2f", [](const Figures& f) { return f.frame_ms; }}};

/// By the number of the class.
constexpr const char* kClasses[] = {"one vertex pulled",
                                    "group turned by at most 90",
                                    "group turned by more",
                                    "several groups, components",
                                    "elbows",
                                    "standing animals",
                                    "coarse meshes",
                                    "half fine meshes",
                                    "deep relief",
                                    "survey",
                                    "other"};

}  // namespace

void print_head() {
  table::Cells head = {"edit", "vertices", "method"};
  for (const Column& column : kColumns) {
    head.emplace_back(column.head);
  }
  table::print_head(head);
}

void print_row(const Row& row, const std::vector<Method>& methods) {
  for (std::size_t m = 0; m < methods.size(); ++m) {
    table::Cells cells = {m == 0 ? row.edit : "", m == 0 ? std::to_string(row.vertices) : "", methods[m].name};
    for (const Column& column : kColumns) {
      cells.push_back(row.of[m].failed.empty() ? number(column.value(row.of[m]), column.format) : "");
    }
    if (!row.of[m].failed.empty()) {
      cells[3] = row.of[m].failed;
    } else if (!row.of[m].fast_frame) {
      cells.back() += " (whole)";
    }
    table::print_row(cells);
  }
}

nlohmann::ordered_json as_json(const Row& row, const std::vector<Method>& methods) {
  nlohmann::ordered_json result = {{"vertices", row.vertices}, {"class", kClasses[static_cast<std::size_t>(row.kind)]}};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Figures& f = row.of[m];
    // A number that is not finite is written as null.
    result[methods[m].name] =
        f.failed.empty()
            ? nlohmann::ordered_json{{"rms", f.rms},           {"area_rms", f.area_rms},   {"shear", f.shear},
                                     {"worst", f.worst},       {"tilt", f.tilt},           {"far", f.far},
                                     {"twist", f.twist},       {"asymmetry", f.asymmetry}, {"largest", f.largest},
                                     {"flipped", f.flipped},   {"pairs", f.pairs},         {"dihedral", f.dihedral},
                                     {"volume", f.volume},     {"behind", f.behind},       {"prepare_ms", f.prepare_ms},
                                     {"solve_ms", f.solve_ms}, {"frame_ms", f.frame_ms},   {"fast_frame", f.fast_frame}}
            : nlohmann::ordered_json{{"failed", f.failed}};
  }
  return result;
}

}  // namespace quality
