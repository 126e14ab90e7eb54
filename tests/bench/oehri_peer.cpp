// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth as-rigid-as-possible deformation: A. Oehri, P. Herholz, O. Sorkine-Hornung, 2025. The energy is a mixture of
// ARAP's and of the difference of rotated Laplacians, so that handles of single vertices make no spikes.
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "lapedit/base/polar_decomposition.h"
#include "peers.h"

namespace quality {
namespace {

using lapedit::Matrix3;
using lapedit::Vector3;
using Sparse = Eigen::SparseMatrix<double>;

/// The interactive setting of the paper.
constexpr double kSmooth = 0.99;

/// Local and global steps with hard constraints, in units in which the mean of the vertices' areas is 1.
class SmoothArap {
 public:
  SmoothArap(const RegionMatrices& problem, Eigen::MatrixXd& positions);
  void next();

 private:
  void fit();
  Eigen::MatrixXd rotated() const;

  struct Edge {
    int from, to;
    double weight;  // half of the cotangent of the angle opposite
  };
  const Eigen::MatrixXd rest_;
  Eigen::MatrixXd& positions_;
  double unit_ = 1;
  std::vector<std::vector<Edge>> around_;  // of each vertex: the edges of its faces, spokes and rims
  Sparse laplacian_, smoothing_;           // L, positive semidefinite; L M^-1
  Eigen::MatrixXd delta_;                  // L p
  std::vector<Matrix3> rotations_;
  std::vector<int> place_;  // of each vertex: its row in the system, or -1 if it is held
  Sparse coupling_;         // of free vertices to all
  Eigen::SimplicialLDLT<Sparse> factor_;
};

double cotangent(const Vector3& a, const Vector3& b) {
  return a.dot(b) / std::max(a.cross(b).norm(), 1e-12 * a.norm() * b.norm());
}

SmoothArap::SmoothArap(const RegionMatrices& problem, Eigen::MatrixXd& positions)
    : rest_(problem.rest), positions_(positions), around_(problem.rest.rows()), rotations_(problem.rest.rows()) {
  const Eigen::Index n = rest_.rows();
  Eigen::VectorXd area = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& f : problem.faces.rowwise()) {
    const Vector3 p[3] = {rest_.row(f[0]), rest_.row(f[1]), rest_.row(f[2])};
    for (int k = 0; k < 3; ++k) {
      const int i = f[(k + 1) % 3], j = f[(k + 2) % 3];
      const Edge edge{i, j, cotangent(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]) / 2};
      area[f[k]] += (p[1] - p[0]).cross(p[2] - p[0]).norm() / 6;
      for (const int corner : {f[0], f[1], f[2]}) around_[corner].push_back(edge);
      entries.insert(entries.end(),
                     {{i, i, edge.weight}, {j, j, edge.weight}, {i, j, -edge.weight}, {j, i, -edge.weight}});
    }
  }
  area = area.cwiseMax(1e-9 * area.mean()) / area.mean();
  laplacian_.resize(n, n);
  laplacian_.setFromTriplets(entries.begin(), entries.end());
  smoothing_ = laplacian_ * area.cwiseInverse().asDiagonal();
  delta_ = laplacian_ * rest_;

  place_.assign(n, 0);
  for (Eigen::Index k = 0; k < problem.held.size(); ++k) {
    place_[problem.held[k]] = -1;
    positions_.row(problem.held[k]) = problem.positions.row(k);
  }
  std::vector<Eigen::Triplet<double>> chosen;
  int free = 0;
  for (int i = 0; i < n; ++i) {
    if (place_[i] >= 0) {
      place_[i] = free;
      chosen.emplace_back(free++, i, 1);
    }
  }
  Sparse choose(free, n);
  choose.setFromTriplets(chosen.begin(), chosen.end());
  const Sparse whole = kSmooth * (smoothing_ * laplacian_) + (1 - kSmooth) * laplacian_;
  coupling_ = choose * whole;
  factor_.compute(coupling_ * Sparse(choose.transpose()));
  if (factor_.info() != Eigen::Success) {
    throw std::runtime_error("the matrix of smooth ARAP could not be factorised");
  }
}

void SmoothArap::fit() {
  for (std::size_t i = 0; i < around_.size(); ++i) {
    Matrix3 covariance = Matrix3::Zero();
    for (const Edge& edge : around_[i]) {
      covariance += edge.weight * (positions_.row(edge.to) - positions_.row(edge.from)).transpose() *
                    (rest_.row(edge.to) - rest_.row(edge.from));
    }
    rotations_[i] = lapedit::polar_rotation(covariance);
  }
}

/// The right-hand side: lambda L M^-1 (R_i delta_i) + (1 - lambda) times ARAP's, of spokes and rims.
Eigen::MatrixXd SmoothArap::rotated() const {
  Eigen::MatrixXd turned(rest_.rows(), 3), edges = Eigen::MatrixXd::Zero(rest_.rows(), 3);
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    turned.row(row) = delta_.row(row) * rotations_[i].transpose();
    for (const Edge& edge : around_[i]) {  // each edge of a face has its three corners
      const Eigen::RowVector3d part =
          edge.weight / 3 * (rest_.row(edge.to) - rest_.row(edge.from)) * rotations_[i].transpose();
      edges.row(edge.to) += part;
      edges.row(edge.from) -= part;
    }
  }
  return kSmooth * (smoothing_ * turned) + (1 - kSmooth) * edges;
}

void SmoothArap::next() {
  fit();
  const Eigen::MatrixXd all = rotated();
  Eigen::MatrixXd held = positions_, right(factor_.rows(), 3);
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (place_[i] >= 0) {
      held.row(static_cast<Eigen::Index>(i)).setZero();
      right.row(place_[i]) = all.row(static_cast<Eigen::Index>(i));
    }
  }
  const Eigen::MatrixXd solved = factor_.solve(right - coupling_ * held);
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (place_[i] >= 0) positions_.row(static_cast<Eigen::Index>(i)) = solved.row(place_[i]);
  }
}

}  // namespace

MethodResult oehri_arap(const Problem& scene) {
  return timed(scene, kArapIterations, [](const RegionMatrices& problem, Eigen::MatrixXd& positions) -> NextFrame {
    const auto arap = std::make_shared<SmoothArap>(problem, positions);
    return [arap] { arap->next(); };
  });
}

}  // namespace quality
