// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/template_energy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/deform/differential_operator.h"
#include "lapedit/mesh/surface_index.h"

namespace lapedit {
namespace {

void require_accurate(bool accurate) {
  if (!accurate) {
    throw EditError(ErrorCause::IllConditioned,
                    "The equations of the fit cannot be solved accurately: remove needles and tiny triangles of the "
                    "template, for example with MeshLab's filter \"Remeshing: Isotropic Explicit Remeshing\".");
  }
}

}  // namespace

TemplateEnergy::TemplateEnergy(const TriangleMesh& mesh, const Region& region, const Points& rest, double size,
                               double membrane, std::shared_ptr<ThreadPool> pool)
    : region_(region), rest_(rest), size_(size), pool_(std::move(pool)) {
  const int n = region.size();
  const CompressedRows& neighbours = region.neighbours;
  EdgeWeights weights = edge_weights(LaplacianKind::MeanValue, region, mesh, true);
  const DifferentialOperator whole = differential_operator(LaplacianKind::MeanValue, weights);
  weights_ = std::move(weights.values);
  mass_.setZero(n);
  const Eigen::VectorXd areas = face_areas(rest, region.faces);
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      mass_[region.faces(f, k)] += areas[f] / 3;
    }
  }
  mean_area_ = mass_.mean();
  constexpr double kLeast = 1e-3;  // of the mean; a vertex between needles would otherwise outweigh all others
  mass_ = (mass_ / mean_area_).cwiseMax(kLeast);
  // squares: h_i^2, the weighted mean of a vertex's squared edge lengths
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(n);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const double squared = (rest.row(i) - rest.row(neighbours.values[k])).squaredNorm();
      sum += squared;
      squares[i] += weights_[k] * squared;
    }
    squares[i] /= whole.divisor[i] > 0 ? whole.divisor[i] : 1;
  }
  const double mean_square = sum / static_cast<double>(std::max<std::size_t>(1, neighbours.values.size()));
  edge_length_ = std::sqrt(mean_square);
  squares = squares.cwiseMax(kLeast * mean_square);
  const Eigen::VectorXd scale = 4 * mass_.cwiseSqrt().cwiseQuotient(squares);
  double cost = 0;
  for (int i = 0; i < n; ++i) {
    cost += whole.divisor[i] > 0 ? 4 * mass_[i] / (squares[i] * whole.divisor[i]) : 0;
  }
  membrane_ = membrane / (size * size) * cost / n;
  rows_ = std::make_shared<const OperatorRows>(SparseMatrix(scale.asDiagonal() * whole.matrix),
                                               membrane_ * whole.divisor.cwiseQuotient(scale));
}

void TemplateEnergy::factor(double length, const Eigen::VectorXd& diagonal) {
  CholeskyOptions with;
  with.order = factor_ ? factor_->order() : fill_reducing_ordering(region_.neighbours, pool_->threads());
  with.pool = pool_;
  with.same_pattern = factor_.get();
  length4_ = length * length * length * length;
  diagonal_ = diagonal;
  factor_ = std::make_shared<SparseCholesky>(rows_->normal_matrix(diagonal / length4_, *pool_), with);
}

void TemplateEnergy::solve(const Points& right, Points& x) {
  factor_->solve(right, x);
  x /= length4_;
  require_accurate(x.allFinite());
}

void TemplateEnergy::solve_accurately(const Points& right, Points& x) {
  constexpr double kAccurate = 1e-12, kUseless = 1e-6;
  constexpr int kMostSteps = 20;
  solve(right, x);
  double change = 1;
  for (int count = 0; count < kMostSteps && !(change <= kAccurate); ++count) {
    Points left = right - diagonal_.asDiagonal() * x;
    subtract_gradient(x, left);
    factor_->solve(left, step_);
    x += step_ / length4_;
    change = step_.cwiseAbs().maxCoeff() / length4_;
  }
  require_accurate(x.allFinite() && change < kUseless * size_);
}

void TemplateEnergy::subtract_gradient(const Points& x, Points& right) {
  rows_->apply(x, between_, *pool_);
  rows_->apply_left_factor(between_, product_, *pool_);
  right -= length4_ * product_;
}

void TemplateEnergy::add_rotated(const std::vector<Matrix3>& rotations, double scale, Points& right) {
  constexpr int kPiece = 1024;
  const CompressedRows& neighbours = region_.neighbours;
  if (delta_.rows() == 0) {
    rows_->apply(rest_, delta_, *pool_);
  }
  // apply_left_factor() uses M^T + diag(stretch): subtract its membrane term, which rotates all edges of a vertex
  // alike.
  between_.resize(delta_.rows(), 3);
  for_indices(*pool_, region_.size(), kPiece,
              [&](int i) { between_.row(i) = (scale * (rotations[i] * delta_.row(i).transpose())).transpose(); });
  rows_->apply_left_factor(between_, product_, *pool_);
  for_indices(*pool_, region_.size(), kPiece, [&](int i) {
    Vector3 sum = Vector3::Zero(), unrotated = Vector3::Zero();
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const int j = neighbours.values[k];
      const Vector3 edge = weights_[k] * (rest_.row(i) - rest_.row(j)).transpose();
      sum += 0.5 * (rotations[i] * edge + rotations[j] * edge);
      unrotated += edge;
    }
    right.row(i) += length4_ * (product_.row(i) + membrane_ * scale * (sum - rotations[i] * unrotated).transpose());
  });
}

}  // namespace lapedit
