// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/edit/edit.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/region.h"
#include "lapedit/mesh/vertex_set.h"
#include "mesh_support.h"

/// What tests of edits share: solvers, motions, regions built by hand.
namespace lapedit::support {

/// A solver of a region that is ready for poses.
struct Prepared : StepSolver {
  Prepared(const TriangleMesh& mesh, const Region& region, const EditSettings& settings = {},
           const StepOptions& options = {}, const LaplacianSystem* previous = nullptr)
      : StepSolver(mesh, {std::make_shared<const Region>(region)}, settings, options) {
    prepare(mesh, previous);
  }
};

/// Applies a single step.
inline EditResult apply_step(const TriangleMesh& mesh, const EditStep& step, double fraction = 1,
                             StoredScalar scalar = StoredScalar::Double) {
  Edit edit;
  edit.steps = {step};
  return apply_edit(mesh, edit, fraction, scalar);
}

/// The whole mesh's positions after an edit.
inline Points edited(const TriangleMesh& mesh, const EditResult& result) {
  Points positions = mesh.vertices;
  scatter(result.vertices, result.positions, positions);
  return positions;
}

/// Largest angle between two rotations of equal number, radians.
inline double largest_angle(const std::vector<Matrix3>& a, const std::vector<Matrix3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // The chord, not the arc cosine of the trace: that loses half of the digits near zero.
    const double chord = (a[i] - b[i]).norm() / std::sqrt(8.0);
    largest = std::max(largest, 2 * std::asin(std::min(chord, 1.0)));
  }
  return largest;
}

/// How far a matrix is from being a rotation.
inline double rotation_defect(const Matrix3& matrix) {
  return std::max((matrix.transpose() * matrix - Matrix3::Identity()).norm(), std::abs(matrix.determinant() - 1));
}

inline std::shared_ptr<const RestPose> rest_pose(const TriangleMesh& mesh, const Region& region) {
  return std::make_shared<const RestPose>(mesh, std::make_shared<const Region>(region));
}

inline Affine shift(const Vector3& translation) {
  return Affine(Eigen::Translation3d(translation));
}

/// Rotation about an axis through a centre, then a shift.
inline Affine rigid(double degrees, const Vector3& axis, const Vector3& translation,
                    const Vector3& center = Vector3::Zero()) {
  const Eigen::AngleAxisd rotation(degrees * std::acos(-1.0) / 180, axis.normalized());
  return Affine(Eigen::Translation3d(center + translation) * rotation * Eigen::Translation3d(-center));
}

inline Points moved(const Affine& map, const Points& points) {
  return (points * map.linear().transpose()).rowwise() + map.translation().transpose();
}

inline TriangleMesh moved(const Affine& map, const TriangleMesh& mesh) {
  return {moved(map, mesh.vertices), mesh.faces};
}

/// All within a radius of the handles.
inline RegionSpec within(double radius, double padding = RegionSpec().padding) {
  RegionSpec spec;
  spec.radius = radius;
  spec.padding = padding;
  return spec;
}

/// A region of these vertices.
inline RegionSpec given(std::vector<int> vertices, double padding = RegionSpec().padding) {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = std::move(vertices);
  spec.padding = padding;
  return spec;
}

/// The connected components of the handles.
inline RegionSpec component() {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  return spec;
}

inline Region region_of(const TriangleMesh& mesh, const RegionSpec& spec,
                        const std::vector<std::vector<int>>& handles) {
  return build_region(mesh, adjacency_of(mesh), spec, handles);
}

/// The vertices at whose positions a condition holds.
template <typename Condition>
std::vector<int> vertices_where(const TriangleMesh& mesh, Condition holds) {
  std::vector<int> result;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (holds(Vector3(mesh.vertices.row(v)))) result.push_back(v);
  }
  return result;
}

/// The vertices less than a radius away from a point, in a straight line.
inline std::vector<int> around(const TriangleMesh& mesh, const Vector3& point, double radius) {
  return vertices_where(mesh, [&](const Vector3& p) { return (p - point).norm() < radius; });
}

/// Over the sides of all faces.
inline double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      sum += (mesh.vertices.row(face[k]) - mesh.vertices.row(face[(k + 1) % 3])).norm();
    }
  }
  return sum / static_cast<double>(3 * mesh.faces.rows());
}

/// The vertex nearest to a point.
inline int vertex_at(const TriangleMesh& mesh, const Vector3& point) {
  Eigen::Index nearest = 0;
  (mesh.vertices.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

/// A region of all vertices of a mesh, put together without build_region().
/// @param anchors  all of the same weight 1
inline Region whole_region(const TriangleMesh& mesh, const std::vector<std::vector<int>>& handles,
                           const std::vector<int>& anchors) {
  const int n = static_cast<int>(mesh.vertices.rows());
  Region region;
  region.mesh_vertices = n;
  region.mesh_vertex.resize(n);
  std::iota(region.mesh_vertex.begin(), region.mesh_vertex.end(), 0);
  region.classes.assign(n, VertexClass::Free);
  region.group.assign(n, -1);
  region.anchor_weight.assign(n, 0);
  region.anchor_depth.assign(n, 0);
  std::vector<int> seeds;
  for (const int v : anchors) {
    region.classes[v] = VertexClass::Anchor;
    region.anchor_weight[v] = 1;
  }
  for (std::size_t g = 0; g < handles.size(); ++g) {
    for (const int v : handles[g]) {
      region.classes[v] = VertexClass::Handle;
      region.group[v] = static_cast<int>(g);
      seeds.push_back(v);
    }
  }
  region.neighbours = adjacency_of(mesh).neighbours;
  region.faces = mesh.faces;
  region.edge_faces.resize(mesh.faces.rows());
  std::iota(region.edge_faces.begin(), region.edge_faces.end(), 0);
  region.anchored.assign(connected_components(region.neighbours, region.component), 0);
  for (const int v : anchors) region.anchored[region.component[v]] = 1;
  region.distance.resize(n);
  GeodesicSearch search({region.neighbours, mesh.vertices});
  search.run(seeds, kUnreached);
  for (int v = 0; v < n; ++v) {
    region.distance[v] = search.distance(v);
    if (search.distance(v) < kUnreached) {
      region.max_distance = std::max(region.max_distance, search.distance(v));
    }
  }
  region.radius = region.max_distance;
  return region;
}

}  // namespace lapedit::support
