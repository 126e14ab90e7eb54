// SPDX-License-Identifier: GPL-3.0-or-later
#include "gizmo_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lapedit/base/whole_part.h"
#include "pen.h"

using namespace lapedit;

namespace {

constexpr double kHeadLength = 15, kHeadWidth = 6, kScale = 5.5, kCross = 5;
constexpr int kCorners = 72;

struct Picture {
  const Gizmo& gizmo;
  const Camera& view;
  double ratio;
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
  pen::rimmed(color, bright ? 4 : 2.5, p.ratio, [&] { pen::line(from, neck); });
  pen::rimmed(color, 1, p.ratio, [&] {
    pen::shape(GL_TRIANGLES, head);
    pen::shape(GL_LINE_LOOP, head);
  });
}

/// Draws the half of a ring that is nearer to the viewer, or the other half.
void ring(const Picture& p, int axis, bool front, bool bright) {
  const Vector3 sight = p.view.toward_viewer(p.gizmo.center);
  const auto draw = [&](GLenum mode) {
    bool open = false;
    for (int i = 0; i <= kCorners; ++i) {
      const double angle = 2 * 3.14159265358979 * i / kCorners;
      const Vector3 position = p.gizmo.on_ring(axis, angle);
      // Points in the plane of the picture belong to the nearer half.
      const bool mine = ((position - p.gizmo.center).dot(sight) > -0.02 * p.gizmo.length) == front;
      if (mine && !open) {
        glBegin(mode);
      }
      if (mine) {
        pen::vertex(p.view.pixel(position));
      } else if (open) {
        glEnd();
      }
      open = mine;
    }
    if (open) {
      glEnd();
    }
  };
  const pen::Color color = bright ? pen::kYellow : pen::axisColor(axis);
  if (front) {
    const double width = bright ? 4 : 2.5;
    pen::rimmed(color, width, p.ratio, [&] { draw(GL_LINE_STRIP); });
    glPointSize(static_cast<GLfloat>(width * p.ratio));  // covers the joints of the line, where the rim would show
    draw(GL_POINTS);
  } else {
    glLineWidth(static_cast<GLfloat>(1.5 * p.ratio));
    pen::set(color, bright ? 0.7 : 0.35);
    draw(GL_LINE_STRIP);
  }
}

void scaleHandle(const Picture& p, bool bright) {
  const Vector2 at = p.view.pixel(p.gizmo.scale_handle(p.view));
  const double half = bright ? kScale + 1.5 : kScale;
  const Vector2 center = p.view.pixel(p.gizmo.center);
  glLineWidth(static_cast<GLfloat>(p.ratio));
  pen::set(pen::kLight, 0.5);
  pen::line(Vector2(center + Gizmo::kRing / Gizmo::kScale * (at - center)), at);
  const Vector2 across(half, 0), up(0, half);
  const Vector2 square[] = {at - across - up, at + across - up, at + across + up, at - across + up};
  pen::rimmed(bright ? pen::kYellow : pen::kLight, 1, p.ratio, [&] {
    pen::shape(GL_QUADS, square);
    pen::shape(GL_LINE_LOOP, square);
  });
}

/// Draws X, Y or Z at an arrow's tip, for users who cannot distinguish the colours.
void letter(const Picture& p, int axis) {
  if (p.gizmo.axes != Matrix3::Identity()) {
    return;  // not the layer's axes
  }
  const std::vector<Vector2> strokes[] = {{{-3, -4}, {3, 4}, {-3, 4}, {3, -4}},
                                          {{-3, -4}, {0, 0}, {3, -4}, {0, 0}, {0, 0}, {0, 4}},
                                          {{-3, -4}, {3, -4}, {3, -4}, {-3, 4}, {-3, 4}, {3, 4}}};
  const Vector2 center = p.view.pixel(p.gizmo.center), tip = p.view.pixel(p.gizmo.along(axis, Gizmo::kTip));
  std::vector<Vector2> ends = strokes[axis];
  for (Vector2& end : ends) {
    end += tip + 11 * (tip - center).stableNormalized();
  }
  pen::rimmed(pen::kLight, 1.3, p.ratio, [&] { pen::shape(GL_LINES, ends); });
}

}  // namespace

void drawGizmo(const Gizmo& gizmo, const Camera& view, GizmoElement element, bool alone, double pixelRatio) {
  if (!gizmo.center.allFinite() || !view.in_front(gizmo.center)) {
    return;
  }
  const Picture p{gizmo, view, pixelRatio};
  const auto is = [element](GizmoElement first, int axis) {
    return element == static_cast<GizmoElement>(static_cast<int>(first) + axis);
  };
  const auto shown = [&](GizmoElement first, int axis) { return !alone || is(first, axis); };
  for (const bool front : {false, true}) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool held = is(GizmoElement::TurnX, axis);
      if (shown(GizmoElement::TurnX, axis) && (alone || gizmo.ring_is_seen(axis, view))) {
        ring(p, axis, front, held);
      }
    }
    // Arrows that point away are behind the rings' near halves.
    for (int axis = 0; axis < 3; ++axis) {
      const bool towards = gizmo.axes.col(axis).dot(view.toward_viewer(gizmo.center)) > 0;
      if (shown(GizmoElement::MoveX, axis) && towards == front && gizmo.arrow_is_seen(axis, view)) {
        arrow(p, axis, is(GizmoElement::MoveX, axis));
        letter(p, axis);
      }
    }
  }
  if (alone ? element == GizmoElement::Scale : !gizmo.only_arrows) {
    scaleHandle(p, element == GizmoElement::Scale);
  }
  pen::rimmed(pen::kLight, 1.3, pixelRatio, [&] { pen::cross(view.pixel(gizmo.center), kCross); });  // the pivot
}

void drawTurn(const DragMotion& motion, const Camera& view, double pixelRatio) {
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
  pen::set(pen::kYellow, 0.3);
  glBegin(GL_TRIANGLE_FAN);
  pen::vertex(view.pixel(motion.center()));
  for (int i = 0; i <= corners; ++i) {
    pen::vertex(at(degrees * i / corners, 1));
  }
  glEnd();
  const auto line = [&](double angle, double from, double to) { pen::line(at(angle, from), at(angle, to)); };
  pen::rimmed(pen::kLight, 1, pixelRatio, [&] { line(0, 0, 1); });
  pen::rimmed(pen::kYellow, 1.5, pixelRatio, [&] { line(turn.degrees, 0, 1); });
  for (double tick = 0; motion.step() > 0 && tick < 360; tick += motion.step()) {
    pen::rimmed(pen::kLight, 1, pixelRatio, [&] { line(tick, 1.03, 1.1); });
  }
}
