// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlay.h"

#include <Eigen/Geometry>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "lapedit/base/whole_part.h"

using namespace lapedit;

namespace {

/// Makes OpenGL draw flat colours.
void beginFlat() {
  // Otherwise OpenGL would read buffers that MeshLab left bound in place of our arrays.
  if (QOpenGLContext* context = QOpenGLContext::currentContext()) {
    context->functions()->glUseProgram(0);
    context->functions()->glBindBuffer(GL_ARRAY_BUFFER, 0);
    context->functions()->glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, 0);
  }
  for (const GLenum unused : {GL_LIGHTING, GL_TEXTURE_2D, GL_CULL_FACE}) {
    glDisable(unused);
  }
  for (const GLenum used : {GL_DEPTH_TEST, GL_BLEND, GL_POINT_SMOOTH, GL_LINE_SMOOTH}) {
    glEnable(used);
  }
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glShadeModel(GL_SMOOTH);
}

/// Draws the displacement of the grabbed point, and the locked axis.
void drawMotion(const DragSession& session) {
  const DragMotion& motion = *session.motion();
  if (const auto axis = motion.axis()) {
    const double reach = 10 * session.settings().radius;
    const Vector3& position = motion.kind() == MotionKind::Translate ? motion.grab() : motion.center();
    const int number = motion.lock() == AxisLock::Gizmo
                           ? axis_number(session.gizmo_element())
                           : static_cast<int>(motion.lock()) - static_cast<int>(AxisLock::X);
    pen::rimmed(number >= 0 && number < 3 ? pen::axisColor(number) : pen::kLight, 1,
                [&] { pen::line<Vector3>(position - reach * *axis, position + reach * *axis); });
  }
  if (motion.kind() == MotionKind::Translate && motion.moves()) {
    const Vector3 moved = session.active_map() * motion.grab();
    pen::rimmed(pen::kYellow, 1.5, [&] { pen::line(motion.grab(), moved); });
  }
}

/// Draws a line from the active handle's target to where contact stops it, which a solved pose shows.
void drawStop(const DragSession& session) {
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
    pen::rimmed(pen::kOrange, 2, [&] { pen::line<Vector3>(target / count, stop / count); });
  }
}

/// Draws the pivot if no gizmo shows it.
void drawPivot(const DragSession& session, const Camera& view) {
  if (session.tools().pivot == Pivot::Centroid || session.selection().active < 0 || session.tools().gizmo ||
      session.motion()) {
    return;
  }
  const Vector2 center = view.pixel(session.pivot_position());
  pen::rimmed(pen::kOrange, 2, [&] {
    pen::circle(center, 5);
    pen::cross(center, 9);
  });
}

/// Returns the colour of the brush's target.
pen::Color brushColor(const DragSession& session) {
  const BrushTarget target = session.tools().paint.value_or(BrushTarget::Region);
  return target == BrushTarget::Handle    ? pen::groupColor(std::max(session.selection().active, 0))
         : target == BrushTarget::Anchors ? pen::kAnchor
                                          : pen::kFree;
}

// --- The gizmo -------------------------------------------------------------------------------------------------------

constexpr double kHeadLength = 15, kHeadWidth = 6, kScale = 5.5, kCross = 5;
constexpr int kCorners = 72;
constexpr double kStep = 2 * 3.14159265358979 / kCorners;

struct Picture {
  const Gizmo& gizmo;
  const Camera& view;
};

void arrow(const Picture& p, int axis, bool bright) {
  const Vector2 center = p.view.pixel(p.gizmo.center);
  const Vector2 from = p.view.pixel(p.gizmo.along(axis, Gizmo::kFree));
  const Vector2 tip = p.view.pixel(p.gizmo.along(axis, Gizmo::kTip));
  const Vector2 direction = (tip - center).stableNormalized(), side(-direction.y(), direction.x());
  // The head is shortened in proportion to the arrow.
  const double seen = std::min((tip - center).norm() / (Gizmo::kTip * 90), 1.0);
  const Vector2 neck = tip - kHeadLength * std::max(seen, 0.4) * direction;
  const double half = bright ? kHeadWidth + 1.5 : kHeadWidth;
  const pen::Color color = bright ? pen::kYellow : pen::axisColor(axis);
  const Vector2 head[] = {tip, neck + half * side, neck - half * side};
  pen::rimmed(color, bright ? 4 : 2.5, [&] { pen::line(from, neck); });
  pen::rimmed(color, 1, [&] {
    pen::shape(GL_TRIANGLES, head);
    pen::shape(GL_LINE_LOOP, head);
  });
  if (p.gizmo.axes == Matrix3::Identity()) {  // the layer's: X, Y or Z, for users who cannot distinguish the colours
    const std::vector<Vector2> letters[] = {{{-3, -4}, {3, 4}, {-3, 4}, {3, -4}},
                                            {{-3, -4}, {0, 0}, {3, -4}, {0, 0}, {0, 0}, {0, 4}},
                                            {{-3, -4}, {3, -4}, {3, -4}, {-3, 4}, {-3, 4}, {3, 4}}};
    std::vector<Vector2> ends = letters[axis];
    for (Vector2& end : ends) {
      end += tip + 11 * direction;
    }
    pen::rimmed(pen::kLight, 1.3, [&] { pen::shape(GL_LINES, ends); });
  }
}

/// Draws the half of a ring that is nearer to the viewer, or the other half.
void ring(const Picture& p, int axis, bool front, bool bright) {
  const Vector3 sight = p.view.toward_viewer(p.gizmo.center);
  const auto draw = [&](GLenum mode) {
    glBegin(mode);
    for (int i = 0; i < kCorners; ++i) {
      const Vector3 from = p.gizmo.on_ring(axis, i * kStep), to = p.gizmo.on_ring(axis, (i + 1) * kStep);
      // Sides in the plane of the picture belong to the nearer half.
      const bool isFront = ((from + to) / 2 - p.gizmo.center).dot(sight) > -0.02 * p.gizmo.length;
      if (isFront == front) {
        pen::vertex(p.view.pixel(from));
        pen::vertex(p.view.pixel(to));
      }
    }
    glEnd();
  };
  const pen::Color color = bright ? pen::kYellow : pen::axisColor(axis);
  if (front) {
    const double width = bright ? 4 : 2.5;
    pen::rimmed(color, width, [&] { draw(GL_LINES); });
    pen::setSize(width);  // covers the joints of the line, where the rim would show
    draw(GL_POINTS);
  } else {
    pen::setWidth(1.5);
    pen::set(color, bright ? 0.7 : 0.35);
    draw(GL_LINES);
  }
}

void scaleHandle(const Picture& p, bool bright) {
  const Vector2 at = p.view.pixel(p.gizmo.scale_handle(p.view));
  const double half = bright ? kScale + 1.5 : kScale;
  const Vector2 center = p.view.pixel(p.gizmo.center);
  pen::setWidth(1);
  pen::set(pen::kLight, 0.5);
  pen::line(Vector2(center + Gizmo::kRing / Gizmo::kScale * (at - center)), at);
  const Vector2 across(half, 0), up(0, half);
  const Vector2 square[] = {at - across - up, at + across - up, at + across + up, at - across + up};
  pen::rimmed(bright ? pen::kYellow : pen::kLight, 1, [&] {
    pen::shape(GL_QUADS, square);
    pen::shape(GL_LINE_LOOP, square);
  });
}

/// Draws a gizmo, in pixels. @param element  under the cursor or held, highlighted
/// @param alone  draws only that element, which the user drags
void drawGizmo(const Gizmo& gizmo, const Camera& view, GizmoElement element, bool alone) {
  if (!gizmo.center.allFinite() || !view.in_front(gizmo.center)) {
    return;
  }
  const Picture p{gizmo, view};
  const auto is = [element](GizmoElement first, int axis) {
    return element == static_cast<GizmoElement>(static_cast<int>(first) + axis);
  };
  const auto shown = [&](GizmoElement first, int axis) { return !alone || is(first, axis); };
  for (const bool front : {false, true}) {
    for (int axis = 0; axis < 3; ++axis) {
      if (shown(GizmoElement::TurnX, axis) && (alone || gizmo.ring_is_seen(axis, view))) {
        ring(p, axis, front, is(GizmoElement::TurnX, axis));
      }
    }
    // Arrows that point away are behind the rings' near halves.
    for (int axis = 0; axis < 3; ++axis) {
      const bool towards = gizmo.axes.col(axis).dot(view.toward_viewer(gizmo.center)) > 0;
      if (shown(GizmoElement::MoveX, axis) && towards == front && gizmo.arrow_is_seen(axis, view)) {
        arrow(p, axis, is(GizmoElement::MoveX, axis));
      }
    }
  }
  if (alone ? element == GizmoElement::Scale : !gizmo.only_arrows) {
    scaleHandle(p, element == GizmoElement::Scale);
  }
  pen::rimmed(pen::kLight, 1.3, [&] { pen::cross(view.pixel(gizmo.center), kCross); });  // the pivot
}

/// Draws the angle of a rotation, from where the mouse started; in pixels.
void drawTurn(const DragMotion& motion, const Camera& view) {
  const HandleTransform turn = motion.transform();
  const double radius = Gizmo::kRing * place_gizmo(motion.center(), GizmoAxes::Layer, Vector3::Zero(), view).length;
  const Vector3 side = turn.axis.cross(motion.arm());
  if (motion.arm().isZero(0) || !view.in_front(motion.center())) {
    return;
  }
  constexpr double kRadians = 3.14159265358979 / 180;
  const auto at = [&](double degrees, double fraction) {
    const double angle = kRadians * degrees;
    const Vector3 direction = std::cos(angle) * motion.arm() + std::sin(angle) * side;
    return view.pixel(motion.center() + fraction * radius * direction);
  };
  const double degrees = std::clamp(turn.degrees, -360.0, 360.0);
  const int corners = 1 + whole_part(std::abs(degrees) / 4, 0, 90);
  std::vector<Vector2> fan = {view.pixel(motion.center())};
  for (int i = 0; i <= corners; ++i) {
    fan.push_back(at(degrees * i / corners, 1));
  }
  pen::set(pen::kYellow, 0.3);
  pen::shape(GL_TRIANGLE_FAN, fan);
  const auto line = [&](double angle, double from, double to) { pen::line(at(angle, from), at(angle, to)); };
  pen::rimmed(pen::kLight, 1, [&] { line(0, 0, 1); });
  pen::rimmed(pen::kYellow, 1.5, [&] { line(turn.degrees, 0, 1); });
  for (double tick = 0; motion.step() > 0 && tick < 360; tick += motion.step()) {
    pen::rimmed(pen::kLight, 1, [&] { line(tick, 1.03, 1.1); });
  }
}

// --- The preview of a press -----------------------------------------------------------------------------------------

void lines(GLenum mode, const Points& ends) {
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_DOUBLE, 0, ends.data());
  glDrawArrays(mode, 0, static_cast<GLsizei>(ends.rows()));
  glDisableClientState(GL_VERTEX_ARRAY);
}

/// Draws a circle in the tangent plane, for a radius that is too large to follow along the surface.
void tangentCircle(const HoverPreview& preview, double radius) {
  const Vector3 u = preview.normal.unitOrthogonal(), v = preview.normal.cross(u);
  pen::circle(GL_LINES, 64, [&](double angle) {  // every second side: dashes
    return Vector3(preview.point + radius * (std::cos(angle) * u + std::sin(angle) * v));
  });
}

void dot(const Vector3& position, double size, double alpha = 0.8) {
  pen::dots(pen::kYellow, size, alpha, true, [&] { pen::shape(GL_POINTS, std::initializer_list<Vector3>{position}); });
}

/// Draws outlines of what a press would pick on the surface; SurfacePicture highlights groups.
void drawHover(const HoverPreview& preview) {
  if (preview.path.rows() > 1) {  // the piece of the curve that a click would add
    glDepthRange(0, pen::kAbove);
    pen::rimmed(pen::kYellow, 2, [&] { lines(GL_LINE_STRIP, preview.path); });
    glDepthRange(0, 1);
  }
  if (preview.curve_point) {
    dot(*preview.curve_point, 13);
  }
  using Kind = HoverPreview::Kind;
  if ((preview.kind != Kind::Region && preview.kind != Kind::Handle) || preview.radius == 0) {
    return;
  }
  const auto draw = [&preview](const Outlines& outlines, const Vector3& middle, double alpha, bool flat) {
    if (preview.kind == Kind::Region) {
      pen::rimmed(pen::kLight, 1.2, alpha, [&] {
        lines(GL_LINES, outlines.region);
        if (flat) {
          tangentCircle(preview, preview.radius);
        }
      });
    }
    if (preview.disc_radius == 0) {
      return dot(middle, 7, std::min(alpha, 0.8));
    }
    pen::rimmed(pen::kYellow, 2, alpha, [&] {
      lines(GL_LINES, outlines.disc);
      if (flat && outlines.disc.rows() == 0) {
        tangentCircle(preview, preview.disc_radius);
      }
    });
  };
  glDepthRange(0, pen::kAbove);
  if (preview.mirrored_point) {
    draw(preview.mirrored, *preview.mirrored_point, 0.45, false);
  }
  draw(preview, preview.point, 1, !preview.is_whole && !preview.normal.isZero(0));
  glDepthRange(0, 1);
}

}  // namespace

void Overlay::drawGizmoOf(const DragSession& session, const Camera& view) {
  const DragMotion* const motion = session.motion();
  if (!motion) {
    gizmo_ = session.gizmo(view);
  } else if (gizmo_) {
    // Keep the gizmo where it was before the motion, since the session would recompute the pivot.
    gizmo_->length = place_gizmo(gizmo_->center, GizmoAxes::Layer, Vector3::Zero(), view).length;
  }
  if (!gizmo_ || (motion && session.gizmo_element() == GizmoElement::None)) {
    return;
  }
  Gizmo shown = *gizmo_;
  if (motion && motion->kind() == MotionKind::Translate) {
    shown.center += motion->transform().translation;
  }
  drawGizmo(shown, view, session.gizmo_element(), motion != nullptr);
}

void Overlay::draw(const DragSession& session, const Camera& view, const Options& options) {
  beginFlat();
  glMatrixMode(GL_MODELVIEW);
  glMultMatrixd(options.transform.data());
  pen::pixelRatio = options.viewport.devicePixelRatioF();
  const HoverPreview* const hover = session.motion() ? nullptr : session.hover();
  const bool onGroup = hover && hover->kind == HoverPreview::Kind::Group;
  if (session.selection().next != Selection::Next::Region) {
    surface_.draw(session, onGroup ? hover->group : -1, options.colours);
  }
  if (hover) {
    drawHover(*hover);
  }
  glDisable(GL_DEPTH_TEST);
  if (session.motion()) {
    drawMotion(session);
    if (session.settings().edit.contact && session.shown().away()) {
      drawStop(session);
    }
  }
  if (view.valid()) {
    // Coordinates are now pixels from the upper left corner.
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glOrtho(0, options.viewport.width(), options.viewport.height(), 0, -1, 1);
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    if (session.lasso() != nullptr) {
      pen::rimmed(brushColor(session), 1.5, [&] { pen::shape(GL_LINE_LOOP, *session.lasso()); });
    } else if (options.brush) {
      const pen::Color color = brushColor(session);
      pen::rimmed(color, 1.5, [&] { pen::circle(*options.brush, session.settings().brush_pixels); });
      pen::rimmed(color, 1.5, [&] { pen::cross(*options.brush, 4, !options.takes); });
    } else {
      drawGizmoOf(session, view);
      drawPivot(session, view);
    }
    if (session.motion() && session.motion()->kind() == MotionKind::Rotate) {
      drawTurn(*session.motion(), view);
    }
  }
}
