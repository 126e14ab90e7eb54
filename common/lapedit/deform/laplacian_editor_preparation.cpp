// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/deform/diffusion.h"
#include "lapedit/deform/laplacian_editor_state.h"
#include "lapedit/linear/fill_reducing_ordering.h"

namespace lapedit {
namespace {

/// Enough for what is to be refined further, and for previews.
constexpr double kAccurate = 1e-8;
/// If it takes more steps to get there, a factor in single precision is not worth its memory.
constexpr int kMostForSingle = 3;
/// Handles of at most so many vertices are kept out of the factor.
constexpr int kSmallHandle = 8;

}  // namespace

void LaplacianEditor::State::set_up(const TriangleMesh& mesh, const Progress& progress, State* before) {
  const int n = region.size();
  world.resize(n, 3);
  rest.resize(n, 3);
  int first_handle = -1;
  for (int i = 0; i < n; ++i) {
    world.row(i) = mesh.vertices.row(region.mesh_vertex[i]);
    if (first_handle < 0 && region.classes[i] == VertexClass::Handle) {
      first_handle = i;
    }
  }
  if (first_handle < 0) {
    throw EditError(ErrorCause::NoHandle, "There is no handle in the region: name at least one vertex to move.");
  }
  origin = world.row(first_handle).transpose();
  rest = world.rowwise() - origin.transpose();

  pool = before && before->settings.threads == settings.threads ? before->pool
                                                                : std::make_shared<ThreadPool>(settings.threads);
  Stopwatch watch;
  report_progress(progress, 0.1, "operator");
  assemble(mesh, before);
  report.operator_ms = watch.lap();
  report_progress(progress, 0.2, "factorisation");
  if (settings.rotation != DetailRotation::None) {
    report.normal_radius = settings.normal_radius > 0 ? settings.normal_radius : automatic_normal_radius(region, world);
  }
  const bool factor_fits = fits_factor(before);
  const bool smoother_fits = fits_smoother(before);
  if (!factor_fits || (settings.rotation == DetailRotation::SmoothSurface && !smoother_fits)) {
    order = fill_reducing_ordering(region.neighbours, settings.threads);
  }
  // The smoothing asks nothing of the factor: with a second thread it comes for free.
  constexpr int kWorthAThread = 2000;
  const bool smooths = settings.rotation != DetailRotation::None;
  const bool apart =
      smooths && pool->threads() > 1 && region.size() >= kWorthAThread && !factorisations_share_threads();
  // Threads of its own: the factor's makers share the pool among themselves.
  ThreadPool(apart ? 2 : 1).each(smooths ? 2 : 1, [&](int part) {
    const Stopwatch own;
    if (part == 0) {
      factorise(factor_fits ? before : nullptr);
      report.factor_ms = own.elapsed();
    } else {
      smooth(smoother_fits ? before : nullptr);
      report.kernel_ms = own.elapsed();
    }
  });
  report_progress(progress, 0.6, "smoothing");
  if (smooths) {
    estimator = std::make_unique<RotationEstimator>(settings.rotation, region, *base.smoother);
  }
  watch.lap();
  make_preview();
  if (estimator && !preview) {
    turn_from(rest);  // else the first full solution does, which comes after many previews
  }
  report.kernel_ms += watch.lap();
  report_progress(progress, 0.9, "solve");

  order = std::vector<int>();
  report.mesh_vertices = region.mesh_vertices;
  report.handle = region.count(VertexClass::Handle);
  report.free = region.count(VertexClass::Free);
  report.anchors = region.count(VertexClass::Anchor);
  report.fixed = region.mesh_vertices - n;
  report.left_out = region.left_out;
  report.laplacian = name(settings.laplacian);
  report.order = settings.order;
  report.rotation = name(settings.rotation);
  report.backend = base.factor->backend_name();
  report.refinements = base.refinements;
  rotations.assign(n, Matrix3::Identity());
  // What preparing alone needed; the first solve makes what it needs.
  for (Points* used : {&constraint_rhs, &rhs, &d, &residual, &step, &rows}) {
    used->resize(0, 3);
  }
}

void LaplacianEditor::State::assemble(const TriangleMesh& mesh, State* before) {
  const bool same_graph = before && before->settings.laplacian == settings.laplacian &&
                          before->settings.order == settings.order &&
                          before->region.mesh_vertex == region.mesh_vertex &&
                          before->region.neighbours.values == region.neighbours.values &&
                          before->region.neighbours.offsets == region.neighbours.offsets;
  if (same_graph && settings.laplacian == LaplacianKind::Umbrella) {
    took_operator = true;
  } else {
    DifferentialOperator whole = differential_operator(settings.laplacian, region, mesh);
    base.uniform_edges = whole.uniform_edges;
    const SparseMatrix* const old = same_graph ? &before->first().matrix() : nullptr;
    if (old && old->nonZeros() == whole.matrix.nonZeros() && old->coeffs().matrix() == whole.matrix.coeffs().matrix()) {
      took_operator = true;
    } else if (settings.order > 1) {
      base.m = OperatorRows(power(whole.matrix, settings.order));
      base.first = OperatorRows(whole.matrix);
    } else {
      base.m = OperatorRows(whole.matrix);
    }
  }
  if (took_operator) {
    base.m.swap(before->base.m);
    base.first.swap(before->base.first);
    base.uniform_edges = before->base.uniform_edges;
  }
  report.uniform_edges = base.uniform_edges;
  first().apply(rest, delta, *pool);
  weigh();
}

/// Squared weights, of all and of those that the factor is to know. The anchors alone make the matrix definite; a small
/// handle is left to a correction of the solution then, so that the next one finds the factor ready.
void LaplacianEditor::State::weigh() {
  squared_weights.resize(region.size());
  base.weights.resize(region.size());
  const bool keep_out = all_anchored() && settings.order == 1 && region.count(VertexClass::Handle) <= kSmallHandle;
  for (int i = 0; i < region.size(); ++i) {
    const VertexClass c = region.classes[i];
    const double weight = c == VertexClass::Handle   ? settings.handle_weight
                          : c == VertexClass::Anchor ? settings.anchor_weight * region.anchor_weight[i]
                                                     : 0;
    squared_weights[i] = weight * weight;
    base.weights[i] = keep_out && c == VertexClass::Handle ? 0 : weight * weight;
    if (keep_out && c == VertexClass::Handle) {
      correction.rows.push_back(i);
    }
  }
}

void LaplacianEditor::State::make_factor(bool single_precision) {
  const SparseMatrix normal = base.m.normal_matrix(base.weights, *pool);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(normal.cols());
  for (int j = 0; j < normal.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(normal, j); it; ++it) {
      sums[j] += std::abs(it.value());
      sums[it.row()] += it.row() != j ? std::abs(it.value()) : 0;
    }
  }
  base.matrix_norm = sums.size() > 0 ? sums.maxCoeff() : 0;
  CholeskyOptions options;
  options.backend = settings.backend;
  options.single_precision = single_precision;
  options.pool = pool;
  options.order = order;
  base.factor = std::make_unique<SparseCholesky>(normal, options);
}

bool LaplacianEditor::State::fits_factor(const State* before) const {
  // A factor that had to be in double for another handle need not be for this one.
  return took_operator && before->base.factor && before->settings.backend == settings.backend &&
         before->base.weights == base.weights &&
         (settings.order > 1 || settings.backend == CholeskyBackend::Eigen || !has_cholmod() ||
          before->base.factor->single_precision());
}

bool LaplacianEditor::State::fits_smoother(const State* before) const {
  return before && before->base.smoother && before->settings.backend == settings.backend &&
         before->settings.rotation == DetailRotation::SmoothSurface &&
         settings.rotation == DetailRotation::SmoothSurface && before->settings.normal_radius == 0 &&
         settings.normal_radius == 0 && before->report.normal_radius == report.normal_radius &&
         before->region.mesh_vertex == region.mesh_vertex &&
         before->region.neighbours.offsets == region.neighbours.offsets &&
         before->region.neighbours.values == region.neighbours.values && before->world == world;
}

/// Makes the factor, or takes over the old one, and makes sure that solutions converge. The residual is taken through
/// M, not through M^T M, so refinement also mends the squaring of the condition number.
/// @param before  whose factor fits, or nothing
void LaplacianEditor::State::factorise(State* before) {
  if (before) {
    base.factor = std::move(before->base.factor);
    base.matrix_norm = before->base.matrix_norm;
    if (make_sure()) {
      report.factor_taken_over = true;
      return;
    }
    base.factor.reset();
  }
  // In single precision a solution has five digits; the steps that give it the others cost less than the memory.
  if (settings.order == 1) {
    make_factor(true);
    if (make_sure()) {
      return;
    }
  }
  if (!base.factor || base.factor->single_precision()) {
    base.factor.reset();
    make_factor(false);
    if (make_sure()) {
      return;
    }
  }
  refuse_conditioning();
}

/// Solves by iterative refinement until a step changes less than `accurate` of the solution, or as far as double goes.
/// @return how many steps that took; -1: it does not converge
template <class Solve>
int LaplacianEditor::State::refine(const Eigen::VectorXd& weights, const Points& right, Points& x, double accurate,
                                   const Solve& solve) {
  constexpr double kHopeless = 0.1, kGoodEnough = 1e-10;
  constexpr int kMostSteps = 8;
  solve(right, x);
  double last = 1;
  for (int count = 0;; ++count) {
    normal_product(weights, x, residual);
    residual = right - residual;
    solve(residual, step);
    const double change = last_change = largest_row(step) / largest_row(x);
    if (!(change > accurate) || (last < kGoodEnough && !(change < kHopeless * last))) {
      return std::isfinite(change) ? count : -1;
    }
    if (!(change < kHopeless * last) || count == kMostSteps) {
      return -1;
    }
    x += step;
    last = change;
    report_progress(go_on, 0, "solve");
  }
}

bool LaplacianEditor::State::make_sure() {
  return correction.rows.empty() ? find_refinements() : keep_handles_out();
}

/// Whether solutions are good, or get good, on a pull at the handles; for factors that need no correction.
bool LaplacianEditor::State::find_refinements() {
  rhs.setZero(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      rhs.row(i).setConstant(squared_weights[i]);
    }
  }
  const bool single = base.factor->single_precision();
  base.refinements = refine(squared_weights, rhs, d, kAccurate,
                            [this](const Points& right, Points& x) { base.factor->solve(right, x); });
  return base.refinements >= 0 && (!single || base.refinements <= kMostForSingle);
}

/// Columns of the inverse for handle vertices that the factor does not know. @return whether they could be had
bool LaplacianEditor::State::keep_handles_out() {
  const int count = static_cast<int>(correction.rows.size());
  if (count == 0) {
    return true;
  }
  const int n = region.size();
  correction.z.resize(n, count);
  Eigen::MatrixXd small(count, count);
  for (int first_column = 0; first_column < count; first_column += 3) {
    const int columns = std::min(3, count - first_column);
    rhs.setZero(n, 3);
    for (int c = 0; c < columns; ++c) {
      rhs(correction.rows[first_column + c], c) = 1;
    }
    const int steps = refine(base.weights, rhs, d, kAccurate,
                             [this](const Points& right, Points& x) { base.factor->solve(right, x); });
    if (steps < 0 || (base.factor->single_precision() && steps > kMostForSingle)) {
      return false;
    }
    correction.z.middleCols(first_column, columns) = d.leftCols(columns);
  }
  for (int c = 0; c < count; ++c) {
    small.row(c) = correction.z.row(correction.rows[c]);
    small(c, c) += 1 / squared_weights[correction.rows[c]];
    correction.weights.push_back(squared_weights[correction.rows[c]]);
  }
  correction.k = small.llt().solve(Eigen::MatrixXd::Identity(count, count));
  at_rows.resize(count, 3);
  return true;
}

/// A given radius means the paper's kernel. Where it is left to us and only a smooth surface is wanted, diffusion is as
/// good and does not cost more than the factor.
/// @param before  whose smoother fits, or nothing
void LaplacianEditor::State::smooth(State* before) {
  if (before) {
    base.smoother = std::move(before->base.smoother);
  } else if (settings.normal_radius > 0 || settings.rotation == DetailRotation::SmoothNormals) {
    base.smoother = std::make_unique<SmoothingKernel>(region, rest, report.normal_radius, settings.threads);
  } else {
    CholeskyOptions options;
    options.backend = settings.backend;
    options.order = order;
    base.smoother = std::make_unique<DiffusionSmoother>(region, world, report.normal_radius, options);
  }
  if (settings.rotation == DetailRotation::SmoothSurface && may_preview()) {
    base.smoother->apply_roughly(rest, base.smooth_rest);
    base.smooth_rest_is_exact = settings.normal_radius > 0;  // the kernel knows no rough way
  }
}

/// What moves for a unit of each column of each group's motion, linear part first.
Eigen::MatrixXd LaplacianEditor::State::find_responses() {
  const int n = region.size();
  const auto count = static_cast<Eigen::Index>(responses.size());
  Eigen::MatrixXd found(n, count);
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(n, count);  // of the handles
  for (std::size_t r = 0; r < responses.size(); ++r) {
    for (int i = 0; i < n; ++i) {
      if (region.group[i] == responses[r].group) {
        moved(i, static_cast<Eigen::Index>(r)) = responses[r].column < 3 ? rest(i, responses[r].column) : 1;
      }
    }
  }
  if (!correction.rows.empty()) {
    Eigen::MatrixXd at(static_cast<Eigen::Index>(correction.rows.size()), count);
    for (Eigen::Index c = 0; c < at.rows(); ++c) {
      at.row(c) = moved.row(correction.rows[c]);
    }
    found.noalias() = correction.z * (correction.k * at).eval();
    return found;
  }
  for (Eigen::Index r = 0; r < count; r += 3) {
    const Eigen::Index columns = std::min<Eigen::Index>(3, count - r);
    constraint_rhs.setZero(n, 3);
    constraint_rhs.leftCols(columns) = squared_weights.asDiagonal() * moved.middleCols(r, columns);
    refine(squared_weights, constraint_rhs, d, kAccurate,
           [this](const Points& right, Points& x) { solve_once(right, x); });
    found.middleCols(r, columns) = d.leftCols(columns);
  }
  return found;
}

bool LaplacianEditor::State::may_preview() const {
  return all_anchored() && settings.order == 1 && settings.iterations == 1 &&
         settings.rotation != DetailRotation::SmoothNormals;
}

void LaplacianEditor::State::make_preview() {
  if (!may_preview()) {
    return;
  }
  const int groups = 1 + *std::max_element(region.group.begin(), region.group.end());
  std::vector<int> sizes(groups, 0), member(groups, -1);
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      ++sizes[region.group[i]];
      member[region.group[i]] = i;
    }
  }
  for (int g = 0; g < groups; ++g) {
    for (int column = sizes[g] > 1 ? 0 : 3; column < 4; ++column) {
      responses.push_back({g, column, sizes[g] > 1 ? -1 : member[g]});
    }
  }
  if (static_cast<int>(responses.size()) > DragPreview::kMostResponses) {
    responses.clear();
    return;
  }
  const Eigen::MatrixXd found = find_responses();
  Eigen::MatrixXd smooth_found;
  PreviewBase parts;
  parts.region = &region;
  parts.world = &world;
  parts.delta = &delta;
  parts.first = &base.m;
  if (settings.rotation == DetailRotation::SmoothSurface) {
    parts.smooth_rest = &base.smooth_rest;
    smooth_found.resize(found.rows(), found.cols());
    Points in, out;
    for (Eigen::Index r = 0; r < found.cols(); r += 3) {
      const Eigen::Index columns = std::min<Eigen::Index>(3, found.cols() - r);
      in.setZero(found.rows(), 3);
      in.leftCols(columns) = found.middleCols(r, columns);
      base.smoother->apply_roughly(in, out);
      smooth_found.middleCols(r, columns) = out.leftCols(columns);
    }
  }
  preview = std::make_unique<DragPreview>(parts, found, smooth_found, correction, *base.factor, pool);
  motions.setZero(found.cols(), 3);
}

}  // namespace lapedit
