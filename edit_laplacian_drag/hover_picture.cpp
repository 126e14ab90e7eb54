// SPDX-License-Identifier: GPL-3.0-or-later
#include "hover_picture.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pen.h"

using namespace lapedit;

namespace {

constexpr double kAbove = 0.9993;  // end of the depth range of lines, so that they are in front of the surface

void lines(GLenum mode, const Points& ends) {
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_DOUBLE, 0, ends.data());
  glDrawArrays(mode, 0, static_cast<GLsizei>(ends.rows()));
  glDisableClientState(GL_VERTEX_ARRAY);
}

void segments(const Points& ends) {
  lines(GL_LINES, ends);
}

/// Draws a circle in the tangent plane, for a radius that is too large to follow along the surface.
void tangentCircle(const HoverPreview& preview, double radius) {
  const Vector3 u = preview.normal.unitOrthogonal(), v = preview.normal.cross(u);
  pen::circle(GL_LINES, 64, [&](double angle) {  // every second side: dashes
    return Vector3(preview.point + radius * (std::cos(angle) * u + std::sin(angle) * v));
  });
}

void dot(const Vector3& position, double size, double pixelRatio, double alpha = 0.8) {
  pen::dots(pen::kYellow, size * pixelRatio, alpha, [&] { pen::shape(GL_POINTS, std::initializer_list{position}); });
}

/// Draws the mirror image, paler.
void drawImage(const HoverPreview& preview, double pixelRatio) {
  constexpr double kPale = 0.45;
  pen::rimmed(
      pen::kLight, 1.2, pixelRatio, [&] { segments(preview.mirrored.region); }, kPale);
  pen::rimmed(
      pen::kYellow, 2, pixelRatio, [&] { segments(preview.mirrored.disc); }, kPale);
  if (preview.disc_radius == 0) {
    dot(*preview.mirrored_point, 7, pixelRatio, kPale);
  }
}

}  // namespace

void drawHover(const HoverPreview& preview, double pixelRatio) {
  if (preview.path.rows() > 1) {  // the piece of the curve that a click would add
    glDepthRange(0, kAbove);
    pen::rimmed(pen::kYellow, 2, pixelRatio, [&] { lines(GL_LINE_STRIP, preview.path); });
    glDepthRange(0, 1);
  }
  if (preview.curve_point) {
    dot(*preview.curve_point, 13, pixelRatio);
  }
  using Kind = HoverPreview::Kind;
  if ((preview.kind != Kind::Region && preview.kind != Kind::Handle) || preview.radius == 0) {
    return;
  }
  glDepthRange(0, kAbove);
  if (preview.mirrored_point) {
    drawImage(preview, pixelRatio);
  }
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
    dot(preview.point, 7, pixelRatio);
  }
  glDepthRange(0, 1);
}
