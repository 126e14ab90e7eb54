// SPDX-License-Identifier: GPL-3.0-or-later
#include "pen.h"

#include <cmath>

namespace pen {

void chains(const lapedit::Chains& chains) {
  const unsigned* at = chains.vertices.data();
  for (const int length : chains.lengths) {
    glDrawElements(GL_LINE_STRIP, length, GL_UNSIGNED_INT, at);
    at += length;
  }
}

InPixels::InPixels(double width, double height) {
  glMatrixMode(GL_PROJECTION);
  glPushMatrix();
  glLoadIdentity();
  glOrtho(0, width, height, 0, -1, 1);
  glMatrixMode(GL_MODELVIEW);
  glPushMatrix();
  glLoadIdentity();
  glDisable(GL_DEPTH_TEST);
}

InPixels::~InPixels() {
  glPopMatrix();
  glMatrixMode(GL_PROJECTION);
  glPopMatrix();
  glMatrixMode(GL_MODELVIEW);
}

void circle(const lapedit::Vector2& center, double radius) {
  constexpr int kCorners = 48;
  glBegin(GL_LINE_LOOP);
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kCorners;
    glVertex2d(center.x() + radius * std::cos(angle), center.y() + radius * std::sin(angle));
  }
  glEnd();
}

}  // namespace pen
