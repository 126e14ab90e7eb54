// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/laplacian_editor.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <future>
#include <limits>
#include <sstream>

#include "lapedit/accurate_residual.h"
#include "lapedit/diffusion.h"
#include "lapedit/drag_preview.h"
#include "lapedit/elimination_order.h"
#include "lapedit/error.h"
#include "lapedit/operator_rows.h"

namespace lapedit {
namespace {

using Clock = std::chrono::steady_clock;

/// Milliseconds since the last call.
class Stopwatch {
 public:
  double lap() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

void require(bool holds, const char* setting, double value, const char* range) {
  if (!holds) {
    std::ostringstream sentence;
    sentence << "The " << setting << " is " << value << ": give " << range << ".";
    throw EditError(ErrorCause::BadParameter, sentence.str());
  }
}

double largest_row(const Points& points) {
  return points.rows() > 0 ? points.rowwise().norm().maxCoeff() : 0;
}

Matrix3 nearest_rotation_of(const Matrix3& linear) {
  const Eigen::JacobiSVD<Matrix3> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3 rotation = svd.matrixU() * svd.matrixV().transpose();
  return rotation.determinant() > 0 ? rotation : Matrix3::Identity();
}

/// A map as "minus identity", about a local origin: keeps a translation of a far-away mesh exact.
struct Motion {
  Matrix3 linear = Matrix3::Zero();       ///< L - I
  Vector3 translation = Vector3::Zero();  ///< displacement of the local origin

  static Motion of(const Affine& map, const Vector3& origin) {
    Motion motion;
    motion.linear = map.linear() - Matrix3::Identity();
    motion.translation = motion.linear * origin + map.translation();
    return motion;
  }
  Vector3 displacement(const Vector3& local) const { return linear * local + translation; }
  bool none() const { return linear.isZero(0) && translation.isZero(0); }
};

}  // namespace

void validate(const EditSettings& settings) {
  require(settings.order >= 1 && settings.order <= 3, "order of the Laplacian", settings.order, "1, 2 or 3");
  require(settings.iterations >= 1 && settings.iterations <= 100, "number of iterations", settings.iterations,
          "a whole number from 1 to 100");
  require(settings.normal_radius >= 0 && std::isfinite(settings.normal_radius), "normal radius", settings.normal_radius,
          "a finite length, or 0 for an automatic one");
  for (const auto& [weight, name] :
       {std::pair{settings.handle_weight, "handle weight"}, std::pair{settings.anchor_weight, "anchor weight"}}) {
    require(weight >= 1e-6 && weight <= 1e6, name, weight, "a number from 0.000001 to 1000000");
  }
}

namespace {

/// What an edit owes to the region, its anchors and the settings alone: another handle can go on with it.
struct Foundation {
  OperatorRows m;      // the operator, M^k
  OperatorRows first;  // M_1, the operator of order 1; empty if m is it
  int uniform_edges = 0;
  Eigen::VectorXd weights;  // w_i^2 of those that the factor knows
  double matrix_norm = 0;   // of the factor's matrix
  std::unique_ptr<SparseCholesky> factor;
  int refinements = 0;
  std::unique_ptr<Smoother> smoother;
  Points smooth_rest;
};

/// Something that the unrotated result depends on linearly.
struct Response {
  int group;
  int column;  // of the group's motion about the origin; 3: its translation
  int vertex;  // local, of a group that is one vertex and has but one response, its way; else -1
};

/// Enough for what is to be refined further, and for previews.
constexpr double kAccurate = 1e-8;
/// If it takes more steps to get there, a factor in single precision is not worth its memory.
constexpr int kMostForSingle = 3;
/// Handles of at most so many vertices are kept out of the factor.
constexpr int kSmallHandle = 8;

}  // namespace

struct LaplacianEditor::State {
  Region region;
  EditSettings settings;
  EditReport report;
  std::shared_ptr<Crew> crew;
  Foundation base;
  bool took_operator = false;  // from another editor
  std::vector<int> order;      // of elimination, while preparing

  Vector3 origin = Vector3::Zero();    // the first handle vertex: coordinates below are relative to it
  Points world;                        // rest pose as given
  Points rest;                         // rest pose about the origin
  Points delta;                        // M_1 rest
  Eigen::VectorXd squared_weights;     // w_i^2 of handles and anchors, 0 for free vertices
  DragPreview::Correction correction;  // of the factor, for handles that were kept out of it
  std::unique_ptr<RotationEstimator> estimator;
  std::unique_ptr<DragPreview> preview;
  std::vector<Response> responses;  // of the preview

  // Of the last solve.
  std::vector<Motion> targets;            // per handle group
  std::vector<Motion> carried;            // per component: where it is carried before anything else
  std::vector<Matrix3> carried_rotation;  // per component
  std::vector<int> handles_seen;          // per component without anchors
  bool is_carried = false;
  bool estimator_at_rest = false;
  Points carried_pose;  // empty unless something is carried
  Points constraint_rhs, rhs, d, previous, residual, step, rows, positions;
  Points motions, at_rows, corrected;
  DoubledPoints doubled, between;
  Progress go_on;          // of the solve at work
  double last_change = 0;  // of the last step of refinement, over the solution
  std::vector<Matrix3> rotations;

  bool all_anchored() const {
    return std::all_of(region.anchored.begin(), region.anchored.end(), [](char anchored) { return anchored; });
  }
  const OperatorRows& first() const { return settings.order == 1 ? base.m : base.first; }
  void set_up(const TriangleMesh& mesh, const Progress& progress, State* before);
  void assemble(const TriangleMesh& mesh, State* before);
  void weigh();
  bool fits_factor(const State* before) const;
  bool fits_smoother(const State* before) const;
  void factorise(State* before);
  void make_factor(bool single_precision);
  template <class Solve>
  int refine(const Eigen::VectorXd& weights, const Points& right, Points& x, double accurate, const Solve& solve);
  bool make_sure();
  [[noreturn]] void refuse_conditioning() const;
  bool find_refinements();
  bool keep_handles_out();
  void smooth(State* before);
  void turn_from(const Points& pose);
  void make_preview();
  Eigen::MatrixXd find_responses();
  void carry_components(const std::vector<Affine>& handles, const Affine& anchors);
  bool set_constraints();
  void normal_product(const Eigen::VectorXd& weights, const Points& x, Points& out);
  void solve_once(const Points& right, Points& x);
  void solve_exactly(const Points& right, Points& x);
  void rotate_deltas();
  void collect_positions();
  void check(const std::vector<Affine>& handles) const;
};

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

  crew =
      before && before->settings.threads == settings.threads ? before->crew : std::make_shared<Crew>(settings.threads);
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
    order = elimination_order(region.neighbours, settings.threads);
  }
  // The smoothing asks nothing of the factor: with a second thread it comes for free.
  std::future<double> smoothing;
  const auto smooth_timed = [this, from = smoother_fits ? before : nullptr] {
    Stopwatch own;
    smooth(from);
    return own.lap();
  };
  if (settings.rotation != DetailRotation::None) {
    constexpr int kWorthAThread = 2000;
    const bool apart = crew->threads() > 1 && region.size() >= kWorthAThread && !factorisations_share_threads();
    smoothing = std::async(apart ? std::launch::async : std::launch::deferred, smooth_timed);
  }
  watch.lap();
  factorise(factor_fits ? before : nullptr);
  report.factor_ms = watch.lap();
  if (smoothing.valid()) {
    report_progress(progress, 0.6, "smoothing");
    report.kernel_ms = smoothing.get();
    estimator = std::make_unique<RotationEstimator>(settings.rotation, region, *base.smoother);
    turn_from(rest);
    estimator_at_rest = true;
  }
  watch.lap();
  make_preview();
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
  first().apply(rest, delta, *crew);
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
  const SparseMatrix normal = base.m.normal_matrix(base.weights, *crew);
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
  options.crew = crew;
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

void LaplacianEditor::State::refuse_conditioning() const {
  throw EditError(ErrorCause::IllConditioned,
                  "A Laplacian of order " + std::to_string(settings.order) + " over " + std::to_string(region.size()) +
                      " region vertices is too ill-conditioned to be solved in double precision: use a lower order or "
                      "a smaller region.");
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
  if (settings.rotation == DetailRotation::SmoothSurface) {
    base.smoother->apply(rest, base.smooth_rest);
  }
}

/// Sets the pose that rotations are measured from.
void LaplacianEditor::State::turn_from(const Points& pose) {
  if (settings.rotation == DetailRotation::SmoothSurface && &pose == &rest) {
    estimator->set_before_smoothed(base.smooth_rest);
  } else {
    estimator->set_before(pose);
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

void LaplacianEditor::State::make_preview() {
  if (!all_anchored() || settings.order != 1 || settings.iterations != 1 ||
      settings.rotation == DetailRotation::SmoothNormals) {
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
  preview = std::make_unique<DragPreview>(parts, found, smooth_found, correction, *base.factor, crew);
  motions.setZero(found.cols(), 3);
}

/// out = (M^T M + W^2) x
void LaplacianEditor::State::normal_product(const Eigen::VectorXd& weights, const Points& x, Points& out) {
  base.m.apply(x, rows, *crew);
  base.m.apply_transposed(rows, out, *crew);
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
        normal_residual(base.m, squared_weights, right, at, between, out, *crew);
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
    first().apply(rows, residual, *crew);
    rows.swap(residual);
  }
  base.m.apply_transposed(rows, rhs, *crew);
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
      s.estimator_at_rest = !s.is_carried;
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
    const Response& response = s.responses[r];
    const Motion motion = Motion::of(handles[response.group], s.origin);
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
