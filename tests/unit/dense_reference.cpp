// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense_reference.h"

namespace lapedit::reference {

std::set<std::pair<int, int>> edges_of(const TriangleMesh& mesh, const Region& region) {
  std::vector<int> local(mesh.vertices.rows(), -1);
  for (int i = 0; i < region.size(); ++i) {
    local[region.mesh_vertex[i]] = i;
  }
  std::set<std::pair<int, int>> edges;
  for (const auto& face : mesh.faces.rowwise()) {
    for (int k = 0; k < 9; ++k) {
      const int a = local[face[k % 3]], b = local[face[k / 3]];
      if (a >= 0 && b >= 0 && a != b) {
        edges.insert({a, b});
      }
    }
  }
  return edges;
}

Matrix weights_of(const TriangleMesh& mesh, const Region& region, LaplacianKind kind) {
  const int n = region.size();
  Matrix weights = Matrix::Zero(n, n);
  for (const auto& [a, b] : edges_of(mesh, region)) {
    if (kind == LaplacianKind::Umbrella) {
      weights(a, b) = 1;
      continue;
    }
    for (const auto& face : mesh.faces.rowwise()) {
      const std::set<int> corners(face.begin(), face.end());
      const int u = region.mesh_vertex[a], v = region.mesh_vertex[b];
      for (const int tip : corners) {
        if (tip != u && tip != v && corners.count(u) && corners.count(v)) {
          const Vector3 p = (mesh.vertices.row(u) - mesh.vertices.row(tip)).transpose();
          const Vector3 q = (mesh.vertices.row(v) - mesh.vertices.row(tip)).transpose();
          const Vector3 edge = p - q;
          if (kind == LaplacianKind::Cotangent) {
            weights(a, b) += 1 / std::tan(std::acos(p.dot(q) / (p.norm() * q.norm())));
          } else {
            for (const double cosine :
                 {p.dot(edge) / (p.norm() * edge.norm()), -q.dot(edge) / (q.norm() * edge.norm())}) {
              weights(a, b) += std::tan(std::acos(cosine) / 2) / edge.norm();
            }
          }
        }
      }
    }
    weights(a, b) = std::max(weights(a, b), 0.0);
  }
  return weights;
}

Matrix operator_of(const Matrix& weights) {
  const Eigen::Index n = weights.rows();
  return Matrix::Identity(n, n) - Matrix(weights.rowwise().sum().cwiseInverse().asDiagonal() * weights);
}

double membrane_of(const EditSettings& settings, const Region& region, const Points& rest, const Matrix& weights) {
  const Eigen::Index n = region.faces.rows();
  Eigen::VectorXd areas(n);
  Points centres(n, 3);
  for (Eigen::Index f = 0; f < n; ++f) {
    const Vector3 a = rest.row(region.faces(f, 0)), b = rest.row(region.faces(f, 1)), c = rest.row(region.faces(f, 2));
    areas[f] = (b - a).cross(c - a).norm() / 2;
    centres.row(f) = (a + b + c).transpose() / 3;
  }
  const Eigen::RowVector3d middle = areas.transpose() * centres / areas.sum();
  const double squared_size = 2 * areas.dot((centres.rowwise() - middle).rowwise().squaredNorm()) / areas.sum();
  const double squared_edge = 2 / std::sqrt(3.0) * areas.sum() / static_cast<double>(rest.rows());
  return std::min(settings.membrane * squared_edge / 4 / squared_size, 1.0) / weights.rowwise().sum().mean();
}

Points solve(const TriangleMesh& mesh, const Region& region, const EditSettings& settings, const Points& targets,
             const std::vector<Matrix3>& rotations) {
  const int n = region.size();
  const Points rest = support::rows(mesh.vertices, region.mesh_vertex);
  const Matrix weights = weights_of(mesh, region, settings.laplacian), m = operator_of(weights);
  const auto rotated = [&](int i, int j) -> Vector3 {
    const bool by_edges = settings.method == EditMethod::Default;
    return (by_edges ? Matrix3((rotations[i] + rotations[j]) / 2) : rotations[i]) * Vector3(rest.row(i) - rest.row(j));
  };
  Matrix deltas = Matrix::Zero(n, 3);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (j != i) {
        deltas.row(i) -= m(i, j) * rotated(i, j).transpose();
      }
    }
  }
  const std::set<std::pair<int, int>> edges = edges_of(mesh, region);
  Eigen::VectorXd constraint_weights = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    constraint_weights[i] = region.classes[i] == VertexClass::Handle ? settings.handle_weight * region.weight(i)
                            : region.classes[i] == VertexClass::Anchor
                                ? settings.anchor_weight * region.anchor_weight[i]
                                : 0;
  }
  if (settings.method == EditMethod::Paper && settings.membrane > 0) {  // whole coordinates rotate: no sum of squares
    const double factor = membrane_of(settings, region, rest, weights);
    const Matrix left = m.transpose() + Matrix((factor * weights.rowwise().sum()).asDiagonal());
    const Matrix squared = constraint_weights.cwiseAbs2().asDiagonal();
    return (left * m + squared).ldlt().solve(left * deltas + squared * Matrix(targets));
  }
  const double stretch = settings.membrane > 0 ? membrane_of(settings, region, rest, weights) / 2 : 0;  // each twice
  const Eigen::Index stacked = Eigen::Index{2} * n + (stretch > 0 ? static_cast<Eigen::Index>(edges.size()) : 0);
  Matrix a = Matrix::Zero(stacked, n), b = Matrix::Zero(stacked, 3);
  a.topRows(n) = m;
  b.topRows(n) = deltas;
  for (int k = 1; k < settings.order; ++k) {
    a.topRows(n) = (m * a.topRows(n)).eval();
    b.topRows(n) = (m * b.topRows(n)).eval();
  }
  for (int i = 0; i < n; ++i) {
    a(n + i, i) = constraint_weights[i];
    b.row(n + i) = constraint_weights[i] * targets.row(i);
  }
  Eigen::Index row = Eigen::Index{2} * n;
  for (auto edge = edges.begin(); row < stacked; ++edge, ++row) {
    const auto [i, j] = *edge;
    const double weight = std::sqrt(stretch * weights(i, j));
    a(row, i) = weight;
    a(row, j) = -weight;
    b.row(row) = weight * rotated(i, j).transpose();
  }
  return Eigen::ColPivHouseholderQR<Matrix>(a).solve(b);
}

Points normals(const Points& points, const Faces& faces) {
  Points result = Points::Zero(points.rows(), 3);
  for (const auto& face : faces.rowwise()) {
    const Vector3 a = points.row(face[0]), b = points.row(face[1]), c = points.row(face[2]);
    for (const int v : face) {
      result.row(v) += (b - a).cross(c - a).transpose();
    }
  }
  result.rowwise().normalize();
  return result;
}

namespace {
/// The smoothing kernel of radius r over the region's own graph.
Matrix smoothing(const Region& region, const Points& rest, double r) {
  TriangleMesh graph;  // an edge is a face that names one end twice
  graph.vertices = rest;
  graph.faces.resize(static_cast<Eigen::Index>(region.neighbours.values.size()), 3);
  Eigen::Index row = 0;
  for (int i = 0; i < region.size(); ++i) {
    for (const int j : region.neighbours[i]) {
      graph.faces.row(row++) << i, j, j;
    }
  }
  Matrix result(region.size(), region.size());
  for (int i = 0; i < region.size(); ++i) {
    const std::vector<double> distance = support::bellman_ford(graph, {i});
    for (int j = 0; j < region.size(); ++j) {
      const double t = distance[j] / r;
      result(i, j) = t < 1 ? 2 * t * t * t - 3 * t * t + 1 : 0;
    }
    result.row(i) /= result.row(i).sum();
  }
  return result;
}
}  // namespace

std::vector<Matrix3> paper_rotations(const Region& region, const Points& rest, const Points& unrotated, double r) {
  const Matrix s = smoothing(region, rest, r);
  const Points before = s * normals(rest, region.faces), after = s * normals(unrotated, region.faces);
  std::vector<Matrix3> result(region.size());
  for (int i = 0; i < region.size(); ++i) {
    Matrix3 frame[2];
    const Vector3 n0 = before.row(i).normalized(), n1 = after.row(i).normalized();
    int edge = *region.neighbours[i].begin();
    auto off_tangent = [&](int j) { return std::abs((rest.row(j) - rest.row(i)).normalized().dot(n0)); };
    for (const int j : region.neighbours[i]) {
      edge = off_tangent(j) < off_tangent(edge) ? j : edge;
    }
    const Vector3 e0 = (rest.row(edge) - rest.row(i)).transpose(),
                  e1 = (unrotated.row(edge) - unrotated.row(i)).transpose();
    const Vector3 u0 = n0.cross(e0).cross(n0).normalized(), u1 = n1.cross(e1).cross(n1).normalized();
    frame[0] << n0, u0, n0.cross(u0);
    frame[1] << n1, u1, n1.cross(u1);
    result[i] = frame[1] * frame[0].transpose();
  }
  return result;
}

}  // namespace lapedit::reference
