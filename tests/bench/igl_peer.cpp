// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <igl/arap.h>
#include <igl/harmonic.h>
#include <igl/min_quad_with_fixed.h>

#include <stdexcept>

namespace quality {
namespace {

void require(bool factorised) {
  if (!factorised) throw std::runtime_error("libigl could not factorise its matrix");
}

}  // namespace

MethodResult igl_arap(const Problem& scene) {
  igl::ARAPData data;
  data.max_iter = 1;
  return timed(scene, kArapIterations, [&data](const RegionMatrices& problem, Eigen::MatrixXd& positions) {
    require(igl::arap_precomputation(problem.rest, problem.faces, 3, problem.held, data));
    return [&] { require(igl::arap_solve(problem.positions, data, positions)); };
  });
}

MethodResult igl_biharmonic(const Problem& scene) {
  igl::min_quad_with_fixed_data<double> data;
  return timed(scene, 1, [&data](const RegionMatrices& problem, Eigen::MatrixXd& positions) {
    Eigen::SparseMatrix<double> energy;
    igl::harmonic(problem.rest, problem.faces, 2, energy);
    require(igl::min_quad_with_fixed_precompute(energy, problem.held, Eigen::SparseMatrix<double>(), true, data));
    return [&] {
      Eigen::MatrixXd way(problem.positions.rows(), 3), displacement;
      for (Eigen::Index k = 0; k < way.rows(); ++k) {
        way.row(k) = problem.positions.row(k) - problem.rest.row(problem.held[k]);
      }
      const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(problem.rest.rows(), 3), no_equations(0, 3);
      require(igl::min_quad_with_fixed_solve(data, none, way, no_equations, displacement));
      positions = problem.rest + displacement;
    };
  });
}

}  // namespace quality
