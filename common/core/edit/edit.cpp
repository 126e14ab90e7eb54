// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "lapedit/base/format_text.h"
#include "lapedit/base/refuse.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

void check_fraction(double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) {
    refuse_edit(ErrorCause::BadParameter, {"fraction"}, "The fraction is ", fraction,
                ": give a number from 0 (no change) to 1 (the whole edit).");
  }
}

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

/// Runs an edit for one fraction after the other. Of each pose only the shape before the current step is kept.
class Poses {
 public:
  using Each = std::function<void(EditResult&& step)>;

  Poses(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit, const std::vector<double>& fractions,
        StoredScalar scalar, const SolverOptions& options)
      : given_(mesh),
        edit_(edit),
        fractions_(fractions),
        joined_(joined_surface(mesh)),
        adjacency_(joined_ ? joined_->adjacency : adjacency),
        first_{mesh.vertices, joined_ ? joined_->faces : mesh.faces},
        systems_(edit.steps.size()) {
    options_.scalar = scalar;
    options_.solver = options;
    if (edit.steps.empty()) {
      refuse_edit(ErrorCause::BadScript, {"steps"}, "The edit has no steps: give at least one.");
    }
  }

  /// @param each  called after each step of the pose
  void run(std::size_t pose, const Each& each) {
    const std::size_t steps = edit_.steps.size();
    vertices_ = given_.vertices;
    for (std::size_t k = 0; k < steps; ++k) {
      try {
        const ProgressPart part(pose * steps + k, fractions_.size() * steps);
        run_step(k, pose, each);
      } catch (const EditError& error) {
        refuse(error, k, pose);
      }
    }
  }

  /// Returns all vertices of the last pose.
  const Points& vertices() const { return vertices_; }

 private:
  void run_step(std::size_t k, std::size_t pose, const Each& each) {
    const double fraction = fractions_[pose];
    const bool is_last = pose + 1 == fractions_.size();
    std::unique_ptr<PreparedStep>& step = k == 0 || is_last ? first_step_ : later_step_;
    if (k > 0 || pose == 0) {
      if (k > 0) {
        later_.vertices = vertices_;
        later_.faces = first_.faces;
      }
      now_ = nullptr;
      step = std::make_unique<PreparedStep>(k > 0 ? later_ : first_, joined_, edit_.steps[k], options_);
      now_ = step.get();
      // The same step of the last pose has the most in common, otherwise the step before.
      std::shared_ptr<const LaplacianSystem>& previous = systems_[pose > 0 || k == 0 ? k : k - 1];
      step->prepare(adjacency_, fraction, previous.get());
      if (is_last) {
        previous = nullptr;
      }
      systems_[k] = step->system();
    }
    now_ = step.get();
    EditResult result;
    report_progress(0.9, "pose");
    step->pose(fraction, result.vertices, result.positions);
    scatter(result.vertices, result.positions, vertices_);
    result.reports.push_back(step->report(fraction, vertices_));
    each(std::move(result));
    report_progress(1, "done");
  }

  /// Throws the error again with its step and fraction, if the edit has several, and with the name of its landmark.
  [[noreturn]] void refuse(const EditError& error, std::size_t k, std::size_t pose) const {
    const bool cancelled = error.cause() == ErrorCause::Cancelled;
    std::string sentence = error.what();
    if (fractions_.size() > 1 && !cancelled) {
      sentence = "At fraction " + number_text(fractions_[pose]) + ": " + sentence;
    }
    if (edit_.steps.size() > 1) {
      sentence = "Step " + std::to_string(k + 1) + " of " + std::to_string(edit_.steps.size()) + ": " + sentence;
    }
    for (const HandleGroup& group : now_ ? now_->step().handles : std::vector<HandleGroup>()) {
      const auto vertex = std::find(group.vertices.begin(), group.vertices.end(), error.vertex());
      const auto number = static_cast<std::size_t>(vertex - group.vertices.begin());
      if (number < group.names.size()) {
        sentence += " Vertex " + std::to_string(*vertex) + " is the landmark \"" + group.names[number] + "\".";
      }
    }
    EditError refusal(error.cause(), sentence, error.vertex());
    if (!error.key().empty()) {
      refusal.at(entry_key("steps", k) + "." + error.key());
    }
    throw refusal;
  }

  const TriangleMesh& given_;
  const Edit& edit_;
  const std::vector<double>& fractions_;
  std::shared_ptr<const Joined> joined_;  // null: the faces of the mesh
  const Adjacency& adjacency_;
  TriangleMesh first_, later_;  // the shapes before the first and before a later step, whose faces are joined
  StepOptions options_;
  std::unique_ptr<PreparedStep> first_step_, later_step_;  // the first step serves all poses
  const PreparedStep* now_ = nullptr;
  std::vector<std::shared_ptr<const LaplacianSystem>> systems_;  // per step, of the last pose
  Points vertices_;
};

std::string by_position_advice(const Edit& edit) {
  return edit.positions.points.empty()
             ? ""
             : "; or, to apply it by position, remove vertices, faces and connectivity from the "
               "edit's key mesh, and keep positions";
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
    fitted_.report.causes.step = spacing(options_.scalar, fitted_.positions.cwiseAbs().maxCoeff());
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
      refuse_edit(ErrorCause::BadParameter, {entry_key("handles", g)}, entry_key("handles", g),
                  ": these are not the vertices, or not the weights, that the step was prepared for: "
                  "give the step's own handle groups in their order, with other motions; for other vertices "
                  "or weights prepare another step.");
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

void require_same_mesh(const TriangleMesh& mesh, const Edit& edit) {
  const auto vertices = mesh.vertices.rows(), faces = mesh.faces.rows();
  const auto text = [](const std::optional<int>& count) { return count ? std::to_string(*count) : "any number of"; };
  if ((edit.mesh_vertices && *edit.mesh_vertices != vertices) || (edit.mesh_faces && *edit.mesh_faces != faces)) {
    refuse_edit(ErrorCause::MeshMismatch, {"mesh"}, "The edit was made for a mesh of ", text(edit.mesh_vertices),
                " vertices and ", text(edit.mesh_faces), " faces, but this one has ", vertices, " vertices and ", faces,
                " faces: open the mesh that the edit was made for", by_position_advice(edit), ".");
  }
  if (!edit.connectivity.empty()) {
    const std::string checksum = connectivity_checksum(static_cast<std::size_t>(vertices), mesh.faces);
    if (checksum != edit.connectivity) {
      refuse_edit(ErrorCause::MeshMismatch, {"mesh.connectivity"}, "The edit was made for a mesh of connectivity ",
                  edit.connectivity, ", but this one, of the same size, has ", checksum,
                  ": its vertices or faces are in another order", by_position_advice(edit), ".");
    }
  }
}

void apply_edit(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                const SelectedVertices& selection, const std::vector<double>& fractions, const EachPose& each,
                StoredScalar scalar, const Progress& progress, const SolverOptions& options) {
  const ProgressScope scope(progress);
  std::for_each(fractions.begin(), fractions.end(), check_fraction);
  require_same_mesh(mesh, edit);
  const Edit numbered = located(mesh, adjacency, edit, selection);
  Poses poses(mesh, adjacency, numbered, fractions, scalar, options);
  for (std::size_t p = 0; p < fractions.size(); ++p) {
    EditResult whole;
    poses.run(p, [&whole](EditResult&& step) {
      whole.vertices = united(whole.vertices, step.vertices);
      whole.reports.push_back(std::move(step.reports.front()));
    });
    whole.positions = gather(poses.vertices(), whole.vertices);
    each(std::move(whole));
  }
}

std::vector<EditResult> apply_edit(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                   const SelectedVertices& selection, const std::vector<double>& fractions,
                                   StoredScalar scalar, const Progress& progress, const SolverOptions& options) {
  std::vector<EditResult> results;
  const auto keep = [&results](EditResult&& result) { results.push_back(std::move(result)); };
  apply_edit(mesh, adjacency, edit, selection, fractions, keep, scalar, progress, options);
  return results;
}

EditResult apply_edit(const TriangleMesh& mesh, const Edit& edit, double fraction, StoredScalar scalar,
                      const Progress& progress, const SolverOptions& options) {
  const ProgressScope scope(progress);
  validate(mesh);
  const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  return std::move(apply_edit(mesh, adjacency, edit, {}, {fraction}, scalar, {}, options).front());
}

std::vector<EditResult> apply_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                    StoredScalar scalar, const Progress& progress) {
  const ProgressScope scope(progress);
  require_same_mesh(mesh, edit);
  const std::vector<double> whole = {1};
  const Edit numbered = located(mesh, adjacency, edit);
  std::vector<EditResult> results;
  Poses(mesh, adjacency, numbered, whole, scalar, {}).run(0, [&results](EditResult&& result) {
    results.push_back(std::move(result));
  });
  return results;
}

std::string text_of(const std::vector<EditReport>& reports) {
  std::string text;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    if (reports.size() > 1) {
      text += (k > 0 ? "\nStep " : "Step ") + std::to_string(k + 1) + " of " + std::to_string(reports.size()) + "\n";
    }
    text += reports[k].text();
  }
  return text;
}

}  // namespace lapedit
