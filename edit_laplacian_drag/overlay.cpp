// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlay.h"

#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <algorithm>
#include <array>
#include <cmath>

using namespace lapedit;

namespace {

using Color = std::array<unsigned char, 3>;
constexpr Color kHandle{255, 214, 10}, kFree{48, 190, 76}, kAnchor{225, 48, 38}, kOutline{20, 20, 24};
constexpr Color kAxes[] = {{235, 60, 50}, {70, 200, 70}, {70, 120, 255}, {240, 240, 245}};
constexpr unsigned char kFill = 135;  // of 255: the shading below has to stay readable

Color colorOf(VertexClass c) {
  return c == VertexClass::Handle ? kHandle : c == VertexClass::Anchor ? kAnchor : kFree;
}

void set(const Color& color, double alpha = 1) {
  glColor4ub(color[0], color[1], color[2], static_cast<GLubyte>(255 * alpha));
}

void vertex(const Vector3& point) {
  glVertex3dv(point.data());
}

/// Points with a dark rim, so that they show on any mesh.
void drawPoints(const std::vector<unsigned>& indices, const Color& color, double size, double alpha) {
  const auto count = static_cast<GLsizei>(indices.size());
  glPointSize(static_cast<GLfloat>(size + 3));
  set(kOutline, alpha);
  glDrawElements(GL_POINTS, count, GL_UNSIGNED_INT, indices.data());
  glPointSize(static_cast<GLfloat>(size));
  set(color, alpha);
  glDrawElements(GL_POINTS, count, GL_UNSIGNED_INT, indices.data());
}

void drawLine(const Vector3& from, const Vector3& to, const Color& color, double width) {
  for (const bool rim : {true, false}) {
    glLineWidth(static_cast<GLfloat>(rim ? width + 2 : width));
    set(rim ? kOutline : color);
    glBegin(GL_LINES);
    vertex(from);
    vertex(to);
    glEnd();
  }
}

/// From where the surface was grabbed to where it is wanted, and the axis that it is held to.
void drawMotion(const DragSession& session, double pixelRatio) {
  const DragMotion& motion = *session.motion();
  const Affine map = session.active_map();
  if (const auto axis = motion.axis()) {
    const double reach = 10 * session.settings().radius;
    drawLine(motion.grab() - reach * *axis, motion.grab() + reach * *axis,
             kAxes[static_cast<int>(motion.lock()) - static_cast<int>(AxisLock::X)], pixelRatio);
  }
  if (motion.kind() == MotionKind::Translate && motion.moves()) {
    drawLine(motion.grab(), map * motion.grab(), kHandle, 1.5 * pixelRatio);
  }
}

/// Handles at their wanted places, for as long as no pose says where they are.
void drawWanted(const DragSession& session, double size) {
  const Affine map = session.active_map();
  for (const bool rim : {true, false}) {
    glPointSize(static_cast<GLfloat>(rim ? size + 3 : size));
    set(rim ? kOutline : kHandle);
    glBegin(GL_POINTS);
    for (std::size_t g = 0; g < session.groups().size(); ++g) {
      for (const int v : session.groups()[g]) {
        const Vector3 place = session.mesh().vertices.row(v).transpose();
        vertex(static_cast<int>(g) == session.active_group() ? Vector3(map * place) : place);
      }
    }
    glEnd();
  }
}

void drawBrush(const Overlay::Brush& brush, double width, double height, double pixelRatio) {
  glMatrixMode(GL_PROJECTION);
  glPushMatrix();
  glLoadIdentity();
  glOrtho(0, width, height, 0, -1, 1);
  glMatrixMode(GL_MODELVIEW);
  glPushMatrix();
  glLoadIdentity();
  glDisable(GL_DEPTH_TEST);
  for (const bool rim : {true, false}) {
    glLineWidth(static_cast<GLfloat>((rim ? 3.5 : 1.5) * pixelRatio));
    set(rim ? kOutline : brush.takes ? kAnchor : kFree);
    glBegin(GL_LINE_LOOP);
    constexpr int kCorners = 48;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2 * 3.14159265358979 * i / kCorners;
      glVertex2d(brush.center.x() + brush.radius * std::cos(angle), brush.center.y() + brush.radius * std::sin(angle));
    }
    glEnd();
  }
  glPopMatrix();
  glMatrixMode(GL_PROJECTION);
  glPopMatrix();
  glMatrixMode(GL_MODELVIEW);
}

}  // namespace

/// Colours and lists, O(region).
void Overlay::sort(const Region& region) {
  handles_.clear();
  anchors_.clear();
  colors_.resize(4 * static_cast<std::size_t>(region.size()));
  for (std::size_t i = 0; i < region.classes.size(); ++i) {
    const Color color = colorOf(region.classes[i]);
    std::copy(color.begin(), color.end(), colors_.begin() + static_cast<std::ptrdiff_t>(4 * i));
    colors_[4 * i + 3] = kFill;
    if (region.classes[i] == VertexClass::Handle) {
      handles_.push_back(static_cast<unsigned>(i));
    } else if (region.classes[i] == VertexClass::Anchor) {
      anchors_.push_back(static_cast<unsigned>(i));
    }
  }
}

/// The region's colours, its anchors and its handles.
void Overlay::drawRegion(const DragSession& session, double handleSize, double pixelRatio) {
  const Region& region = *session.region();
  const bool moving = session.motion() != nullptr;
  if (session.region_serial() != sorted_) {
    sorted_ = session.region_serial();
    sort(region);
  }
  glDisableClientState(GL_NORMAL_ARRAY);
  glDisableClientState(GL_TEXTURE_COORD_ARRAY);
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_DOUBLE, 0, session.pose().data());
  if (!moving) {  // while it moves the surface itself is what to look at
    glEnableClientState(GL_COLOR_ARRAY);
    glColorPointer(4, GL_UNSIGNED_BYTE, 0, colors_.data());
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1, -2);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(region.faces.size()), GL_UNSIGNED_INT, region.faces.data());
    glDisable(GL_POLYGON_OFFSET_FILL);
  }
  glDisableClientState(GL_COLOR_ARRAY);
  // Points lie in the surface: without this half of each would be hidden by it.
  glDepthRange(0, 0.9995);
  glPointSize(static_cast<GLfloat>((moving ? 1.5 : 2.5) * pixelRatio));
  set(kAnchor, moving ? 0.5 : 1);
  glDrawElements(GL_POINTS, static_cast<GLsizei>(anchors_.size()), GL_UNSIGNED_INT, anchors_.data());
  if (!moving || session.in_hand()) {
    glDisable(GL_DEPTH_TEST);
    drawPoints(handles_, kHandle, handleSize, 0.25);  // through the surface
    glEnable(GL_DEPTH_TEST);
    glDepthRange(0, 0.999);
    drawPoints(handles_, kHandle, handleSize, 1);
  }
  glDisableClientState(GL_VERTEX_ARRAY);
}

void Overlay::draw(const DragSession& session, const Camera& view, const std::optional<Brush>& brush, double width,
                   double height, double pixelRatio) {
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glPushClientAttrib(GL_CLIENT_ALL_ATTRIB_BITS);
  // Buffers that the host left bound would be taken for our arrays.
  if (QOpenGLContext* context = QOpenGLContext::currentContext()) {
    context->functions()->glUseProgram(0);
    context->functions()->glBindBuffer(GL_ARRAY_BUFFER, 0);
    context->functions()->glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, 0);
  }
  glDisable(GL_LIGHTING);
  glDisable(GL_TEXTURE_2D);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_POINT_SMOOTH);
  glEnable(GL_LINE_SMOOTH);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glShadeModel(GL_SMOOTH);

  const bool moving = session.motion() != nullptr;
  const double handleSize = 9 * pixelRatio;
  if (session.region()) {
    drawRegion(session, handleSize, pixelRatio);
  }
  glDepthRange(0, 1);
  glDisable(GL_DEPTH_TEST);
  if (moving && (!session.region() || !session.in_hand())) {
    drawWanted(session, handleSize);
  }
  if (moving) {
    drawMotion(session, pixelRatio);
  }
  if (brush && view.valid()) {
    drawBrush(*brush, width, height, pixelRatio);
  }
  glPopClientAttrib();
  glPopAttrib();
}
