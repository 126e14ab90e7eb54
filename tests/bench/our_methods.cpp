// SPDX-License-Identifier: GPL-3.0-or-later
#include "our_methods.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "lapedit/base/stopwatch.h"
#include "lapedit/edit/step_solver.h"
#include "table.h"

namespace quality {

using lapedit::EditSettings;

namespace {

lapedit::Points whole_mesh(const Edit& edit, const lapedit::Region& region, const lapedit::Points& solved) {
  lapedit::Points result = edit.mesh.vertices;
  for (int i = 0; i < region.size(); ++i) {
    result.row(region.mesh_vertex[i]) = solved.row(i);
  }
  return result;
}

}  // namespace

EditSettings settings_of(const std::string& text) {
  EditSettings settings;
  for (const std::string& pair : split(text, ',')) {
    if (pair.empty()) {
      continue;
    }
    const auto& [key, value] = key_and_value(pair);
    const auto& table = lapedit::settings_table();
    const auto setting =
        std::find_if(table.begin(), table.end(), [&key = key](const auto& row) { return key == row.key; });
    if (setting == table.end()) {
      throw std::runtime_error("there is no setting " + key);
    }
    const auto& names = setting->choices;
    const auto choice = std::find(names.begin(), names.end(), value);
    char* end = nullptr;
    const double number =
        choice != names.end() ? static_cast<double>(choice - names.begin()) : std::strtod(value.c_str(), &end);
    if (value.empty() || (end && *end) || (choice == names.end() && !names.empty())) {
      throw std::runtime_error(std::string(value).append(" is no value of ").append(key));
    }
    setting->set(settings, number);
  }
  lapedit::validate(settings);
  return settings;
}

MethodResult ours(const Problem& scene, const EditSettings& settings, int threads) {
  constexpr int kFrames = 11;
  const Edit& edit = scene.edit;
  MethodResult result;
  lapedit::Stopwatch watch;
  lapedit::StepOptions options;
  options.solver.threads = threads;
  lapedit::StepSolver solver(edit.mesh,
                             lapedit::find_region(edit.mesh, scene.adjacency, edit.region, edit.handles, {}, threads),
                             settings, options);
  solver.prepare(edit.mesh);
  result.prepare_ms = watch.lap();
  const lapedit::Points& solved = solver.pose({edit.maps.begin(), edit.maps.end()});
  result.solve_ms = watch.lap();
  result.positions = whole_mesh(edit, solver.region(), solved);
  solver.make_cells();
  result.fast_frame = solver.has_frames();
  lapedit::Points frame;
  // A mouse that comes near the pose, small step by small step.
  std::vector<double> frames;
  for (int k = 0; k < kFrames; ++k) {
    std::vector<lapedit::HandleMotion> motions(edit.maps.begin(), edit.maps.end());
    for (lapedit::HandleMotion& motion : motions) {
      motion.map.translation() *= 1 - 0.002 * (kFrames - k);
    }
    watch.lap();
    if (result.fast_frame) {
      solver.frame(motions, frame);
    } else {
      solver.pose(motions);
    }
    frames.push_back(watch.lap());
  }
  result.frame_ms = table::median(frames);
  return result;
}

}  // namespace quality
