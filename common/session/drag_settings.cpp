// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_settings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "lapedit/base/error.h"
#include "lapedit/session/messages.h"

namespace lapedit {

DragSettings settings_for(const TriangleMesh& mesh) {
  constexpr double kRadiusOfDiagonal = 0.15;
  DragSettings settings;
  const Eigen::AlignedBox3d box = bounding_box(mesh.vertices);
  const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  settings.radius = settings.first_radius = diagonal > 0 ? kRadiusOfDiagonal * diagonal : 1;
  return settings;
}

void validate(const DragSettings& settings) {
  validate(settings.edit);
  constexpr double kLongest = std::numeric_limits<double>::max(), kShortest = std::numeric_limits<double>::denorm_min();
  const struct {
    const char* what;
    double value, low, high;
    const char* wanted;
  } ranges[] = {
      {"region's radius", settings.radius, kShortest, kLongest, "a finite length greater than 0"},
      {"first radius", settings.first_radius, 0, kLongest, "a finite length, or 0 for the radius given"},
      {"padding", settings.padding, 0, 1, "a fraction of the region's radius from 0 to 1"},
      {"handle's size", settings.handle_fraction, 0, kLargestHandleFraction,
       "a number from 0, a single vertex, to 0.9"},
      {"gap to connect pieces over", settings.connect_gap, 0, kLongest, "a finite length, or 0 to leave pieces apart"},
      {"brush's radius", static_cast<double>(settings.brush_pixels), 1, 1000, "1 to 1000 pixels"}};
  for (const auto& range : ranges) {
    if (!(range.value >= range.low && range.value <= range.high)) {
      throw EditError(ErrorCause::BadParameter,
                      format_text(messages::kOutOfRange, range.what, range.value, range.wanted));
    }
  }
}

}  // namespace lapedit
