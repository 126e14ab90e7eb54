// SPDX-License-Identifier: GPL-3.0-or-later
#include <QtGui/qopengl.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit_host/mesh_bridge.h"
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

/// Returns the position of a vertex as text, such as "1, 2, 3".
QString positionOf(const TriangleMesh& mesh, int vertex) {
  QStringList numbers;
  for (int k = 0; k < 3; ++k) {
    numbers += QString::number(mesh.vertices(vertex, k), 'g', 6);
  }
  return numbers.join(", ");
}

/// Returns the approximate distance of a point from a mesh, to some of its vertices; infinity outside the mesh's box.
double distanceAbout(const CMeshO& mesh, const Vector3& point) {
  constexpr std::size_t kSome = 4096;
  double nearest = std::numeric_limits<double>::infinity();
  const double margin = 0.01 * mesh.bbox.Diag();
  if (((point - to_core(mesh.bbox.min)).array() < -margin).any() ||
      ((point - to_core(mesh.bbox.max)).array() > margin).any()) {
    return nearest;
  }
  for (std::size_t v = 0; v < mesh.vert.size(); v += mesh.vert.size() / kSome + 1) {
    nearest = std::min(nearest, (to_core(mesh.vert[v].cP()) - point).norm());
  }
  return nearest;
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
  if (std::exchange(mouse_.asks, false)) {
    offerLayer();
  }
  bool hasLegend = false;
  if (layer) {
    view_ = Camera(worldToClip_ * layer->transform, viewport.width(), viewport.height());
    DragSession& session = active_->session;
    Overlay::Options options = {viewport, layer->transform};
    if (session.hover() && !session.motion() && isCovered()) {
      session.leave();
    }
    shown_.warning = shown_.warning && !session.warning().empty();
    const Colours colours = shown_.warning ? Colours::Stretch : shared_->panel().colours();
    options.colours = colours == Colours::RegionAtRest ? (session.motion() ? Colours::None : Colours::Region) : colours;
    hasLegend = options.colours == Colours::Stretch && session.shown().region();
    options.takes = mouse_.modifiers & Qt::ShiftModifier;
    const bool paints = options.takes || mouse_.modifiers & Qt::ControlModifier || session.tools().paint;
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
    line.warning = QString::fromStdString(warning);
    if (!session.motion() && !shown_.warning) {
      line.click = tr("Click here to see where.");
    }
  }
  if (const HoverPreview* const hover = session.hover(); hover && !window_.suspended() && !session.motion()) {
    line.position = tr("Vertex %1 at %2").arg(hover->vertex).arg(positionOf(session.mesh(), hover->vertex));
  }
  return line;
}

void LaplacianDragTool::drawTexts(QPainter& painter, const StatusLine& line, bool hasLegend) {
  glDisable(GL_DEPTH_TEST);
  painter.endNativePainting();
  painter.save();
  painter.setRenderHints(QPainter::Antialiasing | QPainter::TextAntialiasing);
  guarded([&] {
    const StatusLine shown = fitted(painter, line);
    QStringList texts{shown.text, shown.warningAndClick(), shown.position};
    texts.removeAll(QString());
    window_.viewport().setProperty(kLineProperty, shown_.keys ? "keys" : texts.join('\n'));
    if (hasLegend) {
      drawLegend(painter);
    }
    line_ = QRect();
    if (shown_.keys) {
      drawKeys(painter);
    } else if (!texts.isEmpty()) {
      line_ = drawLine(painter, shown);
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

/// Handles a press on the line over the picture. @return whether there was one
bool LaplacianDragTool::pressLine() {
  if (!line_.contains(mouse_.position.toPoint())) {
    return false;
  }
  if (offered_ >= 0) {
    window_.setCurrentLayer(std::exchange(offered_, -1));
    notice_.clear();
    return true;
  }
  if (active_ && !active_->session.warning().empty() && !active_->session.motion()) {
    showWarning();
    return true;
  }
  return false;
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

/// Colours the stretch, marks folds and turns the view to them, or to the handle.
void LaplacianDragTool::showWarning() {
  const DragSession& session = active_->session;
  std::vector<int> vertices;
  if (const auto report = session.figures().report) {
    for (const auto& fold : report->causes.folds) {
      vertices.insert(vertices.end(), fold.begin(), fold.end());
    }
  }
  const auto layer = usableLayer();
  if (layer && !vertices.empty()) {
    // Use the surface around the folds, since folds may face any direction.
    std::vector<int> around = grown(session.adjacency(), grown(session.adjacency(), sorted_set(std::move(vertices))));
    window_.turnTo(layer->transform.topLeftCorner<3, 3>() *
                   mean_normal(session.original(), session.given_adjacency(), around));
  }
  shown_.warning = true;
  afterEvent();
}

/// Offers to switch to another layer whose surface was pressed. Finds the position by the depth of the picture, without
/// a search in the layers' faces.
void LaplacianDragTool::offerLayer() {
  const QWidget& viewport = window_.viewport();
  const QPointF at = mouse_.pressedAt;
  const double depth = window_.depthAt(at, 0);
  if (depth >= 1) {
    return;  // the background
  }
  const Vector3 world = (worldToClip_.inverse() * Eigen::Vector4d(2 * at.x() / viewport.width() - 1,
                                                                  1 - 2 * at.y() / viewport.height(), 2 * depth - 1, 1))
                            .hnormalized();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Layer& layer : window_.layers()) {
    const Vector3 local = (layer.transform.inverse() * world.homogeneous()).hnormalized();
    const double away = layer.id != layer_ && layer.visible ? distanceAbout(*layer.mesh, local) : nearest;
    if (away < nearest) {
      nearest = away;
      offered_ = layer.id;
      notice_ = tr("This is the layer %1, which is not the current one: click here to edit it.").arg(layer.name);
    }
  }
}
