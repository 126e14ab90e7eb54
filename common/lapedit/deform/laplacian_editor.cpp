// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/laplacian_editor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/deform/laplacian_editor_state.h"

namespace lapedit {
namespace {

Matrix3 nearest_rotation_of(const Matrix3& linear) {
  const Matrix3 rotation = PolarDecomposition(linear).orthogonal();
  return rotation.determinant() > 0 ? rotation : Matrix3::Identity();
}

}  // namespace

void LaplacianEditor::State::refuse_conditioning() const {
  throw EditError(ErrorCause::IllConditioned,
                  "A Laplacian of order " + std::to_string(settings.order) + " over " + std::to_string(region.size()) +
                      " region vertices is too ill-conditioned to be solved in double precision: use a lower order or "
                      "a smaller region.");
}

/// Sets the pose that rotations are measured from.
void LaplacianEditor::State::turn_from(const Points& pose) {
  estimator_at_rest = &pose == &rest;
  if (settings.rotation == DetailRotation::SmoothSurface && estimator_at_rest) {
    if (!base.smooth_rest_is_exact) {
      base.smoother->apply(rest, base.smooth_rest);
      base.smooth_rest_is_exact = true;
    }
    estimator->set_before_smoothed(base.smooth_rest);
  } else {
    estimator->set_before(pose);
  }
}

/// out = (M^T M + W^2) x
void LaplacianEditor::State::normal_product(const Eigen::VectorXd& weights, const Points& x, Points& out) {
  base.m.apply(x, rows, *pool);
  base.m.apply_transposed(rows, out, *pool);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    out.row(i) += weights[i] * x.row(i);
  }
}

/// With the factor, and for the handles that it does not know (Woodbury). What is asked for at the handles themselves
/// goes straight into the correction: solved for without them it would be a large number to be taken away again.
void LaplacianEditor::State::solve_once(const Points& right, Points& x) {
  if (correction.rows.empty()) {
    base.factor->solve(right, x);
    return;
  }
  x = right;
  for (std::size_t c = 0; c < correction.rows.size(); ++c) {
    const int row = correction.rows[c];
    at_rows.row(static_cast<Eigen::Index>(c)) = right.row(row) / squared_weights[row];
    x.row(row).setZero();
  }
  base.factor->solve(x, x);
  for (std::size_t c = 0; c < correction.rows.size(); ++c) {
    at_rows.row(static_cast<Eigen::Index>(c)) -= x.row(correction.rows[c]);
  }
  corrected = correction.k.lazyProduct(at_rows);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index c = 0; c < corrected.rows(); ++c) {
      x.row(i) += correction.z(i, c) * corrected.row(c);
    }
  }
}

/// Solves to the last bit of a double.
void LaplacianEditor::State::solve_exactly(const Points& right, Points& x) {
  solve_once(right, x);
  doubled.set(x);
  int steps = 0;
  last_change = refine_to_the_bit(
      [&](const DoubledPoints& at, Points& out) {
        ++steps;
        report_progress(go_on, 0, "solve");
        normal_residual(base.m, squared_weights, right, at, between, out, *pool);
      },
      [this](const Points& from, Points& to) { solve_once(from, to); }, doubled, residual, step);
  constexpr double kAcceptable = 1e-6;
  if (std::isfinite(last_change) && !(last_change < kAcceptable)) {
    refuse_conditioning();
  }
  report.refinements = std::max(report.refinements, steps);
  x = doubled.high;
}

/// A component with anchors goes with them, one without goes with the mean of its groups' maps.
void LaplacianEditor::State::carry_components(const std::vector<Affine>& handles, const Affine& anchors) {
  const int components = static_cast<int>(region.anchored.size());
  targets.resize(handles.size());
  for (std::size_t g = 0; g < handles.size(); ++g) {
    targets[g] = Motion::of(handles[g], origin);
  }
  carried.assign(components, Motion());
  carried_rotation.assign(components, Matrix3::Identity());
  const Motion with_anchors = Motion::of(anchors, origin);
  handles_seen.assign(components, 0);
  for (int i = 0; i < region.size(); ++i) {
    const int c = region.component[i];
    if (region.classes[i] != VertexClass::Handle || region.anchored[c]) {
      continue;
    }
    // A running mean stays exact when all groups agree.
    const Motion& target = targets[region.group[i]];
    const int seen = ++handles_seen[c];
    carried[c].linear += (target.linear - carried[c].linear) / seen;
    carried[c].translation += (target.translation - carried[c].translation) / seen;
  }
  is_carried = false;
  for (int c = 0; c < components; ++c) {
    if (region.anchored[c]) {
      carried[c] = with_anchors;
    }
    if (!carried[c].none()) {
      is_carried = true;
      carried_rotation[c] = carried[c].linear.isZero(0) ? Matrix3(Matrix3::Identity())
                                                        : nearest_rotation_of(carried[c].linear + Matrix3::Identity());
    }
  }
  if (is_carried) {
    carried_pose = rest;
    for (int i = 0; i < region.size(); ++i) {
      carried_pose.row(i) += carried[region.component[i]].displacement(rest.row(i).transpose()).transpose();
    }
  }
}

/// Right-hand side of the constraints, for the displacement from the carried pose; anchors are in place there.
/// @return whether anything is to move from there
bool LaplacianEditor::State::set_constraints() {
  constraint_rhs.setZero(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      const Vector3 local = rest.row(i).transpose();
      const Vector3 way =
          targets[region.group[i]].displacement(local) - carried[region.component[i]].displacement(local);
      constraint_rhs.row(i) = squared_weights[i] * way.transpose();
    }
  }
  return !constraint_rhs.isZero(0);
}

/// rhs = constraints + M^T M_1^(k-1) (R - I) delta, for order k.
///
/// For k > 1 that is not M^T (R - I) M^k p, the coordinates of order k turned: those carry low-frequency errors of R
/// that the inverse of M^k blows up. On the octopus (16,554 vertices, order 2) the stretch is 49 % instead of 485 %.
void LaplacianEditor::State::rotate_deltas() {
  rows.resize(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    Vector3 coordinate = delta.row(i).transpose();
    if (is_carried) {
      coordinate += carried[region.component[i]].linear * coordinate;
    }
    rows.row(i) = ((rotations[i] - Matrix3::Identity()) * coordinate).transpose();
  }
  for (int k = 1; k < settings.order; ++k) {
    first().apply(rows, residual, *pool);
    rows.swap(residual);
  }
  base.m.apply_transposed(rows, rhs, *pool);
  rhs += constraint_rhs;
}

void LaplacianEditor::State::collect_positions() {
  positions.resize(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    Vector3 way = d.row(i).transpose();
    if (is_carried) {
      way += carried[region.component[i]].displacement(rest.row(i).transpose());
      rotations[i] *= carried_rotation[region.component[i]];
    }
    positions.row(i) = world.row(i) + way.transpose();
  }
}

/// @throws EditError (NoHandle, NotFinite)
void LaplacianEditor::State::check(const std::vector<Affine>& handles) const {
  const int groups = 1 + *std::max_element(region.group.begin(), region.group.end());
  if (static_cast<int>(handles.size()) < groups) {
    throw EditError(ErrorCause::NoHandle, std::to_string(handles.size()) + " handle maps were given for " +
                                              std::to_string(groups) + " handle groups: give one for each.");
  }
  for (std::size_t g = 0; g < handles.size(); ++g) {
    if (!handles[g].matrix().allFinite()) {
      throw EditError(ErrorCause::NotFinite,
                      "The target of handle group " + std::to_string(g) + " is not finite: give a finite transform.");
    }
  }
}

LaplacianEditor::LaplacianEditor(const TriangleMesh& mesh, Region region, const EditSettings& settings,
                                 const Progress& progress, std::unique_ptr<LaplacianEditor> previous)
    : state_(std::make_unique<State>()) {
  validate(settings);
  state_->region = std::move(region);
  state_->settings = settings;
  state_->set_up(mesh, progress, previous ? previous->state_.get() : nullptr);
}

LaplacianEditor::~LaplacianEditor() = default;
LaplacianEditor::LaplacianEditor(LaplacianEditor&&) noexcept = default;

const Region& LaplacianEditor::region() const {
  return state_->region;
}

const Points& LaplacianEditor::solve(const std::vector<Affine>& handles, const Affine& anchors, const Progress& go_on) {
  State& s = *state_;
  s.go_on = go_on;
  s.check(handles);
  if (!anchors.matrix().allFinite()) {
    throw EditError(ErrorCause::NotFinite, "The motion of the anchors is not finite: give a finite transform.");
  }
  Stopwatch watch;
  s.report.refinements = s.base.refinements;
  s.carry_components(handles, anchors);
  const bool moves = s.set_constraints();
  if (moves) {
    s.solve_exactly(s.constraint_rhs, s.d);
  } else {
    s.d.setZero(s.region.size(), 3);
  }
  s.report.rough_ms = watch.lap();
  s.report.normals_ms = s.report.rotate_ms = s.report.solve_ms = 0;
  s.report.iterations = 0;
  std::fill(s.rotations.begin(), s.rotations.end(), Matrix3::Identity());
  s.rhs = s.constraint_rhs;
  if (s.estimator && moves) {
    if (s.is_carried || !s.estimator_at_rest) {
      s.turn_from(s.is_carried ? s.carried_pose : s.rest);
    }
    constexpr double kSettled = 1e-4;
    for (int pass = 0; pass < s.settings.iterations; ++pass) {
      s.previous = s.d;
      report_progress(go_on, 0, "rotations");
      s.estimator->estimate(s.d, s.rotations);
      s.report.normals_ms += s.estimator->normals_ms();
      watch.lap();
      s.rotate_deltas();
      s.report.rotate_ms += s.estimator->rotate_ms() + watch.lap();
      s.solve_exactly(s.rhs, s.d);
      s.report.solve_ms += watch.lap();
      ++s.report.iterations;
      s.previous -= s.d;
      if (pass > 0 && largest_row(s.previous) < kSettled * s.region.radius) {
        break;
      }
    }
  }
  s.collect_positions();
  if (!s.positions.allFinite()) {
    throw EditError(ErrorCause::NotFinite,
                    "The result is not finite: the handle's displacement is too large for the mesh.");
  }
  return s.positions;
}

const Points& LaplacianEditor::preview(const std::vector<Affine>& handles) {
  State& s = *state_;
  if (!s.preview) {
    return solve(handles);
  }
  s.check(handles);
  for (std::size_t r = 0; r < s.responses.size(); ++r) {
    const State::Response& response = s.responses[r];
    const State::Motion motion = State::Motion::of(handles[response.group], s.origin);
    s.motions.row(static_cast<Eigen::Index>(r)) =
        (response.vertex >= 0  ? motion.displacement(s.rest.row(response.vertex).transpose())
         : response.column < 3 ? Vector3(motion.linear.col(response.column))
                               : motion.translation)
            .transpose();
  }
  const Points& pose = s.preview->pose(s.motions);
  if (!pose.allFinite()) {
    return solve(handles);  // beyond single precision, or beyond all: it will say so
  }
  return pose;
}

bool LaplacianEditor::has_preview() const {
  return state_->preview != nullptr;
}

const Points& LaplacianEditor::preview_normals() {
  static const Points kNone(0, 3);
  return state_->preview ? state_->preview->normals() : kNone;
}

std::size_t LaplacianEditor::bytes() const {
  const State& s = *state_;
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  const Region& r = s.region;
  std::size_t rows = 0;
  for (const Points* points : {&s.world, &s.rest, &s.delta, &s.carried_pose, &s.constraint_rhs, &s.rhs, &s.d,
                               &s.previous, &s.residual, &s.step, &s.rows, &s.positions, &s.base.smooth_rest,
                               &s.doubled.high, &s.doubled.low, &s.between.high, &s.between.low}) {
    rows += static_cast<std::size_t>(points->rows());
  }
  const std::size_t region_bytes = of(r.mesh_vertex) + of(r.classes) + of(r.group) + of(r.component) + of(r.distance) +
                                   of(r.anchor_weight) + of(r.anchor_depth) + of(r.neighbours.offsets) +
                                   of(r.neighbours.values) + of(r.edge_faces) +
                                   static_cast<std::size_t>(r.faces.size()) * sizeof(int);
  return region_bytes + rows * 3 * sizeof(double) + of(s.rotations) + s.base.m.bytes() + s.base.first.bytes() +
         s.base.factor->bytes() + (s.base.smoother ? s.base.smoother->bytes() : 0) +
         (s.preview ? s.preview->bytes() : 0) + (s.estimator ? s.estimator->bytes() : 0) +
         static_cast<std::size_t>(s.correction.z.size() + s.squared_weights.size() + s.base.weights.size()) *
             sizeof(double);
}

const std::vector<Matrix3>& LaplacianEditor::rotations() const {
  return state_->rotations;
}

EditReport LaplacianEditor::report() const {
  State& s = *state_;
  EditReport& report = s.report;
  if (s.positions.rows() == 0) {  // nothing has been solved for
    s.d.setZero(s.region.size(), 3);
    s.rhs = s.d;
    s.positions = s.world;
  }
  s.normal_product(s.squared_weights, s.d, s.residual);
  const double size =
      (s.base.matrix_norm + s.squared_weights.maxCoeff()) * s.d.cwiseAbs().maxCoeff() + s.rhs.cwiseAbs().maxCoeff();
  report.normal_equation_residual = size > 0 ? (s.residual - s.rhs).cwiseAbs().maxCoeff() / size : 0;
  report.handle_displacement = report.handle_residual = report.anchor_residual = 0;
  report.rotation_mean = report.rotation_max = 0;
  for (int i = 0; i < s.region.size(); ++i) {
    const Vector3 local = s.rest.row(i).transpose();
    const Vector3 carried =
        s.carried.empty() ? Vector3(Vector3::Zero()) : s.carried[s.region.component[i]].displacement(local);
    if (s.region.classes[i] == VertexClass::Handle && !s.targets.empty()) {
      const Vector3 way = s.targets[s.region.group[i]].displacement(local);
      report.handle_displacement = std::max(report.handle_displacement, way.norm());
      report.handle_residual = std::max(report.handle_residual, (carried + s.d.row(i).transpose() - way).norm());
    } else if (s.region.classes[i] == VertexClass::Anchor) {
      report.anchor_residual = std::max(report.anchor_residual, s.d.row(i).norm());
    }
    const double degrees = Eigen::AngleAxisd(s.rotations[i]).angle() * (180 / 3.14159265358979323846);
    report.rotation_mean += degrees / s.region.size();
    report.rotation_max = std::max(report.rotation_max, degrees);
  }
  const EdgeStretch stretch = edge_stretch(s.region, s.world, s.positions);
  report.stretch_rms = stretch.rms;
  report.stretch_max = stretch.largest;
  report.flipped = flipped_triangles(s.region, s.world, s.positions, s.rotations);
  return report;
}

}  // namespace lapedit
