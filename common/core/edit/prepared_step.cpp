// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/prepared_step.h"

#include <string>
#include <utility>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

/// Returns the residuals of the landmarks of a step.
std::vector<LandmarkResidual> residuals(const EditStep& step, const Points& vertices) {
  std::vector<LandmarkResidual> all;
  for (const HandleGroup& group : step.handles) {
    for (std::size_t k = 0; k < group.names.size(); ++k) {
      const int vertex = group.vertices[k];
      all.push_back({group.names[k], vertex, (vertices.row(vertex).transpose() - group.targets[k]).norm()});
    }
  }
  return all;
}

/// Appends a phrase to `all`, unless `all` contains it.
void add_phrase(const std::string& phrase, std::string& all) {
  if (all.find(phrase) == std::string::npos) {
    all += (all.empty() ? "" : "; ") + phrase;
  }
}

}  // namespace

PreparedStep::PreparedStep(const TriangleMesh& mesh, std::shared_ptr<const Joined> joined, const EditStep& step,
                           StepOptions options)
    : mesh_(mesh), joined_(std::move(joined)), options_(std::move(options)), step_(whole(step)) {
  options_.mirror = step.mirror;
}

/// Returns the step with the groups that the mirror plane adds. Replaces each vertex by the first at its position, and
/// sorts the groups.
EditStep PreparedStep::whole(const EditStep& given) const {
  EditStep step = joined_ ? welded(given, joined_->weld) : given;
  step = step.fit ? step : mirrored(mesh_, step);
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    sort_group(step.handles[g], g);
  }
  return step;
}

void PreparedStep::prepare(const Adjacency& adjacency, double fraction, const LaplacianSystem* previous) {
  if (step_.fit) {
    fitted_ = fit_step(mesh_, adjacency, step_, options_.solver);
    return;
  }
  validate(step_.settings);
  report_progress(0, "region");
  step_.region.without_handle = step_.handles.empty();
  FoundRegion found =
      find_region(mesh_, adjacency, step_.region, groups_of(step_), weights_of(step_), options_.solver.threads);
  motions_of(mesh_, step_, fraction);
  auto solver = std::make_unique<StepSolver>(mesh_, std::move(found), step_.settings, options_);
  solver->prepare(mesh_, previous);
  solver_ = std::move(solver);
}

void PreparedStep::move(const EditStep& step) {
  EditStep given = step;
  given.mirror = options_.mirror;
  given.region = {};
  EditStep next = whole(given);
  for (std::size_t g = 0; g < next.handles.size() || g < step_.handles.size(); ++g) {
    const bool is_same = next.handles.size() == step_.handles.size() &&
                         next.handles[g].vertices == step_.handles[g].vertices &&
                         (next.handles[g].weights.empty() || next.handles[g].weights == step_.handles[g].weights);
    if (!is_same) {
      throw EditError(ErrorCause::BadParameter,
                      entry_key("handles", g) +
                          ": these are not the vertices, or not the weights, that the step was prepared for: "
                          "give the step's own handle groups in their order, with other motions; for other vertices "
                          "or weights prepare another step.")
          .at(entry_key("handles", g));
    }
    next.handles[g].weights = step_.handles[g].weights;
  }
  step_.handles = next.handles;
}

void PreparedStep::pose(double fraction, std::vector<int>& vertices, Points& positions) {
  if (step_.fit) {
    positions = positions_at(fitted_, mesh_, fraction, options_.scalar);
    vertices = fitted_.vertices;
  } else {
    positions = solver_->pose(motions_of(mesh_, step_, fraction), fraction);
    vertices = region().mesh_vertex;
  }
  const std::size_t own = vertices.size();
  if (joined_) {
    joined_->weld.add_others(vertices, positions);
  }
  welded_ = static_cast<int>(vertices.size() - own);
}

EditReport PreparedStep::report(double fraction, const Points& vertices) const {
  EditReport report = step_.fit ? fitted_.report : solver_->report();
  report.welded = welded_;
  report.fixed -= welded_;
  for (const HandleGroup& group : step_.handles) {
    report.has_targets |= !group.targets.empty();
    add_phrase(group.spaces.conversion, report.landmark_conversion);
    add_phrase(group.targets_advice, report.targets_advice);
  }
  if (fraction == 1) {
    report.landmarks = residuals(step_, vertices);
  }
  return report;
}

}  // namespace lapedit
