// SPDX-License-Identifier: GPL-3.0-or-later
#include "pen.h"

#include <QOpenGLContext>
#include <QOpenGLFunctions>

namespace pen {

void chains(const lapedit::Chains& chains, double width, bool opaque) {
  glLineWidth(static_cast<GLfloat>(width));
  const unsigned* at = chains.vertices.data();
  for (const int length : chains.lengths) {
    glDrawElements(GL_LINE_STRIP, length, GL_UNSIGNED_INT, at);
    at += length;
  }
  if (opaque && width > 2) {
    glPointSize(static_cast<GLfloat>(width));
    glDrawElements(GL_POINTS, static_cast<GLsizei>(chains.vertices.size()), GL_UNSIGNED_INT, chains.vertices.data());
  }
}

FlatState::FlatState() {
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glPushClientAttrib(GL_CLIENT_ALL_ATTRIB_BITS);
  // Otherwise OpenGL would read buffers that MeshLab left bound in place of our arrays.
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
}

FlatState::~FlatState() {
  glPopClientAttrib();
  glPopAttrib();
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

}  // namespace pen
