// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/scan.h"

#include <cmath>
#include <limits>

#include "lapedit/base/format_text.h"
#include "lapedit/base/refuse.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {
namespace {

/// Returns whether a surface has no border and encloses a positive volume.
bool encloses_volume(const SurfaceIndex& surface) {
  const Points& p = surface.points();
  double volume = 0;
  for (const auto& face : surface.faces().rowwise()) {
    volume += p.row(face[0]).dot(p.row(face[1]).cross(p.row(face[2])));
  }
  return volume > 0 && !surface.has_border();
}

/// Returns a degenerate face per point.
Faces faces_of_points(Eigen::Index count) {
  return Eigen::VectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1).replicate(1, 3);
}

/// Returns the faces that have an area and finite corners, each once; for a cloud, one degenerate face per finite point
/// that has a normal.
Faces sound_faces(const ScanData& data, bool cloud) {
  const Points& points = data.mesh.vertices;
  Faces faces = cloud ? faces_of_points(points.rows()) : Weld(points).faces(data.mesh.faces);
  if (!cloud) {
    keep_distinct(faces);
  }
  const Eigen::VectorXd sizes = cloud ? Eigen::VectorXd(data.normals.rowwise().norm()) : face_areas(points, faces);
  keep_faces(faces, [&](Eigen::Index f) {
    return sizes[f] > 0 && std::isfinite(sizes[f]) && points.row(faces(f, 0)).allFinite();
  });
  return faces;
}

}  // namespace

Scan::Scan(const ScanData& data) : name_(data.name) {
  const TriangleMesh& mesh = data.mesh;
  const bool cloud = mesh.faces.rows() == 0;
  const std::string subject = "T" + name_.substr(1);
  if (mesh.vertices.rows() == 0) {
    refuse_edit(ErrorCause::EmptyMesh, {}, subject, " has no points: give a mesh, or points with normals.");
  }
  if (cloud && data.normals.rows() != mesh.vertices.rows()) {
    refuse_edit(ErrorCause::BadParameter, {}, subject,
                " has neither faces nor normals: compute normals for its points, or make a mesh of it.");
  }
  if (!cloud) {
    validate(mesh);
  }
  Faces faces = sound_faces(data, cloud);
  if (faces.rows() == 0) {
    refuse_edit(cloud ? ErrorCause::BadParameter : ErrorCause::NotFinite, {}, subject,
                cloud ? " has no point with a normal: compute its normals."
                      : " has no triangle with an area: give the surface of a scan.");
  }
  const SurfaceSize measured = size_of(mesh.vertices, faces);
  origin_ = measured.centroid;
  size_ = measured.size;
  constexpr double kRounding = 1e-12;
  if (!(size_ > kRounding * origin_.norm()) || !std::isfinite(size_)) {
    refuse_edit(ErrorCause::NotFinite, {}, subject, " is a single point or triangle: give the surface of a scan.");
  }
  constexpr double kLargest = 1e60, kSmallest = 1e-60;  // fourth powers of lengths have to be numbers
  if (origin_.norm() > kLargest || size_ > kLargest || size_ < kSmallest) {
    refuse_edit(ErrorCause::BadParameter, {}, subject,
                format_text(" has a size of %.3g at %.3g from the origin, but a fit needs a size above %.0e and "
                            "coordinates below %.0e: use another unit of length.",
                            size_, origin_.norm(), kSmallest, kLargest));
  }
  Points points = (mesh.vertices.rowwise() - origin_.transpose()) / size_;
  axes_ = principal_axes(points, faces);
  // sqrt(area / n): at size 1 a sphere has area 6, a disc 3.
  spacing_ = cloud ? 2 / std::sqrt(static_cast<double>(faces.rows())) : 0;
  surface_ = std::make_unique<SurfaceIndex>(std::move(points), std::move(faces),
                                            cloud ? Points(data.normals.rowwise().normalized()) : Points());
  outward_ = encloses_volume(*surface_);
}

Eigen::MatrixXd carry_over(const TriangleMesh& scan, const Eigen::MatrixXd& values, const Points& at,
                           std::optional<double> within) {
  if (values.rows() != scan.vertices.rows()) {
    refuse_edit(ErrorCause::BadParameter, {}, "The scan has ", scan.vertices.rows(), " vertices, but there are ",
                values.rows(), " rows of values: give one row per vertex.");
  }
  if (within && !(*within >= 0)) {
    refuse_edit(ErrorCause::BadParameter, {}, "The distance up to which values are carried over is ", *within,
                ": give a length of 0 or more, model units.");
  }
  // Unlike in a fit, corners at one position stay apart: at a seam of the texture they have other values.
  const bool cloud = scan.faces.rows() == 0;
  if (!cloud) {
    validate(scan);
  }
  Faces faces = cloud ? faces_of_points(scan.vertices.rows()) : scan.faces;
  keep_faces(faces, [&](Eigen::Index f) {
    const auto corner = [&](int k) { return scan.vertices.row(faces(f, k)); };
    return (cloud || faces(f, 0) != faces(f, 1)) && (corner(0) + corner(1) + corner(2)).allFinite();
  });
  if (faces.rows() == 0) {
    refuse_edit(ErrorCause::EmptyMesh, {}, "The scan has no finite point: give the scan that the mesh was fitted to.");
  }
  constexpr double kShare = 0.02;
  const double most = within.value_or(kShare * size_of(scan.vertices, faces).size);
  const SurfaceIndex surface(scan.vertices, faces, Points::Zero(scan.vertices.rows(), 3));
  Eigen::MatrixXd carried =
      Eigen::MatrixXd::Constant(at.rows(), values.cols(), std::numeric_limits<double>::quiet_NaN());
  ThreadPool pool(0);
  constexpr int kGrain = 256;
  for_indices(pool, static_cast<int>(at.rows()), kGrain, [&](int i) {
    if (!at.row(i).allFinite()) {
      return;
    }
    const NearestPoint found = surface.nearest(at.row(i).transpose());
    if (found.squared <= most * most) {
      const auto corners = faces.row(found.face);
      carried.row(i) = found.weights[0] * values.row(corners[0]) + found.weights[1] * values.row(corners[1]) +
                       found.weights[2] * values.row(corners[2]);
    }
  });
  return carried;
}

}  // namespace lapedit
