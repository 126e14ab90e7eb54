// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <QAction>
#include <string>
#include <vector>

#include "base_support.h"
#include "filter_laplacian_edit.h"
#include "host_support.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit_host/mesh_edit.h"
#include "shapes.h"

namespace lapedit::host::filter_figures_test {
namespace {

constexpr char kTwoSteps[] = R"({"laplacian_edit": 1, "steps": [
    {"region": {"radius": 4}, "handles": [{"vertices": "60", "translation": [0, 0, 1]}]},
    {"region": {"radius": 2}, "handles": [{"vertices": "20", "translation": [0, 0, 0.5]}]}]})";

class Filters : public testing::Test {
 protected:
  Filters() { fill(host, shapes::grid(11, 11)); }
  EditedMesh edited(const char* steps = kTwoSteps) const {
    return edit_mesh(host, [steps](const BridgedMesh&) { return load_edit(steps); }, 1, {});
  }

  CMeshO host;
};

TEST_F(Filters, FiguresHaveTheNamesAndNumbersOfTheReports) {
  const std::vector<EditReport> reports = edited().pose.reports;
  ASSERT_EQ(reports.size(), 2u);
  const auto figures = figures_of(reports);
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
TEST_F(Filters, FiguresAreNumbersAndTruthValuesOnly) {
  for (const auto& [name, value] : write_edited(host, edited()).figures) {
    const std::string type = value.typeName();
    EXPECT_TRUE(type == "bool" || type == "int" || type == "double") << name << " is a " << type;
  }
}

TEST_F(Filters, FitDeclaresThatItReadsAnotherLayer) {
  const FilterLaplacianEdit plugin;
  for (QAction* const action : plugin.actions()) {
    const bool fits = action->text() == "Laplacian Fit";
    EXPECT_EQ(plugin.filterArity(action), fits ? FilterLaplacianEdit::FIXED : FilterLaplacianEdit::SINGLE_MESH);
  }
}

TEST_F(Filters, RefusalOfAPointOffTheSurfaceNamesTheTransformOfTheLayer) {
  host.Tr.SetIdentity();  // as MeshLab does
  constexpr char kAway[] = R"({"laplacian_edit": 1, "steps": [
      {"region": {"radius": 4}, "handles": [{"points": [[50, 5, 0]], "translation": [0, 0, 1]}]}]})";
  for (const bool has_transform : {false, true}) {
    if (has_transform) host.Tr.SetTranslate(45, 0, 0);
    const std::string refusal = support::expect_refusal(ErrorCause::BadParameter, [&] { edited(kAway); });
    support::expect_contains(refusal, "away from the nearest vertex");
    EXPECT_EQ(refusal.find("The layer has a transform") != std::string::npos, has_transform) << refusal;
    EXPECT_EQ(refusal.find("transform") != std::string::npos, has_transform) << refusal;
  }
}

}  // namespace
}  // namespace lapedit::host::filter_figures_test
