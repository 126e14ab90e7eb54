// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/smoother.h"
#include "lapedit/linear/accurate_residual.h"
#include "lapedit/linear/sparse_cholesky.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Smoothing by diffusion along the edges of a region, as wide as the paper's kernel of radius r. It makes two implicit
/// steps (K + s L) x' = K x, where L is the graph Laplacian with conductances c_ij, and K_i = sum_j c_ij |e_ij|^2 / 4
/// makes the speed independent of the density of the mesh. Kernel and diffusion have the same second moment in the
/// plane, 5/21 r^2. With c_ij = mean area / sqrt(area_i area_j) dense parts weigh more, as in the kernel, whose means
/// are over vertices, so that ends of limbs keep their direction (octopus, 1,385 vertices: 48 flipped triangles instead
/// of 87).
///
/// The cost does not depend on r. The result depends on the shape alone. Source: this project.
class DiffusionSmoother : public Smoother {
 public:
  /// @param rest    size() x 3 rest positions of the region
  /// @param radius  r > 0, model units
  /// Cost: a sparse factorisation with the one-ring's pattern, about a tenth of the factorisation of the editor's
  /// system.
  /// @throws EditError (IllConditioned)
  DiffusionSmoother(const Region& region, const Points& rest, double radius, const CholeskyOptions& options = {});

  /// Smooths with the same bits for every factorisation, BLAS and processor.
  void apply(const Points& in, Points& out) const override;
  /// Smooths with one solve per step, without refinement.
  void apply_roughly(const Points& in, Points& out) const override;
  std::unique_ptr<Smoother> share(std::shared_ptr<ThreadPool> pool) const override;

 private:
  struct Matrix {          // K + s L
    Eigen::VectorXd mass;  // K
    SparseMatrix matrix;   // both halves, for residuals
  };
  struct Scratch {  // kept, so that a drag allocates nothing
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
