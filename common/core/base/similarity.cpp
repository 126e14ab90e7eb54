// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/similarity.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {

SimilarityMap best_similarity(const Points& from, const Points& to, double scale, const Eigen::VectorXd& weights) {
  const Eigen::VectorXd w = weights.size() > 0 ? weights : Eigen::VectorXd::Ones(from.rows());
  const Vector3 middle = from.transpose().lazyProduct(w) / w.sum(), target = to.transpose().lazyProduct(w) / w.sum();
  const Points centred = from.rowwise() - middle.transpose();
  const Matrix3 product = (w.asDiagonal() * (to.rowwise() - target.transpose())).transpose().lazyProduct(centred);
  const double spread = w.dot(centred.rowwise().squaredNorm());
  SimilarityMap map;
  map.rotation = polar_rotation(product);
  const double along = map.rotation.cwiseProduct(product).sum();
  map.scale = scale > 0 ? scale : spread > 0 && along > 0 ? along / spread : 1;
  map.translation = target - map.scale * (map.rotation * middle);
  return map;
}

SimilarityMap point_to_plane_step(const SimilarityMap& map, const PointsToPlanes& pairs, bool scaled) {
  constexpr double kDamping = 0.02;  // a rotation that hardly matters, as about the axis of a vase, is not made
  Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero(), row;
  for (Eigen::Index k = 0; k < pairs.from.rows(); ++k) {
    if (pairs.weights[k] > 0) {
      const Vector3 normal = pairs.normals.row(k).transpose(), here = map(Vector3(pairs.from.row(k).transpose()));
      row << here.cross(normal), normal, scaled ? here.dot(normal) : 0;
      matrix += pairs.weights[k] * row * row.transpose();
      right += pairs.weights[k] * normal.dot(pairs.to.row(k).transpose() - here) * row;
    }
  }
  matrix.diagonal().array() += kDamping * matrix.trace();
  const Eigen::Matrix<double, 7, 1> step = matrix.llt().solve(right);
  Matrix3 turn = Matrix3::Identity();
  turn << 1, -step[2], step[1], step[2], 1, -step[0], -step[1], step[0], 1;
  turn = polar_rotation(turn);
  const double scale = std::clamp(1 + step[6], 0.8, 1.25);
  return {turn * map.rotation, scale * map.scale, scale * (turn * map.translation) + step.segment<3>(3)};
}

}  // namespace lapedit
