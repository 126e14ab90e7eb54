// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/base/refuse.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {
namespace {

/// Returns flags of the vertices whose faces in the region do not surround them.
std::vector<char> open_vertices(const Region& region) {
  constexpr std::uint64_t kMix = 0x9e3779b97f4a7c15;
  // Each neighbour of a surrounded vertex is in two of its faces, so that the exclusive or of all of them is 0.
  std::vector<std::uint64_t> rings(region.mesh_vertex.size(), 0);
  std::vector<char> open(region.mesh_vertex.size(), 1);
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      for (const int other : {region.faces(f, (k + 1) % 3), region.faces(f, (k + 2) % 3)}) {
        const std::uint64_t mixed = (static_cast<std::uint64_t>(other) + 1) * kMix;
        rings[region.faces(f, k)] ^= mixed ^ (mixed >> 29);
      }
      open[region.faces(f, k)] = 0;
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] |= rings[i] != 0;
  }
  return open;
}

/// The normal matrix without the membrane.
class Bending {
 public:
  explicit Bending(const LaplacianSystem& system) : s_(system) {}

  /// Computes (M^k)^T rows.
  void transposed(const Points& rows, Points& out) const {
    s_.powers.m->apply_left_factor(rows, out, *s_.pool);
    if (s_.powers.stretch.size() > 0) {
      out -= s_.powers.stretch.asDiagonal() * rows.topRows(out.rows());
    }
  }
  void operator()(const Points& x, Points& out) {
    s_.powers.m->apply(x, rows_, *s_.pool);
    transposed(rows_, out);
    out += s_.squared_weights.asDiagonal() * x;
  }
  /// Computes (M^k)^T M^(k-1) (h - 1) delta.
  Points gradient() const {
    const Region& region = s_.region;
    const std::vector<char> open = open_vertices(region);
    Points rows, product;
    s_.powers.first->apply(s_.rest.local, rows, *s_.pool);
    for (int i = 0; i < region.size(); ++i) {
      const bool is_anchor = region.classes[i] == VertexClass::Anchor;
      const double depth = !is_anchor ? 0 : region.anchor_depth.empty() ? 1 : region.anchor_depth[i];
      rows.row(i) *= open[i] != 0 ? 0 : smooth_step(depth) - 1;
    }
    for (int k = 1; k < s_.settings.order; ++k) {
      s_.powers.first->apply(rows, product, *s_.pool);
      rows.swap(product);
    }
    const Eigen::Index links = s_.powers.links.size();  // keep their vectors
    rows.conservativeResize(rows.rows() + links, 3);
    rows.bottomRows(links).setZero();
    transposed(rows, product);
    return product;
  }

 private:
  const LaplacianSystem& s_;
  Points rows_;
};

double dot(const Points& a, const Points& b) {
  return a.cwiseProduct(b).sum();
}

}  // namespace

Points fair_displacement(const LaplacianSystem& system) {
  constexpr double kAccurateEnergy = 1e-11;
  constexpr int kMostSteps = 200;
  if (!system.all_anchored()) {
    refuse_edit(ErrorCause::BadParameter, {"detail"},
                "The detail can only change in a region with a boundary, between vertices that stay: choose a "
                "smaller region, or paint fixed vertices.");
  }
  Bending bending(system);
  RefinedSolver preconditioner(system.matrix, system.correction, system.pool);
  Points residual = bending.gradient(), solved, scratch, image, step, last = Points::Zero(residual.rows(), 3);
  Points x = Points::Zero(residual.rows(), 3);
  double product = 0, first = 0;
  for (int k = 0; k < kMostSteps; ++k) {
    report_progress(0.9, "detail");
    scratch = residual;
    preconditioner.solve(scratch, solved);
    const double next = dot(residual, solved);
    first = k == 0 ? next : first;
    if (!(next > kAccurateEnergy * kAccurateEnergy * first)) {
      break;
    }
    // Polak and Ribiere's formula, since a factor in single precision is not quite the same in each step.
    step = k == 0 ? solved : Points(solved + (next - dot(last, solved)) / product * step);
    product = next;
    bending(step, image);
    const double length = next / dot(step, image);
    x += length * step;
    last = residual;
    residual -= length * image;
  }
  return x;
}

}  // namespace lapedit
