// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QtGui/qopengl.h>
#include <array>
#include <cmath>
#include <initializer_list>

#include "lapedit/session/gizmo.h"

/// Draws over the surface: colours, and lines with a dark rim, which are visible on any mesh. Widths and sizes are in
/// pixels of the view.
namespace pen {

/// End of the depth range of lines and points, so that the surface does not hide half of them.
constexpr double kAbove = 0.9993;

/// Device pixels per pixel of the view that is being drawn.
inline double pixelRatio = 1;

using Color = std::array<unsigned char, 3>;

// Okabe and Ito's colours, which colour-blind people can distinguish: https://jfly.uni-koeln.de/color/
constexpr Color kOrange{230, 159, 0}, kSkyBlue{86, 180, 233}, kGreen{0, 158, 115}, kYellow{240, 228, 66},
    kBlue{0, 114, 178}, kVermillion{213, 94, 0}, kPurple{204, 121, 167};
constexpr Color kDark{18, 18, 22}, kLight{252, 252, 252}, kRed{255, 0, 0}, kGrey{130, 130, 136};

constexpr Color kFree = kSkyBlue, kAnchor = kVermillion;

/// Returns the colour of a handle group; colours repeat after five groups.
inline Color groupColor(std::size_t group) {
  constexpr Color kGroups[] = {kYellow, kPurple, kBlue, kOrange, kGreen};
  return kGroups[group % 5];
}

/// Returns the colour of axis 0, 1, 2: near the usual red, green and blue.
inline Color axisColor(int axis) {
  constexpr Color kAxes[] = {{232, 84, 40}, {0, 190, 130}, {70, 140, 240}};
  return kAxes[axis];
}

inline void set(const Color& color, double alpha = 1) {
  glColor4ub(color[0], color[1], color[2], static_cast<GLubyte>(255 * alpha));
}

inline void vertex(const lapedit::Vector3& point) {
  glVertex3dv(point.data());
}

inline void vertex(const lapedit::Vector2& pixel) {
  glVertex2dv(pixel.data());
}

/// Draws vertices of the surface, or pixels.
template <class Vertices>
void shape(GLenum mode, const Vertices& vertices) {
  glBegin(mode);
  for (const auto& each : vertices) {
    vertex(each);
  }
  glEnd();
}

template <class Place>
void line(const Place& from, const Place& to) {
  shape(GL_LINES, std::initializer_list<Place>{from, to});
}

/// Draws at(angle) for angles of a revolution.
template <class At>
void circle(GLenum mode, int corners, const At& at) {
  glBegin(mode);
  for (int i = 0; i < corners; ++i) {
    vertex(at(2 * 3.14159265358979 * i / corners));
  }
  glEnd();
}

inline void setWidth(double width) {
  glLineWidth(static_cast<GLfloat>(width * pixelRatio));
}

inline void setSize(double size) {
  glPointSize(static_cast<GLfloat>(size * pixelRatio));
}

/// Draws lines with a rim, then again without; calls draw() twice.
template <class Draw>
void rimmed(const Color& color, double width, double alpha, const Draw& draw) {
  for (const bool rim : {true, false}) {
    setWidth(rim ? width + 2 : width);
    set(rim ? kDark : color, rim ? 0.75 * alpha : alpha);
    draw();
  }
}

template <class Draw>
void rimmed(const Color& color, double width, const Draw& draw) {
  rimmed(color, width, 1, draw);
}

/// Draws points; calls draw() twice if they have a rim.
template <class Draw>
void dots(const Color& color, double size, double alpha, bool rimmed, const Draw& draw) {
  for (const bool rim : {true, false}) {
    if (!rim || rimmed) {
      setSize(rim ? size + 3 : size);
      set(rim ? kDark : color, alpha);
      draw();
    }
  }
}

/// Draws a circle about a pixel.
inline void circle(const lapedit::Vector2& center, double radius) {
  circle(GL_LINE_LOOP, 48, [&](double angle) {
    return lapedit::Vector2(center + radius * lapedit::Vector2(std::cos(angle), std::sin(angle)));
  });
}

/// Draws a plus or a minus about a pixel.
inline void cross(const lapedit::Vector2& center, double half, bool plus = true) {
  const lapedit::Vector2 across(half, 0), up(0, half);
  line<lapedit::Vector2>(center - across, center + across);
  if (plus) {
    line<lapedit::Vector2>(center - up, center + up);
  }
}

}  // namespace pen
