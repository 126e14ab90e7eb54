// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lapedit/linear/linear.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// The cost of bending and stretching a template, independent of its triangulation:
///
///     E(x) = l^4 (sum_i m_i |(Delta x)_i|^2 + (b / S^2) c sum_ij w_ij |x_i - x_j|^2 / 2)
///
/// with m_i a vertex's area over the mean, Delta = (4 / h_i^2) M the surface's Laplacian (M the differential operator,
/// h_i the vertex's edge length), w the operator's weights, c = mean (4 m_i / (h_i^2 D_i)), S the template's size, b
/// `membrane`, and l a length: E damps displacements of wavelengths below 2 pi l. Its matrix is symmetric positive
/// semidefinite and includes the rows of the border. All factors reuse the analysis of the first.
class TemplateEnergy {
 public:
  /// @param rest  positions of the region's vertices; @param mesh  the whole mesh with these positions
  TemplateEnergy(const TriangleMesh& mesh, const Region& region, const Points& rest, double size, double membrane,
                 std::shared_ptr<ThreadPool> pool);

  const Eigen::VectorXd& mass() const { return mass_; }  ///< vertex areas over their mean
  double mean_area() const { return mean_area_; }
  double edge_length() const { return edge_length_; }  ///< RMS

  /// Factors the matrix of E + sum_i diagonal_i |x_i|^2, which is symmetric positive definite.
  /// @throws EditError (IllConditioned)
  void factor(double length, const Eigen::VectorXd& diagonal);
  /// Solves with the last factor: with the same bits on every processor, and accurate to about its condition number.
  /// @throws EditError (IllConditioned)
  void solve(const Points& right, Points& x);
  /// The same, accurate to about 1e-12.
  void solve_accurately(const Points& right, Points& x);
  /// Subtracts the gradient of E / 2 at x from `right`.
  void subtract_gradient(const Points& x, Points& right);
  /// Adds the gradient of E / 2 at the rotated and scaled shape `rest` to `right`. Each differential coordinate rotates
  /// with its vertex, each edge by the mean of the rotations of its ends.
  void add_rotated(const std::vector<Matrix3>& rotations, double scale, Points& right);

 private:
  const Region& region_;
  const Points& rest_;
  double size_;
  std::shared_ptr<ThreadPool> pool_;
  Eigen::VectorXd mass_;
  double mean_area_ = 0, edge_length_ = 0, membrane_ = 0, length4_ = 1;
  std::vector<double> weights_;
  std::shared_ptr<const OperatorRows> rows_;
  Eigen::VectorXd diagonal_;
  std::shared_ptr<SparseCholesky> factor_;
  Points delta_, between_, product_, step_;
};

}  // namespace lapedit
