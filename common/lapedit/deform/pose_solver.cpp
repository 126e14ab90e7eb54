// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/pose_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/edit_quality.h"
#include "lapedit/deform/rotation_pass.h"

namespace lapedit {
namespace {

double largest_row(const Points& points) {
  return points.rows() > 0 ? points.rowwise().norm().maxCoeff() : 0;
}

}  // namespace

void require_finite_result(const Points& positions) {
  if (!positions.allFinite()) {
    throw EditError(
        ErrorCause::NotFinite,
        "The result is not finite, since the handle's displacement is too large for the mesh: move it less.");
  }
}

struct PoseSolver::Impl {
  EditReport report;  // of preparation and last solve, without figures that are computed on demand
  std::shared_ptr<const LaplacianSystem> system;
  RefinedSolver solver;
  EditConstraints constraints;
  std::unique_ptr<RotationPass> rotation;  // null without detail rotation

  // Of the last solve, size() x 3 each.
  Points displacement;  // d, from the carried pose
  Points right;         // right-hand side of the normal equations
  Points previous;      // d of the pass before
  // Nothing before the first solve.
  Points positions;
  std::vector<Matrix3> rotations;
  std::vector<Matrix3> rotations_before;  // of the previous pass, if there are several

  // Of the previous pass, if the next one may be dropped; and scratch.
  std::vector<Matrix3> kept_rotations;
  Points kept_right, pose, ahead;

  Impl(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest, const EditSettings& settings,
       const Progress& progress, const LaplacianSystem* before)
      : system(prepare_system(mesh, std::move(rest), settings, before, progress, report)),
        solver(system->matrix, system->correction, system->pool),
        constraints(*system) {
    const Stopwatch watch;
    if (settings.rotation != DetailRotation::None) {
      rotation = std::make_unique<RotationPass>(*system);
    }
    report.kernel_ms += watch.elapsed();
    report_progress(progress, 0.9, "solve");
  }

  void solve_exactly(const Points& right_hand_side, const Progress& go_on);
  void turn_locally(const std::vector<Matrix3>* start, const Progress& go_on);
  void turn_details(const Progress& go_on);
  double stretch();
  bool drop_pass(double stretched, const Progress& go_on);
  void swap_with_kept();
  void collect_positions();
};

/// d = (M^T M + W^2)^-1 b, to the last bit of a double.
void PoseSolver::Impl::solve_exactly(const Points& right_hand_side, const Progress& go_on) {
  const Refinement refined = solver.refine_to_the_bit(right_hand_side, displacement, go_on);
  if (std::isfinite(refined.last_change) && !refined.converged()) {
    refuse_conditioning(*system);
  }
  report.refinements = std::max(report.refinements, refined.steps);
}

/// Solves once with the given rotations, then with those of the vertices' one-rings, fitted to an extrapolation of the
/// last two solutions, which saves passes.
void PoseSolver::Impl::turn_locally(const std::vector<Matrix3>* start, const Progress& go_on) {
  if (start != nullptr) {
    rotations = *start;
  }
  for (report.iterations = 0; report.iterations < system->settings.passes(); ++report.iterations) {
    report_progress(go_on, 0, "rotations");
    if (report.iterations == 0) {
      rotation->turn_by(rotations, constraints, right);
    } else {
      rotations_before = rotations;
      ahead = displacement;
      if (report.iterations > 1) {
        ahead += kMomentum * (displacement - previous);
      }
      previous = displacement;
      rotation->turn_with_rings(ahead, constraints, rotations, right);
    }
    report.rotate_ms += rotation->rotate_ms();
    const Stopwatch watch;
    solve_exactly(right, go_on);
    report.solve_ms += watch.elapsed();
    report.rotation_left = report.iterations > 0 ? largest_turn(rotations, rotations_before) : 0;
  }
}

/// Returns the RMS edge stretch of the current pose.
double PoseSolver::Impl::stretch() {
  pose = displacement + (constraints.carry() ? constraints.carried_pose() : system->rest.local);
  return edge_stretch(system->region, system->rest.local, pose).rms;
}

void PoseSolver::Impl::swap_with_kept() {
  displacement.swap(previous);
  rotations.swap(kept_rotations);
  right.swap(kept_right);
}

/// Returns to the previous pass. A fall-off that rotations were estimated from is not a result; the unrotated solution
/// is one, if it is not worse than the pass.
/// @param stretched  RMS stretch of the pass. @return whether it is dropped
bool PoseSolver::Impl::drop_pass(double stretched, const Progress& go_on) {
  swap_with_kept();
  if (report.iterations == 0 && !system->falloff.empty()) {
    solve_exactly(constraints.right_hand_side(), go_on);
    if (!(stretch() <= stretched)) {
      swap_with_kept();
      return false;
    }
  }
  report.passes_dropped = system->settings.passes() - report.iterations;
  return true;
}

/// Repeats steps 2 to 4 of the paper's section 4 until the result has converged. A pass that makes it much worse is
/// dropped: with orders 2 and 3 errors of the rotations can grow from pass to pass. In tests good passes stretched
/// edges up to 1.3 times as much as the previous pose, bad ones 1.5 to 20 times. The first pass of order 1 is always
/// kept.
void PoseSolver::Impl::turn_details(const Progress& go_on) {
  constexpr double kSettled = 1e-4, kWorse = 1.5, kSlack = 0.05;
  const EditSettings& settings = system->settings;
  double least = std::numeric_limits<double>::infinity();
  rotation->start(constraints);
  for (int pass = 0; pass < settings.passes(); ++pass) {
    const bool may_drop = settings.order > 1 || pass > 0;
    if (settings.passes() > 1) {
      rotations_before = rotations;
    }
    if (may_drop) {
      least = std::min(least, stretch());
      rotations.swap(kept_rotations);
      right.swap(kept_right);
    }
    previous = displacement;
    report_progress(go_on, 0, "rotations");
    rotation->turn(displacement, constraints, rotations, right);
    report.normals_ms += rotation->normals_ms();
    report.rotate_ms += rotation->rotate_ms();
    const Stopwatch watch;
    solve_exactly(right, go_on);
    report.solve_ms += watch.elapsed();
    const double stretched = may_drop ? stretch() : 0;
    if (may_drop && !(stretched <= kWorse * least + kSlack) && drop_pass(stretched, go_on)) {
      return;
    }
    report.rotation_left = largest_turn(rotations, rotations_before);
    ++report.iterations;
    previous -= displacement;
    if (pass > 0 && largest_row(previous) < kSettled * system->region.radius) {
      break;
    }
  }
}

/// Computes x = p + the rigid displacement of its component + d.
void PoseSolver::Impl::collect_positions() {
  const RestPose& rest = system->rest;
  positions.resize(rest.world.rows(), 3);
  for (int i = 0; i < system->region.size(); ++i) {
    Vector3 way = displacement.row(i).transpose();
    if (constraints.carry()) {
      way += constraints.carried(i).displacement(rest.local.row(i).transpose());
      rotations[i] *= constraints.carried_rotation(i);
    }
    positions.row(i) = rest.world.row(i) + way.transpose();
  }
  require_finite_result(positions);
}

PoseSolver::PoseSolver(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest, const EditSettings& settings,
                       const Progress& progress, std::unique_ptr<PoseSolver> previous) {
  validate(settings);
  impl_ = std::make_unique<Impl>(mesh, std::move(rest), settings, progress,
                                 previous ? previous->impl_->system.get() : nullptr);
}

PoseSolver::~PoseSolver() = default;

const LaplacianSystem& PoseSolver::system() const {
  return *impl_->system;
}

RefinedSolver& PoseSolver::solver() {
  return impl_->solver;
}

const std::string& PoseSolver::taken_over() const {
  return impl_->report.taken_over;
}

const Points& PoseSolver::solve(const std::vector<HandleMotion>& handles, const Affine& anchors,
                                const std::vector<Matrix3>* start, const Progress& go_on) {
  Impl& s = *impl_;
  const Stopwatch watch;
  const bool locally = s.system->settings.rotation == DetailRotation::LocalGlobal;
  s.report.refinements = s.system->refinements;
  s.constraints.set(handles, anchors);
  s.right = s.constraints.right_hand_side();
  if (!s.constraints.pull() || locally) {
    s.displacement.setZero(s.system->region.size(), 3);
  } else if (!s.system->falloff.empty()) {
    s.constraints.fall_off(s.displacement);
  } else {
    s.solve_exactly(s.constraints.right_hand_side(), go_on);
  }
  s.report.unrotated_ms = watch.elapsed();
  s.report.normals_ms = s.report.rotate_ms = s.report.solve_ms = 0;
  s.report.iterations = s.report.passes_dropped = 0;
  s.report.rotation_left = 0;
  s.rotations.assign(s.system->region.size(), Matrix3::Identity());
  if (s.rotation && s.constraints.pull()) {
    locally ? s.turn_locally(start, go_on) : s.turn_details(go_on);
  }
  s.collect_positions();
  return s.positions;
}

const std::vector<Matrix3>& PoseSolver::rotations() const {
  return impl_->rotations;
}

const Points& PoseSolver::positions() const {
  return impl_->positions;
}

EditReport PoseSolver::report(const Points& stored, bool whole) const {
  const Impl& s = *impl_;
  EditReport report = s.report;
  if (s.positions.rows() == 0) {
    return report;  // there is no solution yet
  }
  EditQuality& quality = report;
  quality = edit_quality(*s.system, s.constraints, stored, s.rotations);
  quality.detail_height = whole ? detail_height(*s.system, stored) : std::nullopt;
  quality.rotation_left = s.report.rotation_left;
  quality.normal_equation_residual = s.solver.relative_residual(s.right, s.displacement);
  return report;
}

}  // namespace lapedit
