// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_pose.h"

#include <algorithm>
#include <cmath>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {
namespace {

constexpr int kSmoothing = 1;
/// Found by measuring stretch, folds and the tilt of details over some twenty edits (tests/bench/quality.sh):
/// averagings of covariances over neighbours, and the factor of the extrapolation.
constexpr int kAveragings = 1;
constexpr double kMomentum = 0.5;
constexpr double kNormals = 0.5;
// Prevents jumps of the pose where the surface collapses: the normal fades out, and the rotation stays near the last
// one.
constexpr double kSureNormal = 0.5;

}  // namespace

// Sums over the edges between cells read points and matrix columns four numbers at a time and add them in a fixed
// order, so that the bits are the same on every processor.

/// Computes C_a = sum_b g_ab (P1_b - P1_a)(P0_b - P0_a)^T and adds the term of the normal, see LocalGlobal.
struct LocalGlobal::Covariances {
  const RegionCells& cells;
  const CellSurface& surface;
  const Points& after;
  const Vector3* before;
  const Points& normals_before;
  MatrixAverages& to;

  LAPEDIT_INLINE void operator()(int a) const {
    Doubles4 column[3] = {}, first = {}, second = {};  // tangents, as in CellSurface::normal()
    const Doubles4 here = load3(&after(a, 0));
    for (int k = cells.neighbours.offsets[a]; k < cells.neighbours.offsets[a + 1]; ++k) {
      const Doubles4 edge = load3(&after(cells.neighbours.values[k], 0)) - here;
      for (int c = 0; c < 3; ++c) {
        column[c] += edge * before[k][c];
      }
      first += surface.slope(k)[0] * edge;
      second += surface.slope(k)[1] * edge;
    }
    const Doubles4 normal = {first[1] * second[2] - first[2] * second[1], first[2] * second[0] - first[0] * second[2],
                             first[0] * second[1] - first[1] * second[0], 0};
    const Doubles4 squares = column[0] * column[0] + column[1] * column[1] + column[2] * column[2],
                   normals = normal * normal;
    const double size = std::sqrt(squares[0] + squares[1] + squares[2]);
    const double length = std::sqrt(normals[0] + normals[1] + normals[2] + kSureNormal * kSureNormal);
    for (int c = 0; c < 3; ++c) {
      column[c] += (kNormals * size / length * normals_before(a, c)) * normal;
      for (std::ptrdiff_t e = 0; e < 3; ++e) {
        to[a](e, c) = column[c][e];
      }
    }
  }
};

/// Computes sum_b ((R_a + R_b) / 2 - I) e_ab, where e_ab = -M_ab (C_a - C_b).
struct LocalGlobal::Rotated {
  const Rotating& from;
  double* to;

  LAPEDIT_INLINE Doubles4 rotated(int cell, const double* edge) const {
    const double* const columns = from.columns.data() + 12 * std::ptrdiff_t{cell};
    return edge[0] * load<Doubles4>(columns) + edge[1] * load<Doubles4>(columns + 4) +
           edge[2] * load<Doubles4>(columns + 8);
  }
  LAPEDIT_INLINE void operator()(int a) const {
    Doubles4 sum = rotated(a, &from.sums(a, 0));
    for (int k = from.m.outerIndexPtr()[a]; k < from.m.outerIndexPtr()[a + 1]; ++k) {
      sum += rotated(from.m.innerIndexPtr()[k], &from.edges(k, 0));
    }
    sum *= 0.5;
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      to[3 * std::ptrdiff_t{a} + e] = sum[e];
    }
  }
};

LocalGlobal::LocalGlobal(const RegionCells& cells, const CellSurface& surface, const std::vector<double>& hold,
                         const std::vector<double>& inertia, CoarseSystem& system)
    : cells_(cells),
      surface_(surface),
      hold_(hold),
      inertia_(inertia),
      system_(system),
      averages_(cells.count()),
      covariances_(cells.count()),
      loose_{std::vector<Matrix3>(cells.count())},
      before_(cells.neighbours.values.size()),
      rotating_{OperatorRows::Rows(system.differential_operator()), {}, {}, {}} {
  rotating_.edges.resize(rotating_.m.nonZeros(), 3);
  rotating_.sums.resize(cells.count(), 3);
  rotating_.columns.resize(12 * static_cast<std::size_t>(cells.count()));
}

void LocalGlobal::start(const Points& rigid, const std::vector<Matrix3>& linear, bool targets) {
  loose_.of = &system_.loose(targets);
  loose_.rotations.resize(1 + *std::max_element(loose_.of->begin(), loose_.of->end()));
  if (rigid_.rows() == rigid.rows() && rigid_ == rigid && linear_ == linear) {
    return;  // in a drag, `rigid` is the rest pose in every frame
  }
  rigid_ = rigid;
  linear_ = linear;
  smooth_before_ = rigid;
  surface_.smooth(kSmoothing, smooth_before_, scratch_);
  normals_before_.resize(rigid.rows(), 3);
  rotating_.sums.setZero();
  for (int a = 0; a < cells_.count(); ++a) {
    for (int k = rotating_.m.outerIndexPtr()[a]; k < rotating_.m.outerIndexPtr()[a + 1]; ++k) {
      const Vector3 edge = (cells_.centres.row(a) - cells_.centres.row(rotating_.m.innerIndexPtr()[k])).transpose();
      rotating_.edges.row(k) = -rotating_.m.valuePtr()[k] * (edge + linear[a] * edge).transpose();
      rotating_.sums.row(a) += rotating_.edges.row(k);
    }
  }
  for (int a = 0; a < cells_.count(); ++a) {
    normals_before_.row(a) = surface_.normal(a, smooth_before_).transpose();
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      before_[k] =
          surface_.nearness(k) * (smooth_before_.row(cells_.neighbours.values[k]) - smooth_before_.row(a)).transpose();
    }
  }
}

/// Computes the rotations nearest to the averaged covariances.
void LocalGlobal::fit(const Points& displacement, std::vector<Matrix3>& rotations) {
  smooth_after_ = rigid_ + displacement;
  surface_.smooth(kSmoothing, smooth_after_, scratch_);
  run_kernel(Covariances{cells_, surface_, smooth_after_, before_.data(), normals_before_, averages_}, 0,
             cells_.count());
  averages_.average(cells_.neighbours, kAveragings, alone_);
  for (int a = 0; a < cells_.count(); ++a) {
    const Matrix3 averaged = averages_[a];
    covariances_[a] = averaged.allFinite() ? averaged : Matrix3(Matrix3::Identity());
    covariances_[a] += inertia_[a] * covariances_[a].norm() * rotations[a];
    if (hold_[a] > 0) {
      covariances_[a] = (1 - hold_[a]) * covariances_[a] + hold_[a] * covariances_[a].norm() * Matrix3::Identity();
    }
  }
  nearest_rotations(covariances_.data(), cells_.count(), rotations.data());
  if (!loose_.rotations.empty()) {
    hang(rotations);
  }
}

/// Gives each loose part the mean rotation of the cells around it.
void LocalGlobal::hang(std::vector<Matrix3>& rotations) {
  const std::vector<int>& part = *loose_.of;
  std::vector<Matrix3>& mean = loose_.rotations;
  std::fill(mean.begin(), mean.end(), Matrix3::Zero());
  for (int a = 0; a < cells_.count(); ++a) {
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      if (const int of = part[cells_.neighbours.values[k]]; of >= 0 && part[a] < 0) {
        mean[of] += cells_.crossing[k] * rotations[a];
      }
    }
  }
  nearest_rotations(mean.data(), static_cast<int>(mean.size()), mean.data());
  for (int a = 0; a < cells_.count(); ++a) {
    if (part[a] >= 0) {
      rotations[a] = mean[part[a]];
    }
  }
}

void LocalGlobal::rotate(const std::vector<Matrix3>& rotations, Points& rotated) {
  rotated.resize(cells_.count(), 3);
  for (int a = 0; a < cells_.count(); ++a) {
    for (int c = 0; c < 3; ++c) {
      double* const column = &rotating_.columns[12 * static_cast<std::size_t>(a) + 4 * static_cast<std::size_t>(c)];
      store(column, load3(&rotations[a](0, c)));
      column[c] -= 1;
    }
  }
  run_kernel(Rotated{rotating_, rotated.data()}, 0, cells_.count());
}

LocalGlobal::Outcome LocalGlobal::settle(const Points& constraints, double accurate, int most_passes,
                                         Points& displacement, std::vector<Matrix3>& rotations) {
  Outcome outcome;
  while (outcome.passes < most_passes) {
    if (outcome.passes > 0) {
      fit(displacement, rotations);
    }
    rotate(rotations, rotated_);
    next_ = constraints;
    system_.add_rotated(rotated_, next_);
    system_.solve(next_, next_);
    if (++outcome.passes == 1) {
      displacement = result_ = next_;
      continue;
    }
    outcome.left = (next_ - displacement).rowwise().norm().maxCoeff();
    // fit() reads an extrapolated pose, which saves several passes.
    displacement = next_ + kMomentum * (next_ - result_);
    result_.swap(next_);
    if (!(outcome.left >= accurate)) {
      break;
    }
  }
  fit(displacement, rotations);
  displacement = result_;
  return outcome;
}

}  // namespace lapedit
