// SPDX-License-Identifier: GPL-3.0-or-later
//
// CGAL's ARAP for landmark_bench.py: moves vertices of a mesh to targets, and all others with them.
// Reads counts of vertices, faces and landmarks, then these as numbers; writes seconds and the new positions.
#include <Eigen/Geometry>
#include <cstdio>
#include <exception>
#include <iostream>

#include "peers.h"

int main() {
  std::ios::sync_with_stdio(false);
  Eigen::Index vertices = 0, faces = 0, landmarks = 0;
  std::cin >> vertices >> faces >> landmarks;
  quality::Edit edit;
  edit.region.kind = lapedit::RegionSpec::Kind::Component;
  edit.mesh.vertices.resize(vertices, 3);
  edit.mesh.faces.resize(faces, 3);
  for (double& number : edit.mesh.vertices.reshaped<Eigen::RowMajor>()) {
    std::cin >> number;
  }
  for (int& number : edit.mesh.faces.reshaped<Eigen::RowMajor>()) {
    std::cin >> number;
  }
  for (Eigen::Index k = 0; k < landmarks; ++k) {
    int vertex = 0;
    lapedit::Vector3 target;
    std::cin >> vertex >> target[0] >> target[1] >> target[2];
    edit.handles.push_back({vertex});
    edit.maps.emplace_back(Eigen::Translation3d(target - edit.mesh.vertices.row(vertex).transpose()));
  }
  try {
    const quality::MethodResult result = quality::arap(quality::Problem(std::move(edit)));
    std::printf("%.6f\n", (result.prepare_ms + result.solve_ms) / 1000);
    for (const auto& p : result.positions.rowwise()) {
      std::printf("%.9g %.9g %.9g\n", p[0], p[1], p[2]);
    }
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "landmark_peer: %s\n", problem.what());
    return 1;
  }
  return 0;
}
