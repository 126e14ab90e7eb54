// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/template_energy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/deform/differential_operator.h"

namespace lapedit {
namespace {

constexpr double kMembrane = 0.5;  // stretching against bending at wavelengths of the template's size
}  // namespace

TemplateEnergy::TemplateEnergy(const TriangleMesh& mesh, const Region& region, const Points& rest, double size,
                               const SolverOptions& options, std::shared_ptr<ThreadPool> pool)
    : region_(region), rest_(rest), pool_(std::move(pool)), options_(options) {
  const int n = region.size();
  const IndexLists& neighbours = region.neighbours;
  const DifferentialOperator whole = differential_operator(LaplacianKind::MeanValue, region, mesh, true);
  weights_ = edge_weights(LaplacianKind::MeanValue, region, mesh, true, pool_.get()).values;
  mass_.setZero(n);
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    const Vector3 a = rest.row(region.faces(f, 0)).transpose();
    const Vector3 ab = rest.row(region.faces(f, 1)).transpose() - a, ac = rest.row(region.faces(f, 2)).transpose() - a;
    for (int k = 0; k < 3; ++k) {
      mass_[region.faces(f, k)] += ab.cross(ac).norm() / 6;
    }
  }
  mean_area_ = mass_.mean();
  constexpr double kLeastMass = 1e-3;
  mass_ = (mass_ / mean_area_).cwiseMax(kLeastMass);
  // h_i^2, bounded since a vertex between needles would outweigh all others.
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(n);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const double squared = (rest.row(i) - rest.row(neighbours.values[k])).squaredNorm();
      sum += squared;
      squares[i] += weights_[k] * squared;
    }
    squares[i] /= whole.sums[i] > 0 ? whole.sums[i] : 1;
  }
  const double mean_square = sum / static_cast<double>(std::max<std::size_t>(1, neighbours.values.size()));
  edge_length_ = std::sqrt(mean_square);
  constexpr double kLeastSquare = 1e-3;
  squares = squares.cwiseMax(kLeastSquare * mean_square);

  SparseMatrix scaled = whole.matrix;
  Eigen::VectorXd scale(n), stretch(n);
  double cost = 0;
  for (int i = 0; i < n; ++i) {
    scale[i] = std::sqrt(mass_[i]) * 4 / squares[i];
    cost += whole.sums[i] > 0 ? 4 * mass_[i] / (squares[i] * whole.sums[i]) : 0;
  }
  membrane_ = kMembrane / (size * size) * cost / n;
  scaled = scale.asDiagonal() * scaled;
  for (int i = 0; i < n; ++i) {
    stretch[i] = membrane_ * whole.sums[i] / scale[i];
  }
  rows_ = std::make_shared<const OperatorRows>(scaled, stretch);
  order_ = fill_reducing_ordering(neighbours, options.threads);
}

void TemplateEnergy::factor(double length, const Eigen::VectorXd& diagonal) {
  CholeskyOptions with;
  with.backend = options_.backend;
  with.order = order_;
  with.pool = pool_;
  with.same_pattern = matrix_ ? &matrix_->cholesky : nullptr;
  length4_ = length * length * length * length;
  solver_.reset();
  matrix_ = std::make_shared<const FactoredNormalMatrix>(rows_, Eigen::VectorXd(diagonal / length4_), with);
  solver_ = std::make_unique<RefinedSolver>(matrix_, nullptr, pool_);
}

void TemplateEnergy::solve(Points& right, Points& x, const Progress& progress) {
  right /= length4_;
  const Refinement refined = solver_->refine_to_the_bit(right, x, progress);
  if (!x.allFinite() || !refined.converged()) {
    throw EditError(ErrorCause::IllConditioned,
                    "The equations of the fit cannot be solved accurately: remove needles and tiny triangles of the "
                    "template, for example with MeshLab's filter \"Remeshing: Isotropic Explicit Remeshing\".");
  }
}

void TemplateEnergy::rotated(const std::vector<Matrix3>& rotations, double scale, Points& right) {
  constexpr int kPiece = 1024;
  const IndexLists& neighbours = region_.neighbours;
  if (delta_.rows() == 0) {
    rows_->apply(rest_, delta_, *pool_);
  }
  // M^T also has the stretch on its diagonal, so the membrane of unrotated coordinates is taken out again.
  turned_.resize(delta_.rows(), 3);
  for_indices(*pool_, region_.size(), kPiece,
              [&](int i) { turned_.row(i) = (scale * (rotations[i] * delta_.row(i).transpose())).transpose(); });
  rows_->apply_transposed(turned_, right, *pool_);
  for_indices(*pool_, region_.size(), kPiece, [&](int i) {
    Vector3 sum = Vector3::Zero(), unrotated = Vector3::Zero();
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const int j = neighbours.values[k];
      const Vector3 edge = weights_[k] * (rest_.row(i) - rest_.row(j)).transpose();
      sum += 0.5 * (rotations[i] * edge + rotations[j] * edge);
      unrotated += edge;
    }
    right.row(i) += membrane_ * scale * (sum - rotations[i] * unrotated).transpose();
  });
  right *= length4_;
}

}  // namespace lapedit
