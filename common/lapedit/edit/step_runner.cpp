// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_runner.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/stopwatch.h"

namespace lapedit {

void round_to(StoredScalar scalar, Points& positions) {
  if (scalar == StoredScalar::Double) {
    return;
  }
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    positions.data()[i] = static_cast<double>(static_cast<float>(positions.data()[i]));
  }
  if (!positions.allFinite()) {
    throw EditError(ErrorCause::NotFinite,
                    "The result does not fit into the mesh's single precision, since the handle's displacement is too "
                    "large: move it less.");
  }
}

FoundRegion find_region(const StepProblem& problem, const Progress& progress) {
  validate(problem.settings);
  std::vector<std::vector<int>> groups = problem.groups;
  std::vector<std::vector<double>> weights = problem.weights;
  weights.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    sort_group(groups[g], weights[g]);
  }
  report_progress(progress, 0, "region");
  const Stopwatch watch;
  FoundRegion found;
  found.region = std::make_shared<const Region>(
      build_region(problem.mesh, problem.adjacency, problem.region, groups, problem.settings.threads, weights));
  found.milliseconds = watch.elapsed();
  return found;
}

StepRunner::StepRunner(const StepProblem& problem, const Progress& progress, const RegionKnown& region_known,
                       std::unique_ptr<StepRunner> previous)
    : scalar_(problem.scalar) {
  const FoundRegion found = find_region(problem, progress);
  if (region_known) {
    region_known(*found.region);
  }
  *this = StepRunner(found, problem, progress, std::move(previous));
}

StepRunner::StepRunner(const FoundRegion& found, const StepProblem& problem, const Progress& progress,
                       std::unique_ptr<StepRunner> previous, std::shared_ptr<CellModel> cells)
    : scalar_(problem.scalar), region_ms_(found.milliseconds) {
  std::unique_ptr<LaplacianEditor> before = previous ? std::move(previous->editor_) : nullptr;
  editor_ = cells ? std::make_unique<LaplacianEditor>(problem.mesh, std::move(cells), problem.settings, progress,
                                                      std::move(before))
                  : std::make_unique<LaplacianEditor>(problem.mesh, found.region, problem.settings, progress,
                                                      std::move(before));
  if (problem.mirror) {
    symmetry_.emplace(problem.mesh, region(), *problem.mirror);
  }
}

void StepRunner::finish(Points& places) const {
  if (symmetry_) {
    symmetry_->apply(places);
  }
  round_to(scalar_, places);
}

void StepRunner::solve(const std::vector<HandleMotion>& maps, Points& places, const Progress& go_on) {
  places = editor_->solve(maps, Affine::Identity(), go_on);
  ++solved_;
  finish(places);
}

EditReport StepRunner::report(bool whole) const {
  Points stored = editor_->positions();
  finish(stored);
  EditReport report = editor_->report(stored, whole);
  const std::vector<int>& vertices = region().mesh_vertex;
  const auto behind = std::find(vertices.begin(), vertices.end(), report.causes.behind);
  if (behind != vertices.end()) {
    const double most = stored.row(behind - vertices.begin()).cwiseAbs().maxCoeff();
    report.causes.step = most * (scalar_ == StoredScalar::Float ? std::numeric_limits<float>::epsilon()
                                                                : std::numeric_limits<double>::epsilon());
  }
  report.region_ms = region_ms_;
  if (solved_ > 1) {  // everything existed before this pose
    report.region_ms = report.operator_ms = report.factor_ms = report.kernel_ms = 0;
    report.factor_taken_over = true;
    report.taken_over = "operator and factor";
  }
  return report;
}

}  // namespace lapedit
