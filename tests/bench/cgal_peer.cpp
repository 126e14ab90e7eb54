// SPDX-License-Identifier: GPL-3.0-or-later
#include "cgal_peer.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>
#include <CGAL/version.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace speed {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Deformation = CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, CGAL::SRE_ARAP>;

Kernel::Point_3 point(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace

struct CgalPeer::State {
  explicit State(const Scene& s) : scene(s) {}
  const Scene& scene;
  Mesh rest, mesh;
  std::optional<Deformation> deformation;
};

CgalPeer::CgalPeer(const Scene& scene) : state_(std::make_unique<State>(scene)) {
  Mesh& mesh = state_->rest;
  for (const auto& row : scene.mesh.vertices.rowwise()) {
    mesh.add_vertex(point(row.transpose()));
  }
  for (const auto& row : scene.mesh.faces.rowwise()) {
    const auto corner = [&row](int k) { return Mesh::Vertex_index(static_cast<Mesh::size_type>(row[k])); };
    mesh.add_face(corner(0), corner(1), corner(2));
  }
}
CgalPeer::~CgalPeer() = default;

void CgalPeer::reset() {
  State& s = *state_;
  s.deformation.reset();
  s.mesh = s.rest;
  s.deformation.emplace(s.mesh);
  for (const int v : s.scene.region.mesh_vertex) {
    s.deformation->insert_roi_vertex(Mesh::Vertex_index(static_cast<Mesh::size_type>(v)));
  }
  for (const int v : s.scene.anchors()) {
    s.deformation->insert_control_vertex(Mesh::Vertex_index(static_cast<Mesh::size_type>(v)));
  }
  s.deformation->insert_control_vertex(Mesh::Vertex_index(static_cast<Mesh::size_type>(s.scene.handle_vertex())));
}

bool CgalPeer::preprocess() {
  return state_->deformation->preprocess();
}

void CgalPeer::frame(const lapedit::Affine& handle) {
  State& s = *state_;
  const int v = s.scene.handle_vertex();
  const Eigen::Vector3d target = handle * s.scene.mesh.vertices.row(v).transpose();
  s.deformation->set_target_position(Mesh::Vertex_index(static_cast<Mesh::size_type>(v)), point(target));
  s.deformation->deform(1, 0.0);
}

double CgalPeer::control_error(const lapedit::Affine& handle) const {
  const State& s = *state_;
  const auto now = [&s](int v) {
    const Kernel::Point_3& p = s.mesh.point(Mesh::Vertex_index(static_cast<Mesh::size_type>(v)));
    return Eigen::Vector3d(p.x(), p.y(), p.z());
  };
  const auto before = [&s](int v) { return Eigen::Vector3d(s.scene.mesh.vertices.row(v).transpose()); };
  const int h = s.scene.handle_vertex();
  double error = (now(h) - handle * before(h)).norm();
  for (const int v : s.scene.anchors()) {
    error = std::max(error, (now(v) - before(v)).norm());
  }
  for (const int v : s.scene.adjacency.neighbours[h]) {
    if (!((now(v) - before(v)).norm() > 0.1 * (now(h) - before(h)).norm())) {
      return std::numeric_limits<double>::infinity();
    }
  }
  for (const auto v : s.mesh.vertices()) {
    const Kernel::Point_3& p = s.mesh.point(v);
    if (!std::isfinite(p.x() + p.y() + p.z())) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return error;
}

std::string cgal_version() {
  return CGAL_VERSION_STR;
}

}  // namespace speed
