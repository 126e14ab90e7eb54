// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/local_step.h"

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {

void local_step(const LaplacianSystem& system, const Points& before, const Points& displacement, int pass,
                LocalStepScratch& scratch, std::vector<Matrix3>& rotations) {
  constexpr int kGrain = 512;
  const int n = system.region.size();
  const OperatorRows::Rows& m = system.powers.first->rows();
  scratch.ahead = displacement;
  if (pass > 0) {
    scratch.ahead += kVertexFit.momentum * (displacement - scratch.previous);
  }
  scratch.previous = displacement;
  scratch.covariances.resize(n);
  for_indices(*system.pool, n, kGrain, [&](int i) {
    Matrix3 covariance = Matrix3::Zero();
    for (OperatorRows::Rows::InnerIterator entry(m, i); entry; ++entry) {
      const auto j = static_cast<int>(entry.col());
      const Vector3 edge = (before.row(i) - before.row(j)).transpose();
      const Vector3 after = edge + (scratch.ahead.row(i) - scratch.ahead.row(j)).transpose();
      // This order of factors makes the covariance of a vertex that has not moved symmetric.
      const Matrix3 product = after * edge.transpose();
      covariance -= entry.value() * product;
    }
    scratch.covariances[i] = covariance;
  });
  scratch.covariances.average(system.region.neighbours, kVertexFit.averagings, *system.pool);
  rotations.resize(n);
  in_pieces(*system.pool, n, kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      rotations[i] = scratch.covariances[i];
      if (!rotations[i].allFinite()) {
        rotations[i].setIdentity();
      }
    }
    nearest_rotations(rotations.data() + first, last - first, rotations.data() + first);
  });
}

}  // namespace lapedit
