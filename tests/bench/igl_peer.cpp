// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <igl/arap.h>
#include <igl/harmonic.h>
#include <igl/min_quad_with_fixed.h>

#include <functional>
#include <stdexcept>
#include <vector>

#include "lapedit/base/stopwatch.h"
#include "table.h"

namespace quality {
namespace {

using lapedit::Vector3;
using lapedit::VertexClass;

/// The region in libigl's types; rows are local vertices.
struct Matrices {
  Eigen::MatrixXd rest;
  Eigen::MatrixXi faces;
  Eigen::VectorXi held;
  Eigen::MatrixXd positions;  ///< where what is held has to be
};

Matrices matrices_of(const Problem& scene) {
  const lapedit::Region& region = scene.region;
  Matrices problem;
  problem.rest.resize(region.size(), 3);
  problem.faces.resize(region.faces.rows(), 3);
  std::vector<char> has_face(region.mesh_vertex.size(), 0);
  int faces = 0;
  for (const auto& f : region.faces.rowwise()) {
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) {
      problem.faces.row(faces++) << f[0], f[1], f[2];
      has_face[f[0]] = has_face[f[1]] = has_face[f[2]] = 1;
    }
  }
  problem.faces.conservativeResize(faces, 3);
  std::vector<int> held;
  for (int i = 0; i < region.size(); ++i) {
    problem.rest.row(i) = scene.edit.mesh.vertices.row(region.mesh_vertex[i]);
    if (region.classes[i] != VertexClass::Free || !has_face[i]) {
      held.push_back(i);
    }
  }
  problem.held = Eigen::Map<Eigen::VectorXi>(held.data(), static_cast<Eigen::Index>(held.size()));
  problem.positions.resize(problem.held.size(), 3);
  for (Eigen::Index k = 0; k < problem.held.size(); ++k) {
    const int i = problem.held[k], group = region.group[i];
    const Vector3 rest = problem.rest.row(i).transpose();
    problem.positions.row(k) = group < 0 ? rest : scene.edit.maps[static_cast<std::size_t>(group)] * rest;
  }
  return problem;
}

void require(bool factorised) {
  if (!factorised) {
    throw std::runtime_error("libigl could not factorise its matrix");
  }
}

/// Prepares, then makes so many frames, each from where the one before ended.
MethodResult timed(const Problem& scene, int count,
                   const std::function<std::function<void()>(const Matrices&, Eigen::MatrixXd&)>& prepare) {
  MethodResult result;
  lapedit::Stopwatch watch;
  const Matrices problem = matrices_of(scene);
  Eigen::MatrixXd positions = problem.rest;
  const std::function<void()> next = prepare(problem, positions);
  result.prepare_ms = watch.lap();
  std::vector<double> frames;
  for (int k = 0; k < count; ++k) {
    lapedit::Stopwatch frame;
    next();
    frames.push_back(frame.elapsed());
  }
  result.solve_ms = watch.elapsed();
  result.frame_ms = table::median(frames);
  result.positions = scene.edit.mesh.vertices;
  for (int i = 0; i < scene.region.size(); ++i) {
    result.positions.row(scene.region.mesh_vertex[i]) = positions.row(i);
  }
  return result;
}

}  // namespace

MethodResult igl_arap(const Problem& scene) {
  igl::ARAPData data;
  data.max_iter = 1;
  return timed(scene, kArapIterations, [&data](const Matrices& problem, Eigen::MatrixXd& positions) {
    require(igl::arap_precomputation(problem.rest, problem.faces, 3, problem.held, data));
    return [&] { require(igl::arap_solve(problem.positions, data, positions)); };
  });
}

MethodResult igl_biharmonic(const Problem& scene) {
  igl::min_quad_with_fixed_data<double> data;
  return timed(scene, 1, [&data](const Matrices& problem, Eigen::MatrixXd& positions) {
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
