// SPDX-License-Identifier: GPL-3.0-or-later
//
// CGAL's ARAP for landmark_bench.py: moves vertices of a mesh to targets, and all others with them.
// Reads counts of vertices, faces and landmarks, then these as numbers; writes seconds and the new places.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

#include <cstdio>
#include <iostream>

#include "lapedit/base/stopwatch.h"

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Deformation = CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, CGAL::ORIGINAL_ARAP>;

int main(int argc, char** argv) {
  const unsigned iterations = argc > 1 ? static_cast<unsigned>(std::stoul(argv[1])) : 10;
  std::ios::sync_with_stdio(false);
  std::size_t vertices = 0, faces = 0, landmarks = 0;
  std::cin >> vertices >> faces >> landmarks;
  const auto number = [] {
    double value = 0;
    std::cin >> value;
    return value;
  };
  const auto index = [] {
    Mesh::size_type value = 0;
    std::cin >> value;
    return Mesh::Vertex_index(value);
  };
  const auto point = [&] {
    const double x = number(), y = number();
    return Kernel::Point_3(x, y, number());
  };
  Mesh mesh;
  for (std::size_t k = 0; k < vertices; ++k) {
    mesh.add_vertex(point());
  }
  for (std::size_t k = 0; k < faces; ++k) {
    const auto a = index(), b = index();
    mesh.add_face(a, b, index());
  }
  const lapedit::Stopwatch watch;
  Deformation deformation(mesh);
  deformation.insert_roi_vertices(mesh.vertices_begin(), mesh.vertices_end());
  std::vector<std::pair<Mesh::Vertex_index, Kernel::Point_3>> targets;
  for (std::size_t k = 0; k < landmarks; ++k) {
    const auto vertex = index();
    deformation.insert_control_vertex(vertex);
    targets.emplace_back(vertex, point());
  }
  if (!std::cin || !deformation.preprocess()) {
    std::fprintf(stderr, "landmark_peer: the input is cut off, or CGAL could not factorise its matrix\n");
    return 1;
  }
  for (const auto& [vertex, target] : targets) {
    deformation.set_target_position(vertex, target);
  }
  deformation.deform(iterations, 0.0);
  std::printf("%.6f\n", watch.elapsed() / 1000);
  for (const auto v : mesh.vertices()) {
    std::printf("%.9g %.9g %.9g\n", mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  }
  return 0;
}
