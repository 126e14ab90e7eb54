// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlay.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "gizmo_picture.h"
#include "pen.h"

using namespace lapedit;

namespace {

/// Draws the displacement of the grabbed point, and the locked axis.
void drawMotion(const DragSession& session, double pixelRatio) {
  const DragMotion& motion = *session.motion();
  if (const auto axis = motion.axis()) {
    const double reach = 10 * session.settings().radius;
    const Vector3& position = motion.kind() == MotionKind::Translate ? motion.grab() : motion.center();
    pen::rimmed(pen::axisColor(motion.lock(), session.gizmo_element()), 1, pixelRatio,
                [&] { pen::line<Vector3>(position - reach * *axis, position + reach * *axis); });
  }
  if (motion.kind() == MotionKind::Translate && motion.moves()) {
    const Vector3 moved = session.active_map() * motion.grab();
    pen::rimmed(pen::kYellow, 1.5, pixelRatio, [&] { pen::line(motion.grab(), moved); });
  }
}

/// Draws a line from the active handle's target to where contact stops it, which a solved pose shows.
void drawStop(const DragSession& session, double pixelRatio) {
  constexpr double kVisible = 0.02;  // of the radius
  const ShownRegion& shown = session.shown();
  const Affine map = session.active_map();
  Vector3 target = Vector3::Zero(), stop = Vector3::Zero();
  int count = 0;
  for (int i = 0; i < shown.pose().rows(); ++i) {
    if (shown.region()->group[i] == session.selection().active) {
      target += map * Vector3(session.mesh().vertices.row(shown.region()->mesh_vertex[i]));
      stop += shown.pose().row(i).transpose();
      ++count;
    }
  }
  if ((target - stop).norm() > kVisible * count * session.settings().radius) {
    pen::rimmed(pen::kOrange, 2, pixelRatio, [&] { pen::line<Vector3>(target / count, stop / count); });
  }
}

/// Draws the pivot if no gizmo shows it.
void drawPivot(const DragSession& session, const Camera& view, double pixelRatio) {
  if (session.tools().pivot == Pivot::Centroid || session.selection().active < 0 || session.tools().gizmo ||
      session.motion()) {
    return;
  }
  const Vector2 center = view.pixel(session.pivot_position());
  pen::rimmed(pen::kOrange, 2, pixelRatio, [&] {
    pen::circle(center, 5);
    pen::cross(center, 9);
  });
}

void drawBrush(const Overlay::Brush& brush, const pen::Color& color, double pixelRatio) {
  pen::rimmed(color, 1.5, pixelRatio, [&] { pen::circle(brush.center, brush.radius); });
  pen::rimmed(color, 1.5, pixelRatio, [&] { pen::cross(brush.center, 4, !brush.takes); });
}

/// Returns the colour of the brush's target.
pen::Color brushColor(const DragSession& session) {
  switch (session.tools().paint.value_or(BrushTarget::Region)) {
    case BrushTarget::Handle:
      return pen::groupColor(std::max(session.selection().active, 0));
    case BrushTarget::Anchors:
      return pen::kAnchor;
    case BrushTarget::Region:
      break;
  }
  return pen::kFree;
}

// --- The preview of a press -----------------------------------------------------------------------------------------

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
  pen::dots(pen::kYellow, size * pixelRatio, alpha,
            [&] { pen::shape(GL_POINTS, std::initializer_list<Vector3>{position}); });
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

/// Draws outlines of what a press would pick on the surface; SurfacePicture highlights groups.
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

}  // namespace

/// Draws the mirror plane, as large as the mesh's box.
void Overlay::drawPlane(const DragSession& session, double pixelRatio) {
  if (!box_) {
    box_ = bounding_box(session.original().vertices);
  }
  if (box_->isEmpty()) {
    return;
  }
  const MirrorPlane plane = *session.tools().mirror;
  const Vector3 normal = plane.normal.stableNormalized(), middle = box_->center();
  const Vector3 center = middle - normal.dot(middle - plane.point) * normal;
  Vector3 sides[2];
  int most = 0;
  normal.cwiseAbs().maxCoeff(&most);
  for (int k = 0; k < 2; ++k) {  // along the layer's axes, as far as the plane is parallel to them
    const Vector3 axis = Vector3::Unit((most + 1 + k) % 3);
    sides[k] = (axis - normal.dot(axis) * normal).normalized() * 0.6 * box_->sizes()[(most + 1 + k) % 3];
  }
  const Vector3 corners[] = {center - sides[0] - sides[1], center + sides[0] - sides[1], center + sides[0] + sides[1],
                             center - sides[0] + sides[1]};
  pen::set(pen::kPurple, 0.12);
  pen::shape(GL_QUADS, corners);
  pen::rimmed(
      pen::kPurple, 1, pixelRatio, [&] { pen::shape(GL_LINE_LOOP, corners); }, 0.6);
}

void Overlay::drawGizmoOf(const DragSession& session, const Camera& view, double pixelRatio) {
  const DragMotion* const motion = session.motion();
  if (!motion) {
    gizmo_ = session.gizmo(view);
  } else if (gizmo_) {
    // Keep the gizmo where it was before the motion, since the session would recompute the pivot.
    Gizmo held = place_gizmo(gizmo_->center, GizmoAxes::Layer, Vector3::Zero(), view);
    held.axes = gizmo_->axes;
    gizmo_ = held;
  }
  if (!gizmo_ || (motion && session.gizmo_element() == GizmoElement::None)) {
    return;
  }
  Gizmo shown = *gizmo_;
  if (motion && motion->kind() == MotionKind::Translate) {
    shown.center += motion->transform().translation;
  }
  drawGizmo(shown, view, session.gizmo_element(), motion != nullptr, pixelRatio);
}

void Overlay::draw(const DragSession& session, const Camera& view, const Options& options) {
  const pen::FlatState state;
  const double ratio = options.pixelRatio;
  const HoverPreview* const hover = session.motion() ? nullptr : session.hover();
  const bool onGroup = hover && hover->kind == HoverPreview::Kind::Group;
  if (session.selection().next != Selection::Next::Region) {
    surface_.draw(session, {onGroup ? hover->group : -1, options.colours, ratio});
  }
  if (session.tools().mirror) {
    drawPlane(session, ratio);
  }
  if (hover) {
    drawHover(*hover, ratio);
  }
  glDisable(GL_DEPTH_TEST);
  if (session.motion()) {
    drawMotion(session, ratio);
    if (session.settings().edit.contact && session.shown().away()) {
      drawStop(session, ratio);
    }
  }
  if (view.valid()) {
    const pen::InPixels pixels(options.width, options.height);
    if (session.lasso() != nullptr) {
      pen::rimmed(brushColor(session), 1.5, ratio, [&] { pen::shape(GL_LINE_LOOP, *session.lasso()); });
    } else if (options.brush) {
      drawBrush(*options.brush, brushColor(session), ratio);
    } else {
      drawGizmoOf(session, view, ratio);
      drawPivot(session, view, ratio);
    }
    if (session.motion() && session.motion()->kind() == MotionKind::Rotate) {
      drawTurn(*session.motion(), view, ratio);
    }
  }
}
