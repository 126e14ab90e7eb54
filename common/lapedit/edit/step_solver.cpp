// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/cells/surface_metric.h"
#include "lapedit/deform/edit_quality.h"
#include "lapedit/edit/edit_step.h"
#include "lapedit/edit/step_frame.h"
#include "lapedit/mesh/vertex_set.h"

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

void require_size(const TriangleMesh& mesh, const Region& region) {
  constexpr double kLargest = 1e60, kSmallest = 1e-60;
  const Points points = gather(mesh.vertices, region.mesh_vertex);
  const double farthest = points.cwiseAbs().maxCoeff(), size = bounding_box(points).sizes().maxCoeff();
  if (farthest > kLargest || (size > 0 && size < kSmallest)) {
    throw EditError(ErrorCause::BadParameter,
                    format_text("The region has a size of %.3g and coordinates up to %.3g, but an edit needs a size "
                                "above %.0e and coordinates below %.0e: use another unit of length.",
                                size, farthest, kSmallest, kLargest));
  }
}

FoundRegion find_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                        std::vector<std::vector<int>> groups, std::vector<std::vector<double>> weights, int threads) {
  weights.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    sort_group(groups[g], weights[g], g);
  }
  const Stopwatch watch;
  FoundRegion found;
  found.region = std::make_shared<const Region>(build_region(mesh, adjacency, spec, groups, threads, weights));
  require_size(mesh, *found.region);
  found.milliseconds = watch.elapsed();
  return found;
}

namespace {

/// Returns whether neither anchors nor a group without motion hold some component of a region.
bool is_unheld(const Region& region, const GroupPaths& paths) {
  std::vector<char> held = region.anchored;
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      held[region.component[i]] |= paths.stays(static_cast<std::size_t>(region.group[i]));
    }
  }
  return std::count(held.begin(), held.end(), 0) > 0;
}

/// Returns the handle group that is nearest to a vertex in space; -1 if there is one group only.
int nearest_of_several_groups(const Region& region, const Points& rest, int vertex) {
  int nearest = -1, last = 0;
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      last = std::max(last, region.group[i]);
      const auto distance = [&](int k) { return (rest.row(k) - rest.row(vertex)).squaredNorm(); };
      nearest = nearest < 0 || distance(i) < distance(nearest) ? i : nearest;
    }
  }
  return last > 0 ? region.group[nearest] : -1;
}

/// Returns the spacing of coordinates of this size.
double spacing(StoredScalar scalar, double coordinate) {
  return coordinate * (scalar == StoredScalar::Float ? static_cast<double>(std::numeric_limits<float>::epsilon())
                                                     : std::numeric_limits<double>::epsilon());
}

}  // namespace

StepSolver::StepSolver(const TriangleMesh& mesh, FoundRegion found, const EditSettings& settings,
                       const StepOptions& options)
    : settings_(settings), options_(options) {
  preparation_.region_ms = found.milliseconds;
  validate(settings);
  rest_ = std::make_shared<const RestPose>(mesh, std::move(found.region));
  if (options.mirror) {
    symmetry_.emplace(mesh, region(), *options.mirror);
  }
}

StepSolver::~StepSolver() = default;

void StepSolver::make_cells() {
  if (!cells_) {
    make_cells(options_.solver.threads);
  }
}

void StepSolver::make_cells(int threads) {
  const Stopwatch watch;
  cells_ = std::make_unique<CellModel>(rest_, settings_, ThreadPool(threads));
  preparation_.cells_ms = watch.elapsed();
}

std::shared_ptr<const LaplacianSystem> StepSolver::make_system(const TriangleMesh& mesh,
                                                               const LaplacianSystem* previous) const {
  std::vector<Matrix3> metric;
  if (settings_.method == EditMethod::Default && settings_.laplacian == LaplacianKind::Surface) {
    ThreadPool pool(options_.solver.threads);
    metric = surface_metric(region(), rest_->world, pool);
  }
  auto system = prepare_system(mesh, rest_, settings_, options_.solver, previous, metric.empty() ? nullptr : &metric);
  report_progress(0.9, "solve");
  return system;
}

void StepSolver::take(std::shared_ptr<const LaplacianSystem> system) {
  system_ = std::move(system);
  solver_ = std::make_unique<RefinedSolver>(system_->matrix, system_->correction, system_->pool);
  constraints_ = std::make_unique<EditConstraints>(*system_);
  if (system_->kernel) {
    frame_rotations_ = std::make_unique<FrameRotations>(region(), *system_->kernel);
  }
}

void StepSolver::prepare(const TriangleMesh& mesh, const LaplacianSystem* previous) {
  constexpr int kWorthAThread = 2000;
  const bool has_cells = settings_.method == EditMethod::Default && !cells_;
  const bool apart = has_cells && region().size() >= kWorthAThread && thread_count(options_.solver.threads) > 1;
  std::shared_ptr<const LaplacianSystem> system;
  ThreadPool(apart ? 2 : 1).each(has_cells ? 2 : 1, [&](int k) {
    if (k == 0) {
      system = make_system(mesh, previous);
    } else {
      make_cells(apart ? 1 : options_.solver.threads);
    }
  });
  take(std::move(system));
}

void StepSolver::finish(Points& positions) const {
  require_finite_result(positions);
  if (symmetry_) {
    symmetry_->apply(positions);
  }
  round_to(options_.scalar, positions);
}

/// Solves A d = `right` for the displacement d to the last bit of a double. A is the symmetric positive definite matrix
/// of LaplacianSystem.
void StepSolver::solve(const Points& right) {
  const Refinement refined = solver_->refine_to_the_bit(right, displacement_);
  if (std::isfinite(refined.last_change) && !refined.converged()) {
    refuse_conditioning(*system_);
  }
  figures_.refinements = std::max(figures_.refinements, refined.steps);
}

void StepSolver::rotate_and_solve() {
  Stopwatch watch;
  rotate_coordinates(*system_, *constraints_, rotations_, rotated_, right_);
  figures_.rotate_ms += watch.lap();
  solve(right_);
  figures_.solve_ms += watch.lap();
  ++figures_.iterations;
}

/// Solves once with the rotations of the cells, then with those fitted to an extrapolation of the last two solutions.
void StepSolver::local_global() {
  while (figures_.iterations < settings_.passes()) {
    report_progress(0, "rotations");
    const Stopwatch watch;
    if (figures_.iterations == 0) {
      cells_->spread(rotations_, *system_->pool);
    } else {
      rotations_before_ = rotations_;
      cells_->fit(*system_, constraints_->start(), ahead_(displacement_, figures_.iterations - 1), rotations_);
    }
    figures_.rotate_ms += watch.elapsed();
    rotate_and_solve();
    if (figures_.iterations > 1) {
      figures_.rotation_left = largest_rotation(rotations_, rotations_before_, &figures_.unsettled);
    }
  }
}

/// Performs steps 2 to 4 of Lipman et al. 2004, section 4.
void StepSolver::paper_pass() {
  report_progress(0, "rotations");
  const Stopwatch watch;
  figures_.normals_ms = frame_rotations_->estimate(constraints_->start(), displacement_, rotations_);
  figures_.rotate_ms = watch.elapsed() - figures_.normals_ms;
  rotate_and_solve();
  figures_.rotation_left = largest_rotation(rotations_, {});
}

const Points& StepSolver::pose(const std::vector<HandleMotion>& handles, const Affine& anchors) {
  const bool has_cells = settings_.method == EditMethod::Default;
  Stopwatch watch;
  figures_ = PoseFigures();
  figures_.refinements = system_->figures.refinements;
  constraints_->set(handles, anchors);  // checks the handles
  right_ = constraints_->right_hand_side();
  const bool moves = constraints_->any();
  if (!moves || has_cells) {
    displacement_.setZero(region().size(), 3);
  } else if (!system_->falloff.empty()) {
    constraints_->fall_off(displacement_);
  } else {
    solve(constraints_->right_hand_side());
  }
  figures_.unrotated_ms = watch.lap();
  rotations_.assign(region().size(), Matrix3::Identity());
  if (moves && has_cells) {
    report_progress(0, "rotations");
    cells_->solve(handles, anchors, false);
    figures_.rotate_ms = watch.lap();
    local_global();
  } else if (moves && settings_.method == EditMethod::Paper) {
    paper_pass();
  }
  // x = p + the rigid displacement of its component + d
  positions_.resize(region().size(), 3);
  for (int i = 0; i < region().size(); ++i) {
    Vector3 displacement = displacement_.row(i).transpose();
    if (constraints_->moves_rigidly()) {
      displacement += constraints_->rigid_motion(i).displacement(rest_->local.row(i).transpose());
      rotations_[i] *= constraints_->rigid_rotation(i);
    }
    positions_.row(i) = rest_->world.row(i) + displacement.transpose();
  }
  finish(positions_);
  ++preparation_.poses;
  return positions_;
}

EditReport StepSolver::report(bool whole) const {
  EditReport report;
  report.mesh_vertices = region().mesh_vertices;
  report.handle = region().count(VertexClass::Handle);
  report.free = region().count(VertexClass::Free);
  report.anchors = region().count(VertexClass::Anchor);
  report.fixed = region().mesh_vertices - region().size();
  report.left_out = region().left_out;
  report.settings = settings_;
  if (!system_) {
    return report;
  }
  report.solver = system_->matrix->cholesky.backend_name();
  report.normal_radius = system_->normal_radius;
  report.uniform_edges = system_->powers.uniform_edges;
  report.refinements = std::max(figures_.refinements, system_->figures.refinements);
  report.factor_reused = system_->figures.factor_reused;
  report.reused = system_->figures.reused;
  if (preparation_.poses <= 1) {
    report.region_ms = preparation_.region_ms;
    report.operator_ms = system_->figures.operator_ms;
    report.factor_ms = system_->figures.factor_ms;
    report.kernel_ms = system_->figures.kernel_ms + preparation_.cells_ms;
  } else {  // everything existed before this pose
    report.factor_reused = true;
    report.reused = "operator and factor";
  }
  if (positions_.rows() == 0) {
    return report;
  }
  report.unrotated_ms = figures_.unrotated_ms;
  report.normals_ms = figures_.normals_ms;
  report.rotate_ms = figures_.rotate_ms;
  report.solve_ms = figures_.solve_ms;
  EditQuality& quality = report;
  quality = edit_quality(*system_, *constraints_, positions_, rotations_);
  quality.detail_height = whole ? detail_height(*system_, positions_) : std::nullopt;
  quality.normal_equation_residual = solver_->relative_residual(right_, displacement_);
  quality.rotation_left = figures_.rotation_left;
  if (figures_.unsettled >= 0) {
    quality.causes.unsettled = region().mesh_vertex[figures_.unsettled];
    quality.causes.unsettled_group = nearest_of_several_groups(region(), rest_->local, figures_.unsettled);
  }
  // Users expect a whole component to move, but expect the surface around any other region to stay.
  quality.causes.unheld = region().kind != RegionSpec::Kind::Component && is_unheld(region(), constraints_->paths());
  quality.causes.by_radius = region().kind == RegionSpec::Kind::Radius;
  quality.causes.farthest = region().max_distance;
  constexpr double kRoundings = 4;  // rounding errors of two corners and of the fit
  const double largest = std::max(positions_.cwiseAbs().maxCoeff(), rest_->world.cwiseAbs().maxCoeff());
  quality.causes.rigid =
      moved_rigidly(region(), rest_->world, positions_, kRoundings * spacing(options_.scalar, largest));
  report.iterations = figures_.iterations;
  if (quality.causes.behind >= 0) {
    const std::vector<int>& vertices = region().mesh_vertex;
    const auto behind = std::find(vertices.begin(), vertices.end(), quality.causes.behind) - vertices.begin();
    quality.causes.step = spacing(options_.scalar, positions_.row(behind).cwiseAbs().maxCoeff());
  }
  return report;
}

}  // namespace lapedit
