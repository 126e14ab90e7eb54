// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/carry_over.h"

#include <limits>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/surface_index.h"

namespace lapedit {
namespace {

/// Returns the faces with finite corners; of a scan without faces its finite points. Unlike those of a fit, corners at
/// one position stay apart: at a seam of the texture they have other values.
Faces finite_faces(const TriangleMesh& scan) {
  const Eigen::Index n = scan.vertices.rows();
  Faces faces = scan.faces;
  if (faces.rows() == 0) {
    faces = Eigen::VectorXi::LinSpaced(n, 0, static_cast<int>(n) - 1).replicate(1, 3);
  }
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const bool is_face = scan.faces.rows() == 0 || faces(f, 0) != faces(f, 1);
    const auto corners = faces.row(f);
    if (is_face &&
        (scan.vertices.row(corners[0]) + scan.vertices.row(corners[1]) + scan.vertices.row(corners[2])).allFinite()) {
      faces.row(count++) = faces.row(f);
    }
  }
  faces.conservativeResize(count, 3);
  return faces;
}

}  // namespace

Eigen::MatrixXd carry_over(const TriangleMesh& scan, const Eigen::MatrixXd& values, const Points& at,
                           std::optional<double> within) {
  if (values.rows() != scan.vertices.rows()) {
    throw EditError(ErrorCause::BadParameter, "The scan has " + std::to_string(scan.vertices.rows()) +
                                                  " vertices, but there are " + std::to_string(values.rows()) +
                                                  " rows of values: give one row per vertex.");
  }
  if (within && !(*within >= 0)) {
    throw EditError(ErrorCause::BadParameter, "The distance up to which values are carried over is " +
                                                  number_text(*within) + ": give a length of 0 or more, model units.");
  }
  if (scan.faces.rows() > 0) {
    validate(scan);
  }
  const Faces faces = finite_faces(scan);
  if (faces.rows() == 0) {
    throw EditError(ErrorCause::EmptyMesh, "The scan has no finite point: give the scan that the mesh was fitted to.");
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
