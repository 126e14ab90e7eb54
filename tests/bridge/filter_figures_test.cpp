// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "filters.h"
#include "host_support.h"
#include "shapes.h"

namespace lapedit::host {
namespace {

constexpr char kTwoSteps[] = R"({"laplacian_edit": 1, "steps": [
    {"region": {"radius": 4}, "handles": [{"vertices": "60", "translation": [0, 0, 1]}]},
    {"region": {"radius": 2}, "handles": [{"vertices": "20", "translation": [0, 0, 0.5]}]}]})";

/// What a host gets of an edit, and the reports that it was made of.
FilterOutcome replayed(std::vector<EditReport>& reports) {
  CMeshO host;
  fill(host, shapes::grid(11, 11));
  const FilterAction filter = laplacianEditReplay([&](const std::vector<EditReport>& made) { reports = made; });
  ParameterValues values;
  values.set("edit", QString(kTwoSteps));
  values.set("fraction", 1.0);
  return filter.run(values, host, {});
}

TEST(FilterFigures, HaveTheNamesAndNumbersOfTheReports) {
  std::vector<EditReport> reports;
  const auto figures = replayed(reports).figures;
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_EQ(figures.at("steps").toInt(), 2);
  EXPECT_EQ(figures.at("step_1_free").toInt(), reports[0].free);
  EXPECT_EQ(figures.at("free").toInt(), reports[1].free);
  EXPECT_NE(reports[0].free, reports[1].free);
  EXPECT_EQ(figures.at("step_2_stretch_rms").toDouble(), reports[1].stretch_rms);
  EXPECT_EQ(figures.at("handle_residual").toDouble(), reports[1].handle_residual);
  EXPECT_EQ(figures.at("milliseconds_solve").toDouble(), reports[1].solve_ms);
  EXPECT_EQ(figures.count("new_intersections"), 1u);
}

/// PyMeshLab prints a warning for all else.
TEST(FilterFigures, AreNumbersAndTruthValuesOnly) {
  std::vector<EditReport> reports;
  for (const auto& [name, value] : replayed(reports).figures) {
    const std::string type = value.typeName();
    EXPECT_TRUE(type == "bool" || type == "int" || type == "double") << name << " is a " << type;
  }
}

}  // namespace
}  // namespace lapedit::host
