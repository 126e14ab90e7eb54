// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/local_global.h"

#include <algorithm>
#include <cmath>

#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {
namespace {

// Found by measuring stretch, folds and the tilt of details over some twenty edits (tests/scripts/quality.sh).
constexpr int kSmoothing = 1;
constexpr int kAveraging = 1;
constexpr double kNormals = 0.5;
constexpr double kMomentum = 0.5;
// Prevents jumps of the pose where the surface collapses: the normal fades out, and the rotation stays near the last
// one.
constexpr double kSureNormal = 0.5, kInertia = 0.5;

}  // namespace

/// Sums over the edges between cells. Points and matrix columns are read four numbers at a time and added in a fixed
/// order, so that the bits are the same on every processor.
struct LocalGlobal::Edges {
  const RegionCells& cells;
  const CellSurface& surface;
  const OperatorRows::Rows& m;

  static LAPEDIT_INLINE Doubles4 three(const double* from) { return Doubles4{from[0], from[1], from[2], 0}; }

  /// C_a = sum_b g_ab (P1_b - P1_a)(P0_b - P0_a)^T with the term of the normal, see the class.
  LAPEDIT_INLINE void covariance(int a, const Points& after, const Vector3* before, const double* normal_before,
                                 double* to) const {
    Doubles4 column[3] = {}, first = {}, second = {};  // tangents, as in CellSurface::normal()
    const Doubles4 here = three(&after(a, 0));
    for (int k = cells.neighbours.offsets[a]; k < cells.neighbours.offsets[a + 1]; ++k) {
      const Doubles4 edge = three(&after(cells.neighbours.values[k], 0)) - here;
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
      column[c] += (kNormals * size / length * normal_before[c]) * normal;
      for (std::ptrdiff_t e = 0; e < 3; ++e) {
        to[3 * static_cast<std::ptrdiff_t>(c) + e] = column[c][e];
      }
    }
  }

  static LAPEDIT_INLINE Doubles4 turned(const double* columns, const double* edge) {
    return edge[0] * load<Doubles4>(columns) + edge[1] * load<Doubles4>(columns + 4) +
           edge[2] * load<Doubles4>(columns + 8);
  }
  /// sum_b ((R_a + R_b) / 2 - I) e_ab, e_ab = -M_ab (C_a - C_b), or with R_a alone.
  /// @param turns  of each cell R - I in three columns of four numbers
  LAPEDIT_INLINE void turn(const double* turns, const Points& edges, const Points& sums, bool by_edges,
                           double* to) const {
    for (int a = 0; a < cells.count(); ++a, to += 3) {
      Doubles4 sum = turned(turns + 12 * std::ptrdiff_t{a}, &sums(a, 0));
      if (by_edges) {
        for (int k = m.outerIndexPtr()[a]; k < m.outerIndexPtr()[a + 1]; ++k) {
          sum += turned(turns + 12 * std::ptrdiff_t{m.innerIndexPtr()[k]}, &edges(k, 0));
        }
        sum *= 0.5;
      }
      for (std::ptrdiff_t e = 0; e < 3; ++e) {
        to[e] = sum[e];
      }
    }
  }
  LAPEDIT_INLINE void all_covariances(const Points& after, const Vector3* before, const Points& normals,
                                      MatrixAverages& to) const {
    for (int a = 0; a < cells.count(); ++a) {
      covariance(a, after, before, &normals(a, 0), to[a].data());
    }
  }
  static void covariances_plain(const Edges& all, const Points& after, const Vector3* before, const Points& normals,
                                MatrixAverages& to) {
    all.all_covariances(after, before, normals, to);
  }
  LAPEDIT_AVX2 static void covariances_avx2(const Edges& all, const Points& after, const Vector3* before,
                                            const Points& normals, MatrixAverages& to) {
    all.all_covariances(after, before, normals, to);
  }
  static void turn_plain(const Edges& all, const double* turns, const Points& edges, const Points& sums, bool by_edges,
                         double* to) {
    all.turn(turns, edges, sums, by_edges, to);
  }
  LAPEDIT_AVX2 static void turn_avx2(const Edges& all, const double* turns, const Points& edges, const Points& sums,
                                     bool by_edges, double* to) {
    all.turn(turns, edges, sums, by_edges, to);
  }
};

LocalGlobal::LocalGlobal(const RegionCells& cells, const CellSurface& surface, const std::vector<double>& hold,
                         const EditSettings& settings, CoarseSystem& system)
    : cells_(cells),
      surface_(surface),
      hold_(hold),
      settings_(settings),
      system_(system),
      averages_(cells.count()),
      covariances_(cells.count()),
      before_(cells.neighbours.values.size()),
      turning_{OperatorRows::Rows(system.differential_operator()), {}, {}, {}} {
  turning_.edges.resize(turning_.m.nonZeros(), 3);
  turning_.sums.resize(cells.count(), 3);
  turning_.turns.resize(12 * static_cast<std::size_t>(cells.count()));
}

void LocalGlobal::start(const Points& carried, const std::vector<Matrix3>& linear) {
  if (carried_.rows() == carried.rows() && carried_ == carried && linear_ == linear) {
    return;  // in a drag this is the rest pose in every frame
  }
  carried_ = carried;
  linear_ = linear;
  smooth_before_ = carried;
  surface_.smooth(kSmoothing, smooth_before_, scratch_);
  normals_before_.resize(carried.rows(), 3);
  turning_.sums.setZero();
  for (int a = 0; a < cells_.count(); ++a) {
    for (int k = turning_.m.outerIndexPtr()[a]; k < turning_.m.outerIndexPtr()[a + 1]; ++k) {
      const Vector3 edge = (cells_.centres.row(a) - cells_.centres.row(turning_.m.innerIndexPtr()[k])).transpose();
      turning_.edges.row(k) = -turning_.m.valuePtr()[k] * (edge + linear[a] * edge).transpose();
      turning_.sums.row(a) += turning_.edges.row(k);
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
  smooth_after_ = carried_ + displacement;
  surface_.smooth(kSmoothing, smooth_after_, scratch_);
  const Edges edges = {cells_, surface_, turning_.m};
  for_processor(Edges::covariances_plain, Edges::covariances_avx2, Edges::covariances_avx2)(
      edges, smooth_after_, before_.data(), normals_before_, averages_);
  averages_.average(cells_.neighbours, kAveraging, alone_);
  for (int a = 0; a < cells_.count(); ++a) {
    const Matrix3 averaged = averages_[a];
    covariances_[a] = averaged.allFinite() ? averaged : Matrix3(Matrix3::Identity());
    covariances_[a] += kInertia * covariances_[a].norm() * rotations[a];
    if (hold_[a] > 0) {
      covariances_[a] = (1 - hold_[a]) * covariances_[a] + hold_[a] * covariances_[a].norm() * Matrix3::Identity();
    }
  }
  nearest_rotations(covariances_.data(), cells_.count(), rotations.data());
}

void LocalGlobal::turn(const std::vector<Matrix3>& rotations, Points& turned) {
  turned.resize(cells_.count(), 3);
  for (int a = 0; a < cells_.count(); ++a) {
    for (int c = 0; c < 3; ++c) {
      double* const column = &turning_.turns[12 * static_cast<std::size_t>(a) + 4 * static_cast<std::size_t>(c)];
      store(column, Edges::three(&rotations[a](0, c)));
      column[c] -= 1;
    }
  }
  const Edges edges = {cells_, surface_, turning_.m};
  for_processor(Edges::turn_plain, Edges::turn_avx2, Edges::turn_avx2)(
      edges, turning_.turns.data(), turning_.edges, turning_.sums, settings_.turning == DetailTurning::Edge,
      turned.data());
}

LocalGlobal::Outcome LocalGlobal::settle(const Points& constraints, double accurate, int most_passes,
                                         Points& displacement, std::vector<Matrix3>& rotations) {
  Outcome outcome;
  while (outcome.passes < most_passes) {
    if (outcome.passes > 0) {
      fit(displacement, rotations);
    }
    turn(rotations, turned_);
    next_ = constraints;
    system_.add_turned(turned_, next_);
    system_.solve(next_, next_);
    if (++outcome.passes == 1) {
      displacement = result_ = next_;
      continue;
    }
    outcome.left = (next_ - displacement).rowwise().norm().maxCoeff();
    // Rotations are fitted to an extrapolated pose, which saves several passes.
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
