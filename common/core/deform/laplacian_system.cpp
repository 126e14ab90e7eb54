// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/laplacian_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "lapedit/base/refuse.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/deform/differential_operator.h"
#include "lapedit/deform/smooth_normals.h"
#include "lapedit/linear/linear.h"

namespace lapedit {
namespace {

/// If refinement needs more steps to reach kAccurate, a factor in double precision replaces that in single precision.
constexpr int kMostForSingle = 3;
/// The factor may omit handles of at most this many vertices.
constexpr int kSmallHandle = 8;
/// Vertices times the order squared, beyond which a factor of higher order takes long: refuse_the_hopeless() checks
/// first.
constexpr double kLongFactor = 180000;

bool same_graph(const Region& a, const Region& b) {
  return a.mesh_vertex == b.mesh_vertex && a.neighbours.values == b.neighbours.values &&
         a.neighbours.offsets == b.neighbours.offsets && a.links == b.links;
}

/// Returns the graph of an operator.
CompressedRows graph_of(const OperatorRows::Rows& rows) {
  CompressedRows graph;
  graph.values.reserve(static_cast<std::size_t>(rows.nonZeros()));
  for (int i = 0; i < rows.rows(); ++i) {
    for (OperatorRows::Rows::InnerIterator entry(rows, i); entry; ++entry) {
      if (entry.col() != i) {
        graph.values.push_back(static_cast<int>(entry.col()));
      }
    }
    graph.offsets.push_back(static_cast<int>(graph.values.size()));
  }
  return graph;
}

bool same_pattern(const OperatorRows::Rows& a, const OperatorRows::Rows& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.rows(), b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

/// Returns the strength s of each of the region's links. A link holds two pieces together by a row s (x_a - x_b) = s t
/// below those of M^k. Here t is e = p_a - p_b rotated into the direction of (R_a + R_b) e. The rows of M^k leave
/// residuals of some tenths of an edge h, which change a link of length g by about as much over s^2. So s^2 = 1000
/// max(1, h / g), at most 10000, keeps the length of the link within a few hundredths. For higher orders the factor is
/// 100 instead of 1000.
/// @param rest  size() x 3
Eigen::VectorXd link_strengths(const Region& region, const Points& rest, int order) {
  const double strength = order == 1 ? 1000 : 100;  // squared; matrices of higher orders are ill-conditioned anyway
  constexpr double kMost = 1e4;
  const auto is_link = [&region](int i, int j) {
    return std::binary_search(region.links.begin(), region.links.end(), std::pair(std::min(i, j), std::max(i, j)));
  };
  Eigen::VectorXd strengths(static_cast<Eigen::Index>(region.links.size()));
  for (Eigen::Index k = 0; k < strengths.size(); ++k) {
    const auto [a, b] = region.links[static_cast<std::size_t>(k)];
    double edges = 0;
    int count = 0;
    for (const int end : {a, b}) {
      for (const int j : region.neighbours[end]) {
        if (!is_link(end, j)) {
          edges += (rest.row(end) - rest.row(j)).norm();
          ++count;
        }
      }
    }
    const double gap = (rest.row(a) - rest.row(b)).norm();
    const double ratio = count > 0 && gap * kMost > edges / count * strength ? edges / count / gap : kMost;
    strengths[k] = std::sqrt(std::clamp(strength * ratio, strength, kMost));
  }
  return strengths;
}

/// Returns the matrix with the rows of links below its own. @param strengths  if empty, the result is the matrix itself
SparseMatrix with_link_rows(const SparseMatrix& matrix, const Region& region, const Eigen::VectorXd& strengths) {
  if (strengths.size() == 0) {
    return matrix;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(matrix.nonZeros() + 2 * strengths.size()));
  for (int j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      entries.emplace_back(static_cast<int>(entry.row()), j, entry.value());
    }
  }
  const auto n = static_cast<int>(matrix.rows());
  for (int k = 0; k < static_cast<int>(strengths.size()); ++k) {
    const auto [a, b] = region.links[static_cast<std::size_t>(k)];
    entries.emplace_back(n + k, a, strengths[k]);
    entries.emplace_back(n + k, b, -strengths[k]);
  }
  SparseMatrix all(n + strengths.size(), matrix.cols());
  all.setFromTriplets(entries.begin(), entries.end());
  return all;
}

/// Prepares the operator, factor and kernel of a system, or reuses those of the previous one.
class Preparation {
 public:
  Preparation(LaplacianSystem& system, const LaplacianSystem* previous) : s_(system), previous_(previous) {}

  void make_operator(const TriangleMesh& mesh, const std::vector<Matrix3>* metric);
  void weigh();
  /// Makes the factor and, on a second thread where that is faster, the smoothing kernel for the rotations of Lipman et
  /// al. 2004.
  void make_factor_and_kernel();
  void make_fair_surface();

 private:
  bool is_sharp() const;
  bool factor_fits() const;
  void factorise(bool reuse);
  void refuse_the_hopeless() const;
  CholeskyOptions cholesky_options(bool single_precision) const;
  void make_factor(bool single_precision);
  bool same_handles() const;
  bool make_sure();
  void make_kernel();

  LaplacianSystem& s_;
  const LaplacianSystem* previous_;
  bool operator_reused_ = false;
  Eigen::VectorXd factor_weights_;  // w_i^2 of the constraints in the factor
  WoodburyCorrection kept_out_;     // rows and weights of the other constraints
  bool order_reused_ = false;
};

/// Computes M (Lipman et al. 2004, section 3), and M^k with its membrane.
void Preparation::make_operator(const TriangleMesh& mesh, const std::vector<Matrix3>* metric) {
  const EditSettings& settings = s_.settings;
  refuse_fans(s_.region, settings.order, settings.order == 1 ? kLongRow : std::numeric_limits<int>::max());
  const bool membrane = settings.membrane > 0;
  const bool same = previous_ && previous_->settings.laplacian == settings.laplacian &&
                    previous_->settings.order == settings.order && previous_->settings.membrane == settings.membrane &&
                    same_graph(previous_->region, s_.region);
  if (same && settings.laplacian == LaplacianKind::Umbrella && !membrane && s_.region.links.empty()) {
    operator_reused_ = true;
  } else {
    const DifferentialOperator whole = differential_operator(settings.laplacian, s_.region, mesh, membrane, metric);
    Eigen::VectorXd stretch;
    if (membrane) {
      // The bits depend neither on handles nor on the origin.
      const Points from_first = s_.rest.world.rowwise() - s_.rest.world.row(0);
      stretch = membrane_factor(settings.membrane, s_.region, from_first, whole.mean) * whole.divisor;
    }
    Eigen::VectorXd links = link_strengths(s_.region, s_.rest.world, settings.order);
    checkpoint();
    if (same) {
      const OperatorRows::Rows rows(whole.matrix);
      const OperatorRows::Rows& old = previous_->powers.first->rows();
      operator_reused_ = old.nonZeros() == rows.nonZeros() && old.coeffs().matrix() == rows.coeffs().matrix() &&
                         previous_->powers.stretch == stretch && previous_->powers.links == links;
    }
    if (!operator_reused_) {
      LaplacianPowers& powers = s_.powers;
      powers.m = std::make_shared<const OperatorRows>(
          with_link_rows(power(whole.matrix, settings.order), s_.region, links), stretch);
      checkpoint();
      powers.first =
          settings.order == 1 && links.size() == 0 ? powers.m : std::make_shared<const OperatorRows>(whole.matrix);
      powers.divisor = whole.divisor;
      powers.stretch = std::move(stretch);
      powers.links = std::move(links);
    }
  }
  if (operator_reused_) {
    s_.powers = previous_->powers;
  }
}

/// Computes squared weights w_i^2 (Lipman et al. 2004, sections 3 and 5): w times its factor for a handle, and w d_i /
/// d_max for an anchor. If the anchors alone make the matrix positive definite, the factor omits a small handle and a
/// correction of the solution adds it, so that the next handle can reuse the factor.
void Preparation::weigh() {
  const Region& region = s_.region;
  s_.squared_weights.resize(region.size());
  factor_weights_.resize(region.size());
  const bool keep_out =
      s_.all_anchored() && s_.settings.order == 1 && region.count(VertexClass::Handle) <= kSmallHandle;
  for (int i = 0; i < region.size(); ++i) {
    const VertexClass c = region.classes[i];
    const double weight = c == VertexClass::Handle   ? s_.settings.handle_weight * region.weight(i)
                          : c == VertexClass::Anchor ? s_.settings.anchor_weight * region.anchor_weight[i]
                                                     : 0;
    s_.squared_weights[i] = factor_weights_[i] = weight * weight;
    if (keep_out && c == VertexClass::Handle) {
      factor_weights_[i] = 0;
      kept_out_.rows.push_back(i);
      kept_out_.weights.push_back(weight * weight);
    }
  }
}

/// Returns whether slivers make the condition number, which grows with the squared diagonal of M, too large for a
/// factor in single precision. Operators other than LaplacianKind::Surface have the diagonal 1.
bool Preparation::is_sharp() const {
  constexpr double kSharp = 10;
  const OperatorRows::Rows& rows = s_.powers.first->rows();
  return s_.settings.laplacian == LaplacianKind::Surface && rows.diagonal().maxCoeff() > kSharp;
}

bool Preparation::factor_fits() const {
  // A factor that had to be in double precision for another handle may be in single precision for this one.
  return operator_reused_ && previous_->matrix->squared_weights == factor_weights_ &&
         (s_.settings.order > 1 || is_sharp() || previous_->matrix->cholesky.single_precision());
}

void Preparation::make_factor_and_kernel() {
  const bool reuse = factor_fits();
  if (reuse) {
    s_.order = previous_->order;
  } else {
    order_reused_ =
        previous_ && previous_->order && same_pattern(previous_->powers.first->rows(), s_.powers.first->rows());
    s_.order = order_reused_ ? previous_->order
                             : std::make_shared<const std::vector<int>>(
                                   fill_reducing_ordering(graph_of(s_.powers.first->rows()), s_.options.threads));
  }
  constexpr int kWorthAThread = 2000;
  const bool has_kernel = s_.settings.method == EditMethod::Paper;
  const bool apart = has_kernel && s_.pool->threads() > 1 && s_.region.size() >= kWorthAThread;
  // This pool is separate, since the factorisation uses the threads of s_.pool.
  ThreadPool(apart ? 2 : 1).each(has_kernel ? 2 : 1, [&](int k) {
    if (k == 0) {
      const Stopwatch watch;
      factorise(reuse);
      s_.factor_ms = watch.elapsed();
    } else {
      make_kernel();
    }
  });
}

/// Makes the factor, or reuses the old one, and checks that solutions converge.
void Preparation::factorise(bool reuse) {
  if (reuse) {
    s_.matrix = previous_->matrix;
    if (same_handles()) {
      s_.correction = previous_->correction;
      return;
    }
    if (make_sure()) {
      return;
    }
  }
  refuse_the_hopeless();
  // In single precision a solution has five digits; refining it costs less than the memory of a factor in double
  // precision.
  for (const bool single_precision : {true, false}) {
    if (single_precision && (s_.settings.order > 1 || is_sharp())) {
      continue;
    }
    make_factor(single_precision);
    if (make_sure()) {
      return;
    }
  }
  refuse_conditioning(s_);
}

/// Let l be the smallest eigenvalue of the positive definite matrix of order 1, s = l^(k/2) that of the operator of
/// order k, c the membrane's weight and u the unit roundoff. No eigenvalue of the matrix of order k is below about s^2
/// + c s, but the smallest one can be much above this bound: refinement converged on meshes with u up to 2,400 s^2, and
/// failed on one with 31 s^2. So only matrices far beyond all that converged are refused. The test costs a factor of
/// order 1, a small fraction of the cost of order k.
void Preparation::refuse_the_hopeless() const {
  constexpr double kUnitRoundoff = 0x1p-53, kHopeless = 1e4, kHopelessMembrane = 20;
  constexpr int kIterations = 6;
  const int order = s_.settings.order;
  if (order == 1 || s_.region.size() * static_cast<double>(order * order) < kLongFactor) {
    return;
  }
  std::optional<FactoredNormalMatrix> first;
  factorise_for(s_.region, [&] { first.emplace(s_.powers.first, factor_weights_, cholesky_options(false)); });
  Points vector = Points::Ones(s_.region.size(), 3), next;
  double smallest = 0;  // from above, by inverse iterations
  for (int k = 0; k < kIterations; ++k) {
    vector /= vector.norm();
    first->cholesky.solve(vector, next);
    smallest = 1 / next.norm();
    vector.swap(next);
  }
  const double bending = std::pow(smallest, 0.5 * order);
  const double membrane = s_.powers.stretch.size() > 0 ? s_.powers.stretch.mean() : 0;
  if (!(kUnitRoundoff < bending * (kHopeless * bending + kHopelessMembrane * membrane))) {
    refuse_conditioning(s_);
  }
}

CholeskyOptions Preparation::cholesky_options(bool single_precision) const {
  CholeskyOptions options;
  options.single_precision = single_precision;
  options.pool = s_.pool;
  options.order = *s_.order;
  return options;
}

void Preparation::make_factor(bool single_precision) {
  s_.matrix.reset();  // frees the old factor first, so that two never exist at once
  CholeskyOptions options = cholesky_options(single_precision);
  if (order_reused_ && previous_->settings.order == s_.settings.order &&
      same_pattern(previous_->powers.m->rows(), s_.powers.m->rows())) {
    options.same_pattern = &previous_->matrix->cholesky;
  }
  factorise_for(s_.region, [&] {
    s_.matrix = std::make_shared<const FactoredNormalMatrix>(s_.powers.m, factor_weights_, options);
  });
}

/// Returns whether the handles are those for which the previous system was checked.
bool Preparation::same_handles() const {
  return previous_->region.classes == s_.region.classes && previous_->squared_weights == s_.squared_weights;
}

/// Returns whether solutions converge in the number of steps that the factor's precision allows: the solutions of the
/// handles' correction, or else that of a displacement of the handles.
bool Preparation::make_sure() {
  RefinedSolver solver(s_.matrix, nullptr, s_.pool);
  const int most_steps = s_.matrix->cholesky.single_precision() ? kMostForSingle : std::numeric_limits<int>::max();
  if (!kept_out_.rows.empty() || !s_.matrix->long_rows.empty()) {
    auto found =
        woodbury_correction(solver, s_.region.size(), kept_out_.rows, kept_out_.weights, kAccurate, most_steps);
    s_.correction = found ? std::make_shared<const WoodburyCorrection>(std::move(*found)) : nullptr;
    return found.has_value();
  }
  const bool has_handle = s_.region.count(VertexClass::Handle) > 0;
  Points right = Points::Zero(s_.region.size(), 3), x;
  for (int i = 0; i < s_.region.size(); ++i) {
    if (s_.region.classes[i] == (has_handle ? VertexClass::Handle : VertexClass::Anchor)) {
      right.row(i).setConstant(s_.squared_weights[i]);
    }
  }
  const int steps = solver.refine_to(right, x, kAccurate);
  return steps >= 0 && steps <= most_steps;
}

/// Makes the kernel that smooths normals (Lipman et al. 2004, section 6).
void Preparation::make_kernel() {
  const EditSettings& settings = s_.settings;
  s_.normal_radius =
      settings.normal_radius > 0 ? settings.normal_radius : automatic_normal_radius(s_.region, s_.rest.world);
  s_.kernel = std::make_unique<const SmoothingKernel>(s_.region, s_.rest.local, s_.normal_radius, s_.options.threads);
  if (settings.rough == RoughDeformation::Falloff) {
    s_.falloff = geodesic_falloff(s_.region, s_.rest.local);
  }
}

void Preparation::make_fair_surface() {
  if (previous_ && previous_->fair && operator_reused_ && same_handles() && previous_->rest.world == s_.rest.world) {
    s_.fair = previous_->fair;
  } else if (s_.settings.detail != 1) {
    s_.fair = std::make_shared<const Points>(fair_displacement(s_));
  }
}

}  // namespace

bool LaplacianSystem::all_anchored() const {
  return std::all_of(region.anchored.begin(), region.anchored.end(), [](char anchored) { return anchored; });
}

std::shared_ptr<const LaplacianSystem> prepare_system(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest,
                                                      const EditSettings& settings, const SolverOptions& options,
                                                      const LaplacianSystem* previous,
                                                      const std::vector<Matrix3>* metric) {
  const auto made = std::make_shared<LaplacianSystem>(std::move(rest), settings, options);
  made->pool = previous && previous->options.threads == options.threads ? previous->pool
                                                                        : std::make_shared<ThreadPool>(options.threads);
  Preparation preparation(*made, previous);
  const Stopwatch watch;
  report_progress(0.1, "operator");
  preparation.make_operator(mesh, metric);
  preparation.weigh();
  made->operator_ms = watch.elapsed();
  report_progress(0.2, "factorisation");
  preparation.make_factor_and_kernel();
  preparation.make_fair_surface();
  return made;
}

void require_finite_result(const Points& positions) {
  if (!positions.allFinite()) {
    refuse_edit(ErrorCause::NotFinite, {},
                "The result is not finite, since the handle's displacement is too large for the mesh: move it less.");
  }
}

void refuse_conditioning(const LaplacianSystem& system) {
  const int order = system.settings.order;
  const std::string advice = order > 1 ? "a lower order or a smaller region." : "a smaller region or larger weights.";
  refuse_edit(ErrorCause::IllConditioned, {}, "A Laplacian of order ", order, " over ", system.region.size(),
              " region vertices is too ill-conditioned to be solved in double precision: use ", advice);
}

void factorise_for(const Region& region, const std::function<void()>& factorise) {
  try {
    factorise();
  } catch (const EditError& error) {
    if (error.cause() != ErrorCause::IllConditioned) {
      throw;
    }
    refuse_edit(ErrorCause::IllConditioned, {}, "The system of ", region.size(),
                " region vertices is singular to working precision: use a lower order, a smaller region, more "
                "padding or weights nearer to 1.");
  }
}

}  // namespace lapedit
