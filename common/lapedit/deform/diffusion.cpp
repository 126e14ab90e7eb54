// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/diffusion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lapedit {
namespace {

/// Second moment of 2 t^3/r^3 - 3 t^2/r^2 + 1 over the disc, over r^2.
constexpr double kMoment = 5.0 / 21;
constexpr int kSteps = 2;

}  // namespace

DiffusionSmoother::DiffusionSmoother(const Region& region, const Points& rest, double radius,
                                     const CholeskyOptions& options)
    : pool_(options.pool ? options.pool : std::make_shared<ThreadPool>(1)) {
  const IndexLists& neighbours = region.neighbours;
  const int n = region.size();
  std::vector<double> squared(neighbours.values.size());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  // area_i = sum_j |e_ij|^2 / 4, and c_ij = mean area / sqrt(area_i area_j).
  for (int i = 0; i < n; ++i) {
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      squared[k] = (rest.row(neighbours.values[k]) - rest.row(i)).squaredNorm();
      area[i] += 0.25 * squared[k];
    }
  }
  // Vertices with edges of zero length get a small area, so that the matrix is definite and well scaled.
  constexpr double kSmall = 1e-3, kLeast = 1e-9;
  const double mean = n > 0 ? std::accumulate(area.begin(), area.end(), 0.0) / n : 0;
  const Eigen::VectorXd density =
      mean > 0 ? Eigen::VectorXd((area / mean).cwiseMax(kSmall).cwiseSqrt().cwiseInverse()) : Eigen::VectorXd::Ones(n);
  // (K + s L) of each step: L_ij = -c_ij off the diagonal, K_i = sum_j c_ij |e_ij|^2 / 4, the row divided by s.
  // Diffusion over a time t has the second moment 4 t, the paper's kernel kMoment r^2, so s = kMoment r^2 / 4 / kSteps.
  const double time = kMoment * radius * radius / 4 / kSteps;
  auto made = std::make_shared<Matrix>();
  made->mass.setZero(n);
  SparseMatrix matrix(n, n);
  matrix.reserve(static_cast<Eigen::Index>(neighbours.values.size()) / 2 + n);
  for (int j = 0; j < n; ++j) {
    double sum = 0, mass = 0;
    for (int k = neighbours.offsets[j]; k < neighbours.offsets[j + 1]; ++k) {
      const double conductance = density[j] * density[neighbours.values[k]];
      sum += conductance;
      mass += 0.25 * conductance * squared[k];
    }
    made->mass[j] = mass / time + kLeast;
    matrix.startVec(j);
    matrix.insertBack(j, j) = made->mass[j] + sum;
    for (const int i : neighbours[j]) {
      if (i > j) {
        matrix.insertBack(i, j) = -density[i] * density[j];
      }
    }
  }
  matrix.finalize();
  factor_ = std::make_unique<SparseCholesky>(matrix, options);
  made->matrix = matrix.selfadjointView<Eigen::Lower>();
  matrix_ = std::move(made);
}

DiffusionSmoother::DiffusionSmoother(const DiffusionSmoother& other, std::shared_ptr<ThreadPool> pool)
    : matrix_(other.matrix_),
      pool_(pool ? std::move(pool) : std::make_shared<ThreadPool>(1)),
      factor_(std::make_unique<SparseCholesky>(*other.factor_, pool_)) {}

std::unique_ptr<Smoother> DiffusionSmoother::share(std::shared_ptr<ThreadPool> pool) const {
  return std::unique_ptr<Smoother>(new DiffusionSmoother(*this, std::move(pool)));
}

/// (K / s + L) x' = K / s x, twice.
void DiffusionSmoother::apply_roughly(const Points& in, Points& out) const {
  out = in;
  for (int step = 0; step < kSteps; ++step) {
    for (Eigen::Index i = 0; i < out.rows(); ++i) {
      out.row(i) *= matrix_->mass[i];
    }
    factor_->solve(out, out);
  }
}

class DiffusionSmoother::System : public RefinedSystem {
 public:
  explicit System(const DiffusionSmoother& smoother) : s_(smoother) {}
  void residual(const DoubledPoints& x, Points& left) override {
    symmetric_residual(s_.matrix_->matrix, s_.scratch_.right, x, left, *s_.pool_);
  }
  void subtract_product(const Points& step, Points& left) override {
    subtract_symmetric_product(s_.matrix_->matrix, step, left, *s_.pool_);
  }
  void solve(Points& left, Points& step) override { s_.factor_->solve(left, step); }

 private:
  const DiffusionSmoother& s_;
};

/// Does the same, with each step solved to the last bit.
void DiffusionSmoother::apply(const Points& in, Points& out) const {
  constexpr int kGrain = 4096;
  Points &right = scratch_.right, &left = scratch_.left;
  System system(*this);
  right.resize(in.rows(), 3);
  for (int step = 0; step < kSteps; ++step) {
    const Points& from = step == 0 ? in : out;
    for_indices(*pool_, static_cast<int>(in.rows()), kGrain,
                [&](int i) { right.row(i) = matrix_->mass[i] * from.row(i); });
    left = right;
    refine_to_the_bit(system, factor_->single_precision(), scratch_.x, left, scratch_.step, *pool_);
    out = scratch_.x.high;
  }
}

}  // namespace lapedit
