// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/base/stopwatch.h"

namespace lapedit {
namespace {

void check_fraction(double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) {
    throw EditError(ErrorCause::BadParameter, "The fraction is " + number_text(fraction) +
                                                  ": give a number from 0 (no change) to 1 (the whole edit).");
  }
}

/// A step that can be solved for any fraction.
class PreparedStep {
 public:
  /// @param fraction  one of those that it will be solved for
  /// @param previous  whose factor is taken over if it fits
  PreparedStep(const TriangleMesh& mesh, const Adjacency& adjacency, const EditStep& step, double fraction,
               const Progress& progress, std::unique_ptr<LaplacianEditor> previous = nullptr) {
    validate(step.settings);
    groups_.reserve(step.handles.size());
    for (const HandleGroup& handle : step.handles) {
      groups_.push_back(handle.vertices);
      std::sort(groups_.back().begin(), groups_.back().end());
      groups_.back().erase(std::unique(groups_.back().begin(), groups_.back().end()), groups_.back().end());
    }
    report_progress(progress, 0, "region");
    Stopwatch watch;
    Region region = build_region(mesh, adjacency, step.region, groups_);
    region_ms_ = watch.lap();
    // Before the factorisation: what is wrong with a transform is said at once.
    targets(mesh, step, fraction);
    editor_ = std::make_unique<LaplacianEditor>(mesh, std::move(region), step.settings, progress, std::move(previous));
  }

  EditResult solve(const TriangleMesh& mesh, const EditStep& step, double fraction, StoredScalar scalar) {
    EditResult result;
    result.positions = editor_->solve(targets(mesh, step, fraction));
    result.vertices = editor_->region().mesh_vertex;
    result.reports.push_back(editor_->report());
    EditReport& report = result.reports.back();
    report.region_ms = region_ms_;
    if (solved_) {  // all that was there before this pose
      report.region_ms = report.operator_ms = report.factor_ms = report.kernel_ms = 0;
      report.factor_taken_over = true;
    }
    solved_ = true;
    round_to(scalar, result.positions);
    return result;
  }

  std::unique_ptr<LaplacianEditor> release() { return std::move(editor_); }

 private:
  std::vector<Affine> targets(const TriangleMesh& mesh, const EditStep& step, double fraction) const {
    std::vector<Affine> maps;
    maps.reserve(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      maps.push_back(resolve(step.handles[g].transform, centroid(mesh.vertices, groups_[g]), fraction));
    }
    return maps;
  }

  std::vector<std::vector<int>> groups_;
  std::unique_ptr<LaplacianEditor> editor_;
  double region_ms_ = 0;
  bool solved_ = false;
};

void put(const EditResult& result, Points& vertices) {
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    vertices.row(result.vertices[i]) = result.positions.row(static_cast<Eigen::Index>(i));
  }
}

/// A part of the whole progress, number k of so many.
Progress part_of(const Progress& progress, std::size_t k, std::size_t count) {
  if (!progress) {
    return {};
  }
  return [&progress, k, count](double done, const char* stage) {
    return progress((static_cast<double>(k) + done) / static_cast<double>(count), stage);
  };
}

void require_steps(const Edit& edit) {
  if (edit.steps.empty()) {
    throw EditError(ErrorCause::BadScript, "The edit has no steps: give at least one.");
  }
}

/// Says which step a refusal is about, if there are several. To be called while it is handled.
[[noreturn]] void refuse_step(const EditError& error, std::size_t k, std::size_t count) {
  if (count == 1) {
    throw;
  }
  throw EditError(error.cause(),
                  "Step " + std::to_string(k + 1) + " of " + std::to_string(count) + ": " + error.what());
}

/// A pose on its way through the steps.
struct Pose {
  double fraction;
  Points vertices;
  std::vector<char> touched;  // per vertex: was it in a region
  std::vector<EditReport> reports;

  EditResult result() && {
    EditResult result;
    for (int v = 0; v < static_cast<int>(touched.size()); ++v) {
      if (touched[v]) {
        result.vertices.push_back(v);
      }
    }
    result.positions.resize(static_cast<Eigen::Index>(result.vertices.size()), 3);
    for (std::size_t i = 0; i < result.vertices.size(); ++i) {
      result.positions.row(static_cast<Eigen::Index>(i)) = vertices.row(result.vertices[i]);
    }
    result.reports = std::move(reports);
    return result;
  }
};

/// Runs step k for all poses.
void run_step(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit, std::size_t k,
              StoredScalar scalar, const Progress& progress, std::vector<Pose>& poses) {
  const EditStep& step = edit.steps[k];
  TriangleMesh current = mesh;
  std::unique_ptr<PreparedStep> prepared;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    Pose& pose = poses[p];
    const Progress part = part_of(progress, k * poses.size() + p, edit.steps.size() * poses.size());
    try {
      if (k > 0 || !prepared) {
        current.vertices = pose.vertices;
        prepared = std::make_unique<PreparedStep>(current, adjacency, step, pose.fraction, part,
                                                  prepared ? prepared->release() : nullptr);
      }
      EditResult result = prepared->solve(current, step, pose.fraction, scalar);
      put(result, pose.vertices);
      for (const int v : result.vertices) {
        pose.touched[v] = 1;
      }
      pose.reports.push_back(std::move(result.reports.front()));
      report_progress(part, 1, "done");
    } catch (const EditError& error) {
      if (poses.size() == 1 || error.cause() == ErrorCause::Cancelled) {
        throw;
      }
      throw EditError(error.cause(), "At fraction " + number_text(pose.fraction) + ": " + error.what());
    }
  }
}

}  // namespace

Vector3 centroid(const Points& vertices, const std::vector<int>& group) {
  if (group.empty()) {
    throw EditError(ErrorCause::NoHandle, "A handle group has no vertices: name at least one vertex to move.");
  }
  for (const int v : group) {
    if (v < 0 || v >= vertices.rows()) {
      throw EditError(ErrorCause::BadIndex, "Handle vertex " + std::to_string(v) + " does not exist: the mesh has " +
                                                std::to_string(vertices.rows()) + " vertices, numbered from 0.");
    }
  }
  Vector3 offset = Vector3::Zero();
  const Vector3 first = vertices.row(group.front()).transpose();
  for (const int v : group) {
    offset += vertices.row(v).transpose() - first;
  }
  return first + offset / static_cast<double>(group.size());
}

void require_same_mesh(const TriangleMesh& mesh, const Edit& edit) {
  const auto vertices = mesh.vertices.rows();
  const auto faces = mesh.faces.rows();
  if ((edit.mesh_vertices && *edit.mesh_vertices != vertices) || (edit.mesh_faces && *edit.mesh_faces != faces)) {
    throw EditError(ErrorCause::MeshMismatch,
                    "The edit was made for a mesh of " +
                        (edit.mesh_vertices ? std::to_string(*edit.mesh_vertices) : std::string("any number of")) +
                        " vertices and " +
                        (edit.mesh_faces ? std::to_string(*edit.mesh_faces) : std::string("any number of")) +
                        " faces, but this one has " + std::to_string(vertices) + " vertices and " +
                        std::to_string(faces) + " faces: open the mesh that the edit was made for.");
  }
  if (!edit.connectivity.empty()) {
    const std::string checksum = connectivity_checksum(static_cast<std::size_t>(vertices), mesh.faces);
    if (checksum != edit.connectivity) {
      throw EditError(ErrorCause::MeshMismatch, "The edit was made for a mesh of connectivity " + edit.connectivity +
                                                    ", but this one, of the same size, has " + checksum +
                                                    ": its vertices or faces are in another order.");
    }
  }
}

void round_to(StoredScalar scalar, Points& positions) {
  if (scalar == StoredScalar::Double) {
    return;
  }
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    positions.data()[i] = static_cast<double>(static_cast<float>(positions.data()[i]));
  }
  if (!positions.allFinite()) {
    throw EditError(
        ErrorCause::NotFinite,
        "The result does not fit into the mesh's single precision: the handle's displacement is too large.");
  }
}

EditResult apply_step(const TriangleMesh& mesh, const Adjacency& adjacency, const EditStep& step, double fraction,
                      StoredScalar scalar, const Progress& progress) {
  check_fraction(fraction);
  PreparedStep prepared(mesh, adjacency, step, fraction, progress);
  EditResult result = prepared.solve(mesh, step, fraction, scalar);
  report_progress(progress, 1, "done");
  return result;
}

void apply_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit, double fraction,
                 StoredScalar scalar, const Progress& progress, const std::function<void(EditResult&&)>& each) {
  require_steps(edit);
  const std::size_t count = edit.steps.size();
  TriangleMesh current = mesh;
  for (std::size_t k = 0; k < count; ++k) {
    try {
      EditResult step = apply_step(current, adjacency, edit.steps[k], fraction, scalar, part_of(progress, k, count));
      put(step, current.vertices);
      each(std::move(step));
    } catch (const EditError& error) {
      refuse_step(error, k, count);
    }
  }
}

EditResult apply_edit(const TriangleMesh& mesh, const Edit& edit, double fraction, StoredScalar scalar,
                      const Progress& progress) {
  return std::move(apply_edit(mesh, edit, std::vector<double>{fraction}, scalar, progress).front());
}

std::vector<EditResult> apply_edit(const TriangleMesh& mesh, const Edit& edit, const std::vector<double>& fractions,
                                   StoredScalar scalar, const Progress& progress) {
  validate(mesh);
  std::vector<Pose> poses;
  poses.reserve(fractions.size());
  for (const double fraction : fractions) {
    check_fraction(fraction);
    poses.push_back({fraction, mesh.vertices, std::vector<char>(mesh.vertices.rows(), 0), {}});
  }
  require_same_mesh(mesh, edit);
  require_steps(edit);
  const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  for (std::size_t k = 0; k < edit.steps.size(); ++k) {
    try {
      run_step(mesh, adjacency, edit, k, scalar, progress, poses);
    } catch (const EditError& error) {
      refuse_step(error, k, edit.steps.size());
    }
  }
  std::vector<EditResult> results;
  results.reserve(poses.size());
  for (Pose& pose : poses) {
    results.push_back(std::move(pose).result());
  }
  return results;
}

}  // namespace lapedit
