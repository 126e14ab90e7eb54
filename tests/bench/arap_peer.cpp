// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

#include <stdexcept>

#include "lapedit/base/stopwatch.h"
#include "table.h"

namespace quality {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using lapedit::Vector3;
using lapedit::VertexClass;

Mesh::Vertex_index index_of(int v) {
  return Mesh::Vertex_index(static_cast<Mesh::size_type>(v));
}

Mesh cgal_mesh(const lapedit::TriangleMesh& mesh) {
  Mesh result;
  for (const auto& p : mesh.vertices.rowwise()) {
    result.add_vertex({p[0], p[1], p[2]});
  }
  for (const auto& f : mesh.faces.rowwise()) {
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) {
      result.add_face(index_of(f[0]), index_of(f[1]), index_of(f[2]));
    }
  }
  return result;
}

template <CGAL::Deformation_algorithm_tag tag>
MethodResult deformed(const Problem& scene, int iterations) {
  const lapedit::TriangleMesh& mesh = scene.mesh;
  const lapedit::Region& region = scene.region;
  using Deformation = CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, tag>;
  Mesh surface = cgal_mesh(mesh);
  MethodResult result;
  lapedit::Stopwatch watch;
  Deformation deformation(surface);
  // Not what has lost all its faces: its bits stay.
  std::vector<int> handles;  // local
  for (int i = 0; i < region.size(); ++i) {
    const auto v = index_of(region.mesh_vertex[i]);
    if (surface.is_isolated(v)) {
      continue;
    }
    if (region.classes[i] == VertexClass::Free) {
      deformation.insert_roi_vertex(v);
    } else {
      deformation.insert_control_vertex(v);
    }
    if (region.classes[i] == VertexClass::Handle) {
      handles.push_back(i);
    }
  }
  if (!deformation.preprocess()) {
    throw std::runtime_error("CGAL could not factorise its matrix");
  }
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

}  // namespace

MethodResult arap(const Problem& scene, int iterations) {
  return deformed<CGAL::ORIGINAL_ARAP>(scene, iterations);
}

MethodResult smooth_arap(const Problem& scene) {
  return deformed<CGAL::SRE_ARAP>(scene, kArapIterations);
}

}  // namespace quality
