// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <vector>

#include "lapedit/base/stopwatch.h"
#include "table.h"

namespace quality {

using lapedit::Vector3;
using lapedit::VertexClass;

RegionMatrices matrices_of(const Problem& scene) {
  const lapedit::Region& region = scene.region;
  RegionMatrices problem;
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
    problem.rest.row(i) = scene.mesh.vertices.row(region.mesh_vertex[i]);
    if (region.classes[i] != VertexClass::Free || !has_face[i]) held.push_back(i);
  }
  problem.held = Eigen::Map<Eigen::VectorXi>(held.data(), static_cast<Eigen::Index>(held.size()));
  problem.positions.resize(problem.held.size(), 3);
  for (Eigen::Index k = 0; k < problem.held.size(); ++k) {
    const int i = problem.held[k], group = region.group[i];
    const Vector3 rest = problem.rest.row(i).transpose();
    problem.positions.row(k) = group < 0 ? rest : scene.maps[static_cast<std::size_t>(group)] * rest;
  }
  return problem;
}

MethodResult timed(const Problem& scene, int count,
                   const std::function<NextFrame(const RegionMatrices&, Eigen::MatrixXd&)>& prepare) {
  MethodResult result;
  lapedit::Stopwatch watch;
  const RegionMatrices problem = matrices_of(scene);
  Eigen::MatrixXd positions = problem.rest;
  const NextFrame next = prepare(problem, positions);
  result.prepare_ms = watch.lap();
  std::vector<double> frames;
  for (int k = 0; k < count; ++k) {
    lapedit::Stopwatch frame;
    next();
    frames.push_back(frame.elapsed());
  }
  result.solve_ms = watch.elapsed();
  result.frame_ms = table::median(frames);
  result.positions = scene.mesh.vertices;
  for (int i = 0; i < scene.region.size(); ++i) {
    result.positions.row(scene.region.mesh_vertex[i]) = positions.row(i);
  }
  return result;
}

}  // namespace quality
