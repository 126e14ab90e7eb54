// SPDX-License-Identifier: GPL-3.0-or-later
#include "system.h"

#include <algorithm>

namespace speed {
namespace {

using Extended = Eigen::Matrix<long double, Eigen::Dynamic, 3>;

/// out += matrix x, or matrix^T x
void add_product(const Sparse& matrix, bool transposed, const Extended& x, Extended& out) {
  for (int j = 0; j < matrix.outerSize(); ++j) {
    for (Sparse::InnerIterator it(matrix, j); it; ++it) {
      const auto to = transposed ? j : it.row(), from = transposed ? it.row() : j;
      out.row(to) += static_cast<long double>(it.value()) * x.row(from);
    }
  }
}

Refined refine(const Columns& rhs, const Solver& solver,
               const std::function<void(const Extended& x, Extended& out)>& subtract_product) {
  constexpr int kMostSteps = 30;
  constexpr double kSettled = 1e-15;
  const Extended exact_rhs = rhs.cast<long double>();
  Extended x = Extended::Zero(rhs.rows(), 3), residual = exact_rhs;
  Columns correction;
  Refined result;
  double last = 1;
  for (int step = 0; step < kMostSteps; ++step) {
    solver(residual.cast<double>(), correction);
    x += correction.cast<long double>();
    result.accuracy = correction.cwiseAbs().maxCoeff() / static_cast<double>(x.cwiseAbs().maxCoeff());
    if (result.accuracy < kSettled || (step > 1 && result.accuracy > 0.5 * last)) {
      break;
    }
    last = result.accuracy;
    residual = exact_rhs;
    subtract_product(x, residual);
  }
  result.x = x.cast<double>();
  return result;
}

}  // namespace

System make_system(const lapedit::Region& region, int order, double handle_weight, double anchor_weight) {
  const int n = region.size();
  System system;
  system.order = order;
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(j, j, 1);
    for (const int i : region.neighbours[j]) {
      entries.emplace_back(j, i, -1.0 / region.neighbours[j].size());
    }
  }
  system.first.resize(n, n);
  system.first.setFromTriplets(entries.begin(), entries.end());
  system.m = system.first;
  for (int k = 1; k < order; ++k) {
    system.m = Sparse(system.first * system.m);
  }
  system.squared_weights.setZero(n);
  entries.clear();
  for (int i = 0; i < n; ++i) {
    const double weight = region.classes[i] == lapedit::VertexClass::Handle   ? handle_weight
                          : region.classes[i] == lapedit::VertexClass::Anchor ? anchor_weight * region.anchor_weight[i]
                                                                              : 0;
    system.squared_weights[i] = weight * weight;
    entries.emplace_back(i, i, weight * weight);
  }
  Sparse weights(n, n);
  weights.setFromTriplets(entries.begin(), entries.end());
  system.normal = Sparse(system.m.transpose()) * system.m;
  system.normal += weights;
  system.normal.makeCompressed();
  return system;
}

Columns frame_rhs(const System& system, const lapedit::Region& region, const lapedit::Points& rest,
                  const lapedit::Affine& handle, const std::vector<lapedit::Matrix3>& rotations) {
  Columns rows = Columns::Zero(region.size(), 3);
  for (int column = 0; column < system.first.outerSize(); ++column) {
    for (Sparse::InnerIterator entry(system.first, column); entry; ++entry) {
      const auto i = entry.row(), j = entry.col();
      const lapedit::Matrix3 rotation = (rotations[i] + rotations[j]) / 2 - lapedit::Matrix3::Identity();
      rows.row(i) -= entry.value() * (rotation * (rest.row(i) - rest.row(j)).transpose()).transpose();
    }
  }
  for (int k = 1; k < system.order; ++k) {
    rows = (system.first * rows).eval();
  }
  Columns rhs = system.m.transpose() * rows;
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == lapedit::VertexClass::Handle) {
      const Eigen::Vector3d place = rest.row(i).transpose();
      rhs.row(i) += system.squared_weights[i] * (handle * place - place).transpose();
    }
  }
  return rhs;
}

Refined refine_normal(const System& system, const Columns& rhs, const Solver& solver) {
  return refine(rhs, solver, [&system](const Extended& x, Extended& out) {
    Extended product = Extended::Zero(x.rows(), 3);
    add_product(system.normal, false, x, product);
    out -= product;
  });
}

Refined refine_least_squares(const System& system, const Columns& rhs, const Solver& solver) {
  return refine(rhs, solver, [&system](const Extended& x, Extended& out) {
    Extended rows = Extended::Zero(x.rows(), 3), product = Extended::Zero(x.rows(), 3);
    add_product(system.m, false, x, rows);
    add_product(system.m, true, rows, product);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      product.row(i) += static_cast<long double>(system.squared_weights[i]) * x.row(i);
    }
    out -= product;
  });
}

double relative_error(const Columns& x, const Columns& reference) {
  return (x - reference).cwiseAbs().maxCoeff() / reference.cwiseAbs().maxCoeff();
}

}  // namespace speed
