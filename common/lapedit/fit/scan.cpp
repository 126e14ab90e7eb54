// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/scan.h"

#include <algorithm>
#include <cmath>

#include "lapedit/base/error.h"
#include "lapedit/mesh/patch_border.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_grid.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {
namespace {

bool is_point(const Faces& faces, Eigen::Index f) {
  return faces(f, 0) == faces(f, 1);
}

double area_of(const Points& points, const Faces& faces, Eigen::Index f) {
  const Vector3 a = points.row(faces(f, 0)).transpose();
  const Vector3 ab = points.row(faces(f, 1)).transpose() - a, ac = points.row(faces(f, 2)).transpose() - a;
  return 0.5 * ab.cross(ac).norm();
}

/// Returns the faces that have an area and finite corners.
Faces sound_faces(const TriangleMesh& mesh) {
  const Faces faces = Weld(mesh.vertices).faces(mesh.faces);
  Faces sound(faces.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const double area = area_of(mesh.vertices, faces, f);
    if (area > 0 && std::isfinite(area)) {
      sound.row(count++) = faces.row(f);
    }
  }
  sound.conservativeResize(count, 3);
  return sound;
}

/// Returns a face per point that is finite and has a normal.
Faces point_faces(const ScanData& data) {
  Faces faces(data.mesh.vertices.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index v = 0; v < data.mesh.vertices.rows(); ++v) {
    const double length = data.normals.row(v).norm();
    if (data.mesh.vertices.row(v).allFinite() && std::isfinite(length) && length > 0) {
      faces.row(count++).setConstant(static_cast<int>(v));
    }
  }
  faces.conservativeResize(count, 3);
  return faces;
}

/// Returns the median distance of some points to their nearest neighbours.
double spacing_of(const SurfaceShape& cloud) {
  constexpr Eigen::Index kProbes = 1000;
  std::vector<int> usable(static_cast<std::size_t>(cloud.faces.rows()));
  for (std::size_t k = 0; k < usable.size(); ++k) {
    usable[k] = cloud.faces(static_cast<Eigen::Index>(k), 0);
  }
  const VertexGrid grid(cloud.points, usable);
  std::vector<double> distances;
  const auto step = static_cast<std::size_t>(std::max<Eigen::Index>(1, cloud.faces.rows() / kProbes));
  for (std::size_t k = 0; k < usable.size(); k += step) {
    const Vector3 point = cloud.points.row(usable[k]).transpose();
    const int other = grid.nearest(point, 1e9, [&](int v) { return cloud.points.row(v).transpose() != point; });
    if (other >= 0) {
      distances.push_back((cloud.points.row(other).transpose() - point).norm());
    }
  }
  if (distances.empty()) {
    return 1;
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace

std::vector<char> border_vertices(Eigen::Index vertices, const Faces& faces) {
  std::vector<char> border(static_cast<std::size_t>(vertices), 0);
  const std::vector<unsigned> corners(faces.data(), faces.data() + faces.size());
  for (const auto& [a, b] : single_edges(corners)) {
    border[a] = border[b] = 1;
  }
  return border;
}

bool SurfaceShape::ends_at(const NearestPoint& at) const {
  int corners = 0;
  bool all = true;
  for (int k = 0; k < 3; ++k) {
    if (at.weights[k] != 0) {
      ++corners;
      all = all && border[static_cast<std::size_t>(faces(at.face, k))] != 0;
    }
  }
  return corners < 3 && all;
}

SurfaceSize size_of(const SurfaceShape& surface) {
  double area = 0, squares = 0;
  Vector3 sum = Vector3::Zero();
  const auto each = [&](const auto& use) {
    for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
      const double weight = is_point(surface.faces, f) ? 1 : area_of(surface.points, surface.faces, f);
      const Vector3 middle = (surface.points.row(surface.faces(f, 0)) + surface.points.row(surface.faces(f, 1)) +
                              surface.points.row(surface.faces(f, 2)))
                                 .transpose() /
                             3;
      use(weight, middle);
    }
  };
  each([&](double weight, const Vector3& middle) {
    area += weight;
    sum += weight * middle;
  });
  SurfaceSize result;
  result.centroid = sum / area;
  each([&](double weight, const Vector3& middle) { squares += weight * (middle - result.centroid).squaredNorm(); });
  result.size = std::sqrt(2 * squares / area);
  return result;
}

SurfaceSamples samples_of(const SurfaceShape& surface, int count) {
  SurfaceSamples samples;
  const Eigen::Index faces = surface.faces.rows();
  const bool cloud = is_point(surface.faces, 0);
  std::vector<double> ends(static_cast<std::size_t>(faces));
  double total = 0;
  for (Eigen::Index f = 0; f < faces; ++f) {
    total += cloud ? 1 : area_of(surface.points, surface.faces, f);
    ends[static_cast<std::size_t>(f)] = total;
  }
  count = cloud ? static_cast<int>(std::min<Eigen::Index>(count, faces)) : count;
  samples.points.resize(count, 3);
  samples.normals.resize(count, 3);
  std::size_t f = 0;
  double u = 0.5, v = 0.5;  // the sequence of M. Roberts, The unreasonable effectiveness of quasirandom sequences
  for (int k = 0; k < count; ++k) {
    const double at = total * (k + 0.5) / count;
    while (f + 1 < ends.size() && ends[f] <= at) {
      ++f;
    }
    u += 0.75487766624669276;
    v += 0.56984029099805327;
    u -= std::floor(u);
    v -= std::floor(v);
    NearestPoint sample;
    sample.face = static_cast<int>(f);
    sample.weights = cloud ? Vector3::UnitX() : u + v > 1 ? Vector3(u + v - 1, 1 - u, 1 - v) : Vector3(1 - u - v, u, v);
    Vector3 point = Vector3::Zero(), normal = Vector3::Zero();
    for (int c = 0; c < 3; ++c) {
      const int vertex = surface.faces(sample.face, c);
      point += sample.weights[c] * surface.points.row(vertex).transpose();
      normal += sample.weights[c] * surface.normals.row(vertex).transpose();
    }
    const double length = normal.norm();
    samples.points.row(k) = point.transpose();
    samples.normals.row(k) = length > 0 ? Eigen::RowVector3d(normal.transpose() / length) : Eigen::RowVector3d::Zero();
    samples.at.push_back(sample);
  }
  return samples;
}

Scan::Scan(const ScanData& data) : name_(data.name) {
  const TriangleMesh& mesh = data.mesh;
  if (mesh.vertices.rows() == 0) {
    throw EditError(ErrorCause::EmptyMesh, name_ + " has no points: give a mesh, or points with normals.");
  }
  const bool cloud = mesh.faces.rows() == 0;
  if (cloud && data.normals.rows() != mesh.vertices.rows()) {
    throw EditError(ErrorCause::BadParameter,
                    name_ + " has neither faces nor normals: compute normals for its points, or make a mesh of it.");
  }
  if (!cloud) {
    validate(mesh);
  }
  surface_.points = mesh.vertices;
  surface_.faces = cloud ? point_faces(data) : sound_faces(mesh);
  if (surface_.faces.rows() == 0) {
    throw EditError(cloud ? ErrorCause::BadParameter : ErrorCause::NotFinite,
                    name_ + (cloud ? " has no point with a normal: compute its normals."
                                   : " has no triangle with an area: give the surface of a scan."));
  }
  const SurfaceSize measured = size_of(surface_);
  origin_ = measured.centroid;
  size_ = measured.size;
  if (!(size_ > 0) || !std::isfinite(size_)) {
    throw EditError(ErrorCause::NotFinite, name_ + " is a single point: give the surface of a scan.");
  }
  surface_.points = (surface_.points.rowwise() - origin_.transpose()) / size_;
  if (cloud) {
    surface_.normals = Points::Zero(mesh.vertices.rows(), 3);
    for (Eigen::Index f = 0; f < surface_.faces.rows(); ++f) {
      const int v = surface_.faces(f, 0);
      surface_.normals.row(v) = data.normals.row(v) / data.normals.row(v).norm();
    }
    surface_.border.assign(static_cast<std::size_t>(mesh.vertices.rows()), 0);
    spacing_ = spacing_of(surface_);
  } else {
    vertex_normals(surface_.points, surface_.faces, surface_.normals);
    surface_.border = border_vertices(surface_.points.rows(), surface_.faces);
  }
  tree_ = std::make_unique<SurfaceTree>(surface_.points, surface_.faces);
}

}  // namespace lapedit
