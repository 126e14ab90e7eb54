// SPDX-License-Identifier: GPL-3.0-or-later
#include "hover_picture.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pen.h"

using namespace lapedit;

namespace {

void segments(const Points& ends) {
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_DOUBLE, 0, ends.data());
  glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(ends.rows()));
  glDisableClientState(GL_VERTEX_ARRAY);
}

/// Round the point in the surface's tangent plane, where the way along the surface is too far to follow.
void tangentCircle(const HoverPreview& preview, double radius) {
  constexpr int kCorners = 64;
  const Vector3 u = preview.normal.unitOrthogonal(), v = preview.normal.cross(u);
  glBegin(GL_LINES);  // every second corner's: dashes
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kCorners;
    pen::vertex(Vector3(preview.point + radius * (std::cos(angle) * u + std::sin(angle) * v)));
  }
  glEnd();
}

}  // namespace

void drawHover(const HoverPreview& preview, double pixelRatio) {
  using Kind = HoverPreview::Kind;
  if (preview.kind != Kind::Region && preview.kind != Kind::Handle) {
    return;
  }
  constexpr double kShift = 0.9993;  // above the surface that the lines lie in
  glDepthRange(0, kShift);
  const bool flat = !preview.is_whole && !preview.normal.isZero(0);
  if (preview.kind == Kind::Region) {
    pen::rimmed(pen::kLight, 1.2, pixelRatio, [&] {
      segments(preview.region);
      if (flat) {
        tangentCircle(preview, preview.radius);
      }
    });
  }
  if (preview.disc_radius > 0) {
    pen::rimmed(pen::kYellow, 2, pixelRatio, [&] {
      segments(preview.disc);
      if (flat && preview.disc.rows() == 0) {
        tangentCircle(preview, preview.disc_radius);
      }
    });
  } else {
    for (const bool rim : {true, false}) {
      glPointSize(static_cast<GLfloat>((rim ? 10 : 7) * pixelRatio));
      pen::set(rim ? pen::kDark : pen::kYellow, 0.8);
      glBegin(GL_POINTS);
      pen::vertex(preview.point);
      glEnd();
    }
  }
  glDepthRange(0, 1);
}
