// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/tool/host_view.h"

#include <meshlab/glarea.h>

#include <QApplication>
#include <algorithm>
#include <utility>

#include "edit_tool_plugin.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {

// Uses only inline functions of GLArea, since the application exports no others.

QWidget& HostView::viewport() {
  return *area_;
}

bool HostView::suspended() {
  return area_->suspendedEditor;
}

bool HostView::loading() {
  return area_->md() != nullptr && area_->md()->isBusy();
}

QObject* HostView::document() {
  return area_->md();
}

std::optional<Layer> HostView::currentLayer() {
  return area_->mm() ? seen(*area_->mm()) : std::nullopt;
}

std::optional<Layer> HostView::layer(int id) {
  MeshModel* model = find(id);
  return model ? seen(*model) : std::nullopt;
}

std::vector<Layer> HostView::layers() {
  std::vector<Layer> list;
  for (const auto id : area_->meshVisibilityMap.keys()) {
    if (const auto found = layer(static_cast<int>(id))) {
      list.push_back(*found);
    }
  }
  return list;
}

void HostView::uploadGeometry(int layer) {
  if (shared_ == nullptr || find(layer) == nullptr) {
    return;
  }
  MLRenderingData::RendAtts attributes;
  attributes[MLRenderingData::ATT_NAMES::ATT_VERTPOSITION] = true;
  attributes[MLRenderingData::ATT_NAMES::ATT_VERTNORMAL] = true;
  attributes[MLRenderingData::ATT_NAMES::ATT_FACENORMAL] = true;
  shared_->meshAttributesUpdated(layer, false, attributes);
  shared_->manageBuffers(layer);
}

void HostView::markModified(int layer) {
  if (MeshModel* model = find(layer)) {
    model->setMeshModified();
  }
}

void HostView::repaint() {
  area_->updateAllSiblingsGLAreas();
}

double HostView::depthAt(const QPointF& pixel, int around) {
  const qreal ratio = area_->devicePixelRatioF();
  const int side = 2 * around + 1;
  std::vector<GLfloat> depths(static_cast<std::size_t>(side) * side, 0);
  area_->makeCurrent();
  glReadPixels(static_cast<GLint>(pixel.x() * ratio) - around,
               static_cast<GLint>((area_->height() - pixel.y()) * ratio) - 1 - around, side, side, GL_DEPTH_COMPONENT,
               GL_FLOAT, depths.data());
  return static_cast<double>(*std::max_element(depths.begin(), depths.end()));
}

void HostView::log(const std::string& line) {
  if (area_ != nullptr && area_->md() != nullptr) {
    write_log(*area_->md(), title_.toStdString() + ": " + line);
  }
}

void HostView::navigate(const QMouseEvent& event, Qt::MouseButton as) {
  const Qt::MouseButtons held = event.buttons() == Qt::NoButton ? Qt::MouseButtons() : Qt::MouseButtons(as);
  // A double click would center the view.
  const QEvent::Type type = event.type() == QEvent::MouseButtonDblClick ? QEvent::MouseButtonPress : event.type();
  QMouseEvent copy(type, event.localPos(), event.windowPos(), event.screenPos(),
                   type == QEvent::MouseMove ? Qt::NoButton : as, held, Qt::NoModifier);
  pass(copy);
}

void HostView::navigate(const QWheelEvent& event) {
  // Qt makes the wheel horizontal while Alt is held.
  QPoint angle = event.angleDelta();
  if (angle.y() == 0) {
    angle = QPoint(0, angle.x());
  }
  QWheelEvent copy(event.position(), event.globalPosition(), QPoint(), angle, event.buttons(), Qt::NoModifier,
                   Qt::NoScrollPhase, false);
  pass(copy);
}

void HostView::endTool() {
  QMetaObject::invokeMethod(area_, "endEdit", Qt::QueuedConnection);
}

MeshModel* HostView::find(int id) {
  return area_->md() != nullptr ? area_->md()->getMesh(id) : nullptr;
}

std::optional<Layer> HostView::seen(MeshModel& model) {
  Layer layer;
  layer.id = model.id();
  layer.name = model.shortName();
  layer.file = model.fullName();
  layer.mesh = &model.cm;
  layer.visible = area_->meshVisibilityMap.value(model.id(), true);
  layer.transform = transform_of(model.cm);
  return layer;
}

/// Passes the event to the view, as if the tool were suspended.
void HostView::pass(QEvent& event) {
  const bool before = std::exchange(area_->suspendedEditor, true);
  QApplication::sendEvent(area_, &event);
  area_->suspendedEditor = before;
}

}  // namespace lapedit::host
