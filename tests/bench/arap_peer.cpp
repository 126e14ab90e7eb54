// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

#include <algorithm>
#include <stdexcept>

namespace quality {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using lapedit::Vector3;
using lapedit::VertexClass;

Mesh::Vertex_index index_of(int v) {
  return Mesh::Vertex_index(static_cast<Mesh::size_type>(v));
}

/// Returns the faces that have an area and make no edge of three faces, with their numbers.
template <class Surface>
std::pair<Surface, std::vector<int>> cgal_mesh(const lapedit::Faces& faces, const lapedit::Points& positions) {
  Surface result;
  std::vector<int> numbers;
  for (const auto& p : positions.rowwise()) {
    result.add_vertex({p[0], p[1], p[2]});
  }
  for (int f = 0; f < faces.rows(); ++f) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    if (a != b && b != c && c != a && result.add_face(index_of(a), index_of(b), index_of(c)).is_valid()) {
      numbers.push_back(f);
    }
  }
  return {std::move(result), std::move(numbers)};
}

template <CGAL::Deformation_algorithm_tag tag>
MethodResult deformed(const Problem& scene, int iterations) {
  const lapedit::TriangleMesh& mesh = scene.mesh;
  const lapedit::Region& region = scene.region;
  using Deformation = CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, tag>;
  Mesh surface = cgal_mesh<Mesh>(mesh.faces, mesh.vertices).first;
  MethodResult result;
  lapedit::Stopwatch watch;
  Deformation deformation(surface);
  // Not what has lost all its faces: its bits stay.
  std::vector<int> handles;  // local
  for (int i = 0; i < region.size(); ++i) {
    const auto v = index_of(region.mesh_vertex[i]);
    if (surface.is_isolated(v)) continue;
    if (region.classes[i] == VertexClass::Free) {
      deformation.insert_roi_vertex(v);
    } else {
      deformation.insert_control_vertex(v);
    }
    if (region.classes[i] == VertexClass::Handle) handles.push_back(i);
  }
  if (!deformation.preprocess()) throw std::runtime_error("CGAL could not factorise its matrix");
  result.prepare_ms = watch.lap();
  for (const int i : handles) {
    const int v = region.mesh_vertex[i];
    const Vector3 target = scene.maps[static_cast<std::size_t>(region.group[i])] * Vector3(mesh.vertices.row(v));
    deformation.set_target_position(index_of(v), Kernel::Point_3(target.x(), target.y(), target.z()));
  }
  // Each alone, as in a drag; they go on from one another.
  std::vector<double> frames;
  for (int k = 0; k < iterations; ++k) {
    lapedit::Stopwatch frame;
    deformation.deform(1, 0.0);
    frames.push_back(frame.elapsed());
  }
  result.solve_ms = watch.elapsed();
  result.frame_ms = table::median(frames);
  result.positions.resize(mesh.vertices.rows(), 3);
  for (const auto v : surface.vertices()) {
    const Kernel::Point_3& p = surface.point(v);
    result.positions.row(static_cast<Eigen::Index>(v)) << p.x(), p.y(), p.z();
  }
  return result;
}

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

}  // namespace

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

MethodResult arap(const Problem& scene, int iterations) {
  return deformed<CGAL::ORIGINAL_ARAP>(scene, iterations);
}

MethodResult smooth_arap(const Problem& scene) {
  return deformed<CGAL::SRE_ARAP>(scene, kArapIterations);
}

std::vector<std::pair<int, int>> intersecting_pairs(const lapedit::Faces& faces, const std::vector<int>& looked_at,
                                                    const lapedit::Points& positions) {
  using Exact = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
  const auto [surface, numbers] = cgal_mesh<Exact>(faces, positions);
  std::vector<std::pair<Exact::Face_index, Exact::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(found));
  std::vector<std::pair<int, int>> result;
  for (const auto& [f, g] : found) {
    const std::pair<int, int> pair = std::minmax(numbers[f], numbers[g]);
    const auto is_looked_at = [&](int face) { return std::binary_search(looked_at.begin(), looked_at.end(), face); };
    if (f != g && (is_looked_at(pair.first) || is_looked_at(pair.second))) result.push_back(pair);
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace quality
