// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bodies.h"
#include "lapedit/fit/fit.h"
#include "mesh_support.h"

/// Templates and scans whose true correspondence is known: a generated surface in two triangulations, and a warp of
/// space.
namespace lapedit::support {

/// A smooth change of a head's shape, some hundredths of its size.
inline Vector3 warped(const Vector3& p) {
  return {p[0] * (1.06 + 0.05 * std::sin(1.9 * p[1])) + 0.04 * std::sin(1.3 * p[2]),
          0.97 * p[1] + 0.05 * std::sin(1.7 * p[0] + 0.4) + 0.03 * std::sin(2.1 * p[2]),
          p[2] * (0.96 + 0.05 * std::cos(1.5 * p[1])) + 0.04 * std::sin(1.6 * p[0])};
}

inline TriangleMesh mapped(TriangleMesh mesh, const SimilarityMap& map) {
  mesh.vertices = map.all(mesh.vertices);
  return mesh;
}

inline TriangleMesh warped(TriangleMesh mesh) {
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices.row(v) = warped(Vector3(mesh.vertices.row(v).transpose())).transpose();
  }
  return mesh;
}

/// A scan without the faces that have a corner where `gone` says so.
template <class Gone>
TriangleMesh without(TriangleMesh mesh, const Gone& gone) {
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    bool keep = true;
    for (int k = 0; k < 3; ++k) {
      keep = keep && !gone(Vector3(mesh.vertices.row(mesh.faces(f, k)).transpose()));
    }
    if (keep) {
      mesh.faces.row(count++) = mesh.faces.row(f);
    }
  }
  mesh.faces.conservativeResize(count, 3);
  return mesh;
}

/// Both meshes as one.
inline TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  mesh.vertices.conservativeResize(a.vertices.rows() + b.vertices.rows(), 3);
  mesh.vertices.bottomRows(b.vertices.rows()) = b.vertices;
  mesh.faces.conservativeResize(a.faces.rows() + b.faces.rows(), 3);
  mesh.faces.bottomRows(b.faces.rows()) = b.faces.array() + static_cast<int>(a.vertices.rows());
  return mesh;
}

struct Fitted {
  TriangleMesh mesh;
  Region region;
  FitResult result;
};

/// Fits a whole template. @param landmarks  vertices of the template, and their positions on the scan
inline Fitted fitted(const TriangleMesh& mesh, const ScanData& scan, const ScanFitSettings& settings = {},
                     const std::vector<std::pair<int, Vector3>>& landmarks = {}, int threads = 1,
                     const Progress& progress = {}) {
  Fitted of;
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  std::vector<int> vertices;
  for (const auto& landmark : landmarks) {
    vertices.push_back(landmark.first);
  }
  std::sort(vertices.begin(), vertices.end());
  of.region = build_region(mesh, adjacency_of(mesh), spec, {vertices.empty() ? std::vector<int>{0} : vertices});
  std::vector<FitLandmark> local;
  for (const auto& [vertex, target] : landmarks) {
    const auto at = std::find(of.region.mesh_vertex.begin(), of.region.mesh_vertex.end(), vertex);
    local.push_back({static_cast<int>(at - of.region.mesh_vertex.begin()), target});
  }
  const Scan surface(scan);
  of.result = fit_template({mesh, of.region, surface, settings, local, {}, threads}, progress);
  of.mesh = mesh;
  for (int i = 0; i < of.region.size(); ++i) {
    of.mesh.vertices.row(of.region.mesh_vertex[i]) = of.result.positions.row(i);
  }
  return of;
}

/// Error of a fit against the true positions, over the size of the shape: mean and largest.
struct FitError {
  double mean = 0, largest = 0;
};
inline FitError error_of(const Fitted& fit, const Points& truth) {
  FitError error;
  const Points centred = truth.rowwise() - truth.colwise().mean();
  const double size = std::sqrt(2 * centred.squaredNorm() / static_cast<double>(truth.rows()));
  for (Eigen::Index v = 0; v < truth.rows(); ++v) {
    const double distance = (fit.mesh.vertices.row(v) - truth.row(v)).norm() / size;
    error.mean += distance / static_cast<double>(truth.rows());
    error.largest = std::max(error.largest, distance);
  }
  return error;
}

}  // namespace lapedit::support
