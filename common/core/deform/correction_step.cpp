// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/correction_step.h"

#include "lapedit/base/simd.h"

namespace lapedit {
namespace {

/// The fourth number is of no use.
LAPEDIT_INLINE Doubles4 rotated(const Matrix3& by, Doubles4 edge) {
  const double* const column = by.data();
  const auto last = load<Doubles4>(column + 5);
  return edge[0] * load<Doubles4>(column) + edge[1] * load<Doubles4>(column + 3) +
         edge[2] * shuffle<1, 2, 3, 0>(last, last);
}

}  // namespace

/// Computes y_i = sum_j -M_ij (((R_i + R_j) / 2 - I)(q_i - q_j) - (d_i - d_j)): the changes of rotated edges minus
/// those of the displacement. The rows of M have the sum 0. For a constant rotation (R_i + R_j) / 2 gives the paper's
/// (R - I) delta_i.
struct CorrectionStep::Edges {
  const OperatorRows::Rows& m;
  const Matrix3* rotations;
  bool by_vertex;  // R_i in place of (R_i + R_j) / 2
  const double *start, *displacement;
  double* out;

  LAPEDIT_INLINE void operator()(int i) const {
    const Doubles4 from = load3(start + 3 * std::ptrdiff_t{i}), moved = load3(displacement + 3 * std::ptrdiff_t{i});
    Doubles4 coordinate = {}, others = {}, current = {};
    for (int k = m.outerIndexPtr()[i]; k < m.outerIndexPtr()[i + 1]; ++k) {
      const int j = m.innerIndexPtr()[k];
      const double entry = m.valuePtr()[k];
      const Doubles4 edge = entry * (load3(start + 3 * std::ptrdiff_t{j}) - from);
      coordinate += edge;
      others += rotated(rotations[by_vertex ? i : j], edge);
      current += entry * (load3(displacement + 3 * std::ptrdiff_t{j}) - moved);
    }
    const Doubles4 left = 0.5 * (rotated(rotations[i], coordinate) + others) - coordinate - current;
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      out[3 * std::ptrdiff_t{i} + e] = left[e];
    }
  }
};

CorrectionStep::CorrectionStep(const LaplacianSystem& system)
    : system_(system), solver_(system.matrix, system.correction, system.pool), edges_(system.region.size(), 3) {
  for (int i = 0; i < system.region.size(); ++i) {
    if (system.squared_weights[i] > 0) {
      constrained_.push_back(i);
    }
  }
}

/// Adds the rows of links, s (t - e - (d_a - d_b)), where t is e = q_a - q_b rotated into the direction of
/// (R_a + R_b) e.
const Points& CorrectionStep::with_links(const EditConstraints& constraints, const std::vector<Matrix3>& rotations,
                                         const Points& displacement) {
  const Eigen::VectorXd& strengths = system_.powers.links;
  if (strengths.size() == 0) {
    return edges_;
  }
  const Eigen::Index n = edges_.rows();
  with_links_.resize(n + strengths.size(), 3);
  with_links_.topRows(n) = edges_;
  for (Eigen::Index k = 0; k < strengths.size(); ++k) {
    const auto [a, b] = system_.region.links[static_cast<std::size_t>(k)];
    const Vector3 edge = (constraints.start().row(a) - constraints.start().row(b)).transpose();
    Vector3 turned = (rotations[a] + rotations[b]) * edge;
    const double twice = turned.norm();
    turned *= twice > 0 ? edge.norm() / twice : 0;
    with_links_.row(n + k) = strengths[k] * ((turned - edge).transpose() - (displacement.row(a) - displacement.row(b)));
  }
  return with_links_;
}

/// For k > 1 the coordinates are rotated before M^(k-1) is applied. The result is not (M^k)^T (R - I) M^k p, the
/// rotated coordinates of order k, because the inverse of M^k amplifies their low-frequency errors. On the octopus
/// (16,554 vertices, order 2) the stretch is 49 %, not 485 %.
const Points& CorrectionStep::operator()(const EditConstraints& constraints, const std::vector<Matrix3>& rotations,
                                         const Points& displacement) {
  constexpr int kGrain = 1024;
  const LaplacianPowers& powers = system_.powers;
  const Edges edges = {powers.first->rows(),       rotations.data(),    system_.settings.method == EditMethod::Paper,
                       constraints.start().data(), displacement.data(), edges_.data()};
  in_pieces(*system_.pool, system_.region.size(), kGrain, [&](int first, int last) { run_kernel(edges, first, last); });
  for (int k = 1; k < system_.settings.order; ++k) {
    powers.first->apply(edges_, product_, *system_.pool);
    edges_.swap(product_);
  }
  powers.m->apply_left_factor(with_links(constraints, rotations, displacement), residual_, *system_.pool);
  for (const int i : constrained_) {
    residual_.row(i) += system_.squared_weights[i] * (constraints.wanted().row(i) - displacement.row(i));
  }
  solver_.solve(residual_, step_);
  return step_;
}

}  // namespace lapedit
