// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/edit/prepared_step.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

void check_fraction(double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) {
    throw EditError(ErrorCause::BadParameter, "The fraction is " + number_text(fraction) +
                                                  ": give a number from 0 (no change) to 1 (the whole edit).");
  }
}

/// Returns a callback that maps the progress of task k of `count` to the progress of all tasks.
Progress progress_of(const Progress& progress, std::size_t k, std::size_t count) {
  if (!progress) {
    return {};
  }
  return [&progress, k, count](double done, const char* stage) {
    return progress((static_cast<double>(k) + done) / static_cast<double>(count), stage);
  };
}

/// Returns a callback that reports each stage with the constant fraction `done`.
Progress progress_at(const Progress& progress, double done) {
  if (!progress) {
    return {};
  }
  return [&progress, done](double, const char* stage) { return progress(done, stage); };
}

/// The poses of an edit, one per fraction. run() applies each step to all poses before it begins the next step.
class Poses {
 public:
  using Each = std::function<void(std::size_t pose, EditResult&&)>;

  Poses(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<double>& fractions, StoredScalar scalar,
        const SolverOptions& options)
      : given_(mesh),
        given_adjacency_(adjacency),
        mesh_(mesh),
        fractions_(fractions),
        vertices_(fractions.size(), mesh.vertices) {
    options_.scalar = scalar;
    options_.solver = options;
    std::for_each(fractions.begin(), fractions.end(), check_fraction);
    joined_.assign(fractions.size(), std::make_shared<const Joined>(mesh, mesh.vertices));
  }

  /// @param each  called after each step of each pose: for all poses of the first step, then of the second
  void run(const Edit& edit, const Progress& progress, const Each& each) {
    const std::size_t steps = edit.steps.size(), poses = fractions_.size();
    if (steps == 0) {
      throw EditError(ErrorCause::BadScript, "The edit has no steps: give at least one.");
    }
    for (std::size_t k = 0; k < steps; ++k) {
      for (std::size_t p = 0; p < poses; ++p) {
        try {
          const bool same_shape = k == 0 && p > 0;
          run_step(edit.steps[k], p, same_shape, progress_of(progress, k * poses + p, steps * poses), each);
        } catch (const EditError& error) {
          refuse(error, k, steps, p);
        }
      }
    }
  }

  /// Returns all vertices of a pose.
  const Points& vertices(std::size_t p) const { return vertices_[p]; }

 private:
  /// Makes mesh_ the shape of a pose. With `weld`, vertices at the same position count as one; only a step without
  /// welding can separate them.
  void see(std::size_t p, bool weld) {
    mesh_.vertices = vertices_[p];
    std::shared_ptr<const Joined>& surface = weld ? joined_[p] : separate_;
    if (!surface) {
      surface = std::make_shared<const Joined>(given_, mesh_.vertices, weld);
    }
    const std::shared_ptr<const Joined> now = surface->is_given ? nullptr : surface;
    if (now != seen_) {
      mesh_.faces = now ? now->faces : given_.faces;
      seen_ = now;
    }
  }

  void run_step(const EditStep& given, std::size_t p, bool same_shape, const Progress& progress, const Each& each) {
    if (!same_shape) {
      see(p, given.weld);
      const std::shared_ptr<const LaplacianSystem> previous = step_ ? step_->system() : nullptr;
      step_ = std::make_unique<PreparedStep>(mesh_, seen_, given, options_);
      step_->prepare(seen_ ? seen_->adjacency : given_adjacency_, fractions_[p], progress, previous.get());
    }
    EditResult result;
    step_->pose(fractions_[p], result.vertices, result.positions, progress_at(progress, 0.9));
    scatter(result.vertices, result.positions, vertices_[p]);
    result.reports.push_back(step_->report(fractions_[p], vertices_[p]));
    if (!given.weld) {
      joined_[p] = nullptr;
    }
    each(p, std::move(result));
    report_progress(progress, 1, "done");
  }

  /// Throws the error again with its step and fraction, if the edit has several, and with the name of its landmark.
  [[noreturn]] void refuse(const EditError& error, std::size_t k, std::size_t steps, std::size_t p) const {
    const bool cancelled = error.cause() == ErrorCause::Cancelled;
    std::string sentence = error.what();
    if (fractions_.size() > 1 && !cancelled) {
      sentence = "At fraction " + number_text(fractions_[p]) + ": " + sentence;
    }
    if (steps > 1) {
      sentence = "Step " + std::to_string(k + 1) + " of " + std::to_string(steps) + ": " + sentence;
    }
    for (const HandleGroup& group : step_ ? step_->step().handles : std::vector<HandleGroup>()) {
      const auto vertex = std::find(group.vertices.begin(), group.vertices.end(), error.vertex());
      const auto number = static_cast<std::size_t>(vertex - group.vertices.begin());
      if (number < group.names.size()) {
        sentence += " Vertex " + std::to_string(*vertex) + " is the landmark \"" + group.names[number] + "\".";
      }
    }
    throw EditError(error.cause(), sentence);
  }

  const TriangleMesh& given_;
  const Adjacency& given_adjacency_;
  std::vector<std::shared_ptr<const Joined>> joined_;  // per pose; null: not computed
  std::shared_ptr<const Joined> separate_;             // without welding; null: not computed
  std::shared_ptr<const Joined> seen_;                 // of mesh_; null: its faces are the given ones
  TriangleMesh mesh_;                                  // the shape before the current step
  const std::vector<double>& fractions_;
  StepOptions options_;
  std::vector<Points> vertices_;        // per pose
  std::unique_ptr<PreparedStep> step_;  // the current one
};

std::string by_position_advice(const Edit& edit) {
  return edit.positions.points.empty()
             ? ""
             : "; or, to apply it by position, remove vertices, faces and connectivity from the "
               "edit's key mesh, and keep positions";
}

}  // namespace

void require_same_mesh(const TriangleMesh& mesh, const Edit& edit) {
  const auto vertices = mesh.vertices.rows();
  const auto faces = mesh.faces.rows();
  if ((edit.mesh_vertices && *edit.mesh_vertices != vertices) || (edit.mesh_faces && *edit.mesh_faces != faces)) {
    throw EditError(
        ErrorCause::MeshMismatch,
        "The edit was made for a mesh of " +
            (edit.mesh_vertices ? std::to_string(*edit.mesh_vertices) : std::string("any number of")) +
            " vertices and " + (edit.mesh_faces ? std::to_string(*edit.mesh_faces) : std::string("any number of")) +
            " faces, but this one has " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
            " faces: open the mesh that the edit was made for" + by_position_advice(edit) + ".");
  }
  if (!edit.connectivity.empty()) {
    const std::string checksum = connectivity_checksum(static_cast<std::size_t>(vertices), mesh.faces);
    if (checksum != edit.connectivity) {
      throw EditError(ErrorCause::MeshMismatch, "The edit was made for a mesh of connectivity " + edit.connectivity +
                                                    ", but this one, of the same size, has " + checksum +
                                                    ": its vertices or faces are in another order" +
                                                    by_position_advice(edit) + ".");
    }
  }
}

std::vector<EditResult> apply_edit(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                   const SelectedVertices& selection, const std::vector<double>& fractions,
                                   StoredScalar scalar, const Progress& progress, const SolverOptions& options) {
  Poses poses(mesh, adjacency, fractions, scalar, options);
  require_same_mesh(mesh, edit);
  std::vector<EditResult> results(fractions.size());
  poses.run(located(mesh, adjacency, edit, selection), progress, [&](std::size_t p, EditResult&& step) {
    results[p].vertices = united(results[p].vertices, step.vertices);
    results[p].reports.push_back(std::move(step.reports.front()));
  });
  for (std::size_t p = 0; p < results.size(); ++p) {
    results[p].positions = gather(poses.vertices(p), results[p].vertices);
  }
  return results;
}

EditResult apply_edit(const TriangleMesh& mesh, const Edit& edit, double fraction, StoredScalar scalar,
                      const Progress& progress, const SolverOptions& options) {
  validate(mesh);
  const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces, options.threads);
  return std::move(apply_edit(mesh, adjacency, edit, {}, {fraction}, scalar, progress, options).front());
}

std::vector<EditResult> apply_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                    StoredScalar scalar, const Progress& progress) {
  require_same_mesh(mesh, edit);
  const std::vector<double> whole = {1};
  std::vector<EditResult> results;
  Poses(mesh, adjacency, whole, scalar, {})
      .run(located(mesh, adjacency, edit), progress,
           [&results](std::size_t, EditResult&& result) { results.push_back(std::move(result)); });
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
