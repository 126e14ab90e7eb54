// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "lapedit/linear/linear.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// The cost of bending and stretching a template, independent of its triangulation:
///
///     E(x) = l^4 (sum_i m_i |(Delta x)_i|^2 + (0.5 / S^2) c sum_ij w_ij |x_i - x_j|^2 / 2)
///
/// with m_i a vertex's area over the mean, Delta = (4 / h_i^2) M the surface's Laplacian (M the differential operator,
/// h_i the vertex's edge length), w the operator's weights, c = mean (4 m_i / (h_i^2 D_i)), S the template's size and l
/// a length: displacements of wavelengths below 2 pi l are damped. Rows of the border stay. The analysis of the first
/// factor serves all others.
class TemplateEnergy {
 public:
  /// @param rest  positions of the region's vertices; @param mesh  the same, of all vertices
  TemplateEnergy(const TriangleMesh& mesh, const Region& region, const Points& rest, double size,
                 const SolverOptions& options, std::shared_ptr<ThreadPool> pool);

  /// Vertex areas over their mean.
  const Eigen::VectorXd& mass() const { return mass_; }
  double mean_area() const { return mean_area_; }
  double edge_length() const { return edge_length_; }  ///< RMS

  /// Factors the matrix of l^4 E + sum_i diagonal_i |x_i|^2. @throws EditError (IllConditioned)
  void factor(double length, const Eigen::VectorXd& diagonal);
  /// Solves with the last factor, to the last bit. @throws EditError (IllConditioned, Cancelled)
  void solve(Points& right, Points& x, const Progress& progress);
  /// Computes the right-hand side for the shape `rest` rotated and scaled: differential coordinates by their vertex's
  /// rotation, edges by the mean of their ends'.
  void rotated(const std::vector<Matrix3>& rotations, double scale, Points& right);

  /// Weights of edges, one per entry of the region's neighbours.
  const std::vector<double>& weights() const { return weights_; }

 private:
  const Region& region_;
  const Points& rest_;
  std::shared_ptr<ThreadPool> pool_;
  SolverOptions options_;
  Eigen::VectorXd mass_;
  double mean_area_ = 0, edge_length_ = 0, membrane_ = 0, length4_ = 1;
  std::vector<double> weights_;
  std::shared_ptr<const OperatorRows> rows_;
  std::vector<int> order_;
  std::shared_ptr<const FactoredNormalMatrix> matrix_;
  std::unique_ptr<RefinedSolver> solver_;
  Points delta_, turned_, spread_;
};

}  // namespace lapedit
