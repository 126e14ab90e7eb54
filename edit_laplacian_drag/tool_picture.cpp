// SPDX-License-Identifier: GPL-3.0-or-later
#include <QtGui/qopengl.h>
#include <Eigen/Geometry>
#include <utility>

#include "laplacian_drag_tool.h"

using namespace lapedit;
using namespace lapedit::host;

// LaplacianDragTool: the picture, and the line over it.

namespace {

constexpr int kLongestWait = 200;                             // milliseconds without a picture
constexpr const char* kLineProperty = "laplacian_drag_line";  // of the viewport, for tests

Eigen::Matrix4d matrixOf(GLenum which) {
  Eigen::Matrix4d matrix;  // column-major, as OpenGL's matrices
  glGetDoublev(which, matrix.data());
  return matrix;
}

}  // namespace

void LaplacianDragTool::draw(QPainter& painter) {
  constexpr GLenum kMatrices[] = {GL_PROJECTION, GL_MODELVIEW};
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glPushClientAttrib(GL_CLIENT_ALL_ATTRIB_BITS);
  for (const GLenum mode : kMatrices) {
    glMatrixMode(mode);
    glPushMatrix();
  }
  guarded([&] { drawAll(painter); });
  for (const GLenum mode : kMatrices) {
    glMatrixMode(mode);
    glPopMatrix();
  }
  glPopClientAttrib();
  glPopAttrib();
}

/// Draws over the scene. The modelview matrix is that of the world.
void LaplacianDragTool::drawAll(QPainter& painter) {
  if (isStale()) {
    later([this] { isStale() && begin(); });
  }
  const auto layer = usableLayer();
  const QWidget& viewport = window_.viewport();
  worldToClip_ = matrixOf(GL_PROJECTION_MATRIX) * matrixOf(GL_MODELVIEW_MATRIX);
  bool hasLegend = false;
  if (layer) {
    view_ = Camera(worldToClip_ * layer->transform, viewport.width(), viewport.height());
    DragSession& session = active_->session;
    Overlay::Options options = {viewport, layer->transform};
    if (session.hover() && !session.motion() && isCovered()) {
      session.leave();
    }
    shown_.warning = shown_.warning && !session.warning().empty();
    options.colours = shown_.warning ? Colours::Stretch : shared_->panel().colours();
    hasLegend = options.colours == Colours::Stretch && session.shown().region();
    options.takes = pressModifiers().take;
    const bool paints = !pressModifiers().none() || session.tools().paint;
    if (paints && !session.motion() && !(mouse_.modifiers & Qt::AltModifier)) {
      options.brush = cursor().pixel;
    }
    overlay_.draw(session, view_, options);
    if (window_.suspended() && session.motion()) {
      // MeshLab's button or menu has suspended the tool. Cancel after drawing, since no upload is possible during it.
      later([this] { cancelMotion(); });
    }
  }
  drawTexts(painter, line(layer.has_value()), hasLegend);
}

/// Returns the text of the line over the picture. @param usable  whether there is a layer to edit
StatusLine LaplacianDragTool::line(bool usable) {
  if (!usable) {
    return {active_ ? tr("The layer is hidden: make it visible to edit it.") : nothing_};
  }
  const DragSession& session = active_->session;
  StatusLine line;
  line.text = !notice_.isEmpty()    ? notice_
              : window_.suspended() ? tr("Suspended: the mouse turns the view. Esc resumes the tool.")
                                    : QString::fromStdString(session.message());
  if (session.preparation().running) {
    line.text += tr("  [preparing: %1, %2 %]")
                     .arg(session.preparation().stage.c_str())
                     .arg(static_cast<int>(100 * session.preparation().progress));
  }
  if (const std::string warning = session.warning(); !warning.empty() && notice_.isEmpty()) {
    const bool canBeShown = !session.motion() && !shown_.warning;
    line.warning = QString::fromStdString(warning) + (canBeShown ? tr(" Click here to see where.") : QString());
  }
  if (const HoverPreview* const hover = session.hover(); hover && !window_.suspended() && !session.motion()) {
    const auto at = session.mesh().vertices.row(hover->vertex);
    const auto text = [&at](int k) { return QString::number(at[k], 'g', 6); };
    line.position = tr("Vertex %1 at %2, %3, %4").arg(hover->vertex).arg(text(0), text(1), text(2));
  }
  return line;
}

void LaplacianDragTool::drawTexts(QPainter& painter, const StatusLine& line, bool hasLegend) {
  glDisable(GL_DEPTH_TEST);
  painter.endNativePainting();
  painter.save();
  painter.setRenderHints(QPainter::Antialiasing | QPainter::TextAntialiasing);
  guarded([&] {
    QStringList texts{line.text, line.warning, line.position};
    texts.removeAll(QString());
    window_.viewport().setProperty(kLineProperty, shown_.keys ? "keys" : texts.join('\n'));
    if (hasLegend) {
      drawLegend(painter);
    }
    line_ = QRect();
    if (shown_.keys) {
      drawKeys(painter);
    } else if (!texts.isEmpty()) {
      line_ = drawLine(painter, line);
    }
  });
  painter.restore();
  painter.beginNativePainting();
}

/// Returns whether a picture should wait for the pose that is being solved. MeshLab draws after each move of the mouse,
/// and drawing twice would take twice as long.
bool LaplacianDragTool::poseIsComing() const {
  return active_ && active_->session.motion() && active_->session.preparation().has_preview &&
         active_->session.busy() && frame_.moved && !frame_.posed && frame_.sinceMove.elapsed() < kLongestWait;
}

void LaplacianDragTool::framePainted() {
  if (std::exchange(frame_.posed, false) && std::exchange(frame_.moved, false)) {
    ++frame_.count;
    refreshPanel();
  }
}

/// Returns whether another layer hides the surface that a press would pick.
bool LaplacianDragTool::isCovered() {
  constexpr double kNearer = 0.002;  // of the depth range; marks are drawn a little before the surface
  constexpr int kAround = 3;         // pixels: a thin part of this layer may be nearer, too
  const auto layer = usableLayer();
  if (!layer || window_.layers().size() < 2) {
    return false;
  }
  const std::optional<Vector3> point = active_->session.surface_at(cursor(), pressModifiers());
  if (!point) {
    return false;
  }
  const Vector3 clip = (worldToClip_ * layer->transform * point->homogeneous()).hnormalized();
  return window_.depthAt(mouse_.position, kAround) < (clip.z() + 1) / 2 - kNearer;
}
