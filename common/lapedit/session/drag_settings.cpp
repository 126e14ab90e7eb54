// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_settings.h"

#include <Eigen/Geometry>
#include <cmath>

#include "lapedit/base/error.h"
#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

constexpr double kRadiusOfDiagonal = 0.15;

double finite_diagonal(const Points& points) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (points.row(i).allFinite()) {
      box.extend(Vector3(points.row(i).transpose()));
    }
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

}  // namespace

DragSettings settings_for(const TriangleMesh& mesh) {
  DragSettings settings;
  const double diagonal = finite_diagonal(mesh.vertices);
  settings.radius = diagonal > 0 ? kRadiusOfDiagonal * diagonal : 1;
  return settings;
}

void validate(const DragSettings& settings) {
  validate(settings.edit);
  const auto refuse = [](const char* what, double value, const char* wanted) {
    throw EditError(ErrorCause::BadParameter, messages::out_of_range(what, value, wanted));
  };
  if (!(settings.radius > 0 && std::isfinite(settings.radius))) {
    refuse("region's radius", settings.radius, "a finite length greater than 0");
  }
  if (!(settings.padding >= 0 && settings.padding <= 1)) {
    refuse("padding", settings.padding, "a share of the region's radius from 0 to 1");
  }
  if (!(settings.handle_share >= 0 && settings.handle_share <= kLargestHandleShare)) {
    refuse("handle's share of the radius", settings.handle_share, "a number from 0, a single vertex, to 0.9");
  }
  if (!(settings.softness >= 0 && settings.softness <= 1)) {
    refuse("handle's softness", settings.softness, "a share of its disc from 0 to 1");
  }
  if (!(settings.connect_gap >= 0 && std::isfinite(settings.connect_gap))) {
    refuse("gap to connect pieces over", settings.connect_gap, "a finite length, or 0 to leave pieces apart");
  }
  if (!(settings.brush_pixels >= 1 && settings.brush_pixels <= 1000)) {
    refuse("brush's radius", settings.brush_pixels, "1 to 1000 pixels");
  }
}

}  // namespace lapedit
