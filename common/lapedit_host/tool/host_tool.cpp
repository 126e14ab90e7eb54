// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/tool/host_tool.h"

#include <meshlab/glarea.h>

#include <QApplication>
#include <QMainWindow>
#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>
#include <vector>

namespace lapedit::host {
namespace {

/// The view in MeshLab. Uses only inline functions of GLArea, since the application exports no others.
class HostView final : public HostWindow {
 public:
  explicit HostView(QString title) : title_(std::move(title)) {}

  void attach(GLArea* area, MLSceneGLSharedDataContext* shared) {
    area_ = area;
    shared_ = shared;
  }
  bool attached() const { return area_ != nullptr; }

  QWidget& viewport() override { return *area_; }
  QMainWindow* mainWindow() override { return qobject_cast<QMainWindow*>(area_->window()); }
  bool suspended() override { return area_->suspendedEditor; }
  bool loading() override { return area_->md() != nullptr && area_->md()->isBusy(); }

  QObject* document() override { return area_->md(); }
  std::optional<Layer> currentLayer() override { return area_->mm() ? seen(*area_->mm()) : std::nullopt; }

  std::optional<Layer> layer(int id) override {
    MeshModel* model = find(id);
    return model ? seen(*model) : std::nullopt;
  }

  std::vector<Layer> layers() override {
    std::vector<Layer> list;
    for (const auto id : area_->meshVisibilityMap.keys()) {
      if (const auto found = layer(static_cast<int>(id))) {
        list.push_back(*found);
      }
    }
    return list;
  }

  void setCurrentLayer(int id) override {
    QMetaObject::invokeMethod(
        area_,
        [this, id] {
          if (area_->md() != nullptr && find(id) != nullptr) {
            area_->md()->setCurrentMesh(id);
          }
        },
        Qt::QueuedConnection);
  }

  void uploadGeometry(int layer) override {
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

  void markModified(int layer) override {
    if (MeshModel* model = find(layer)) {
      model->setMeshModified();
    }
  }

  void repaint() override { area_->updateAllSiblingsGLAreas(); }

  double depthAt(const QPointF& pixel, int around) override {
    const qreal ratio = area_->devicePixelRatioF();
    const int side = 2 * around + 1;
    std::vector<GLfloat> depths(static_cast<std::size_t>(side) * side, 0);
    area_->makeCurrent();
    glReadPixels(static_cast<GLint>(pixel.x() * ratio) - around,
                 static_cast<GLint>((area_->height() - pixel.y()) * ratio) - 1 - around, side, side, GL_DEPTH_COMPONENT,
                 GL_FLOAT, depths.data());
    return static_cast<double>(*std::max_element(depths.begin(), depths.end()));
  }

  void log(const std::string& line) override {
    if (area_ != nullptr && area_->md() != nullptr) {
      write_log(*area_->md(), title_.toStdString() + ": " + line);
    }
  }

  void navigate(const QMouseEvent& event, Qt::MouseButton as) override {
    const Qt::MouseButtons held = event.buttons() == Qt::NoButton ? Qt::MouseButtons() : Qt::MouseButtons(as);
    // A double click would center the view.
    const QEvent::Type type = event.type() == QEvent::MouseButtonDblClick ? QEvent::MouseButtonPress : event.type();
    QMouseEvent copy(type, event.localPos(), event.windowPos(), event.screenPos(),
                     type == QEvent::MouseMove ? Qt::NoButton : as, held, Qt::NoModifier);
    pass(copy);
  }

  void navigate(const QWheelEvent& event) override {
    // Qt makes the wheel horizontal while Alt is held.
    QPoint angle = event.angleDelta();
    if (angle.y() == 0) {
      angle = QPoint(0, angle.x());
    }
    QWheelEvent copy(event.position(), event.globalPosition(), QPoint(), angle, event.buttons(), Qt::NoModifier,
                     Qt::NoScrollPhase, false);
    pass(copy);
  }

  void turnTo(const Eigen::Vector3d& direction) override {
    vcg::Quaternionf& rotation = area_->trackball.track.rot;
    const Eigen::Vector3f given = direction.normalized().cast<float>();
    const vcg::Point3f viewer(0, 0, 1), seen = rotation.Rotate(vcg::Point3f(given.x(), given.y(), given.z()));
    const vcg::Point3f across = seen ^ viewer;
    if (given.allFinite()) {
      const vcg::Point3f axis = across.Norm() > 0 ? across : vcg::Point3f(0, 1, 0);
      rotation = vcg::Quaternionf(std::atan2(across.Norm(), seen * viewer), axis) * rotation;
    }
  }

  void endTool() override { QMetaObject::invokeMethod(area_, "endEdit", Qt::QueuedConnection); }

  void addToHistory(const QString& filter, const QString& edit, double fraction, int position) override {
    if (FilterScript* history = filterHistory()) {
      FilterNameParameterValuesPair entry;
      entry.first = filter;
      entry.second.addParam(RichString("edit", edit, "Edit", ""));
      entry.second.addParam(RichFloat("fraction", static_cast<Scalarm>(fraction), "Fraction", ""));
      history->insert(position >= 0 && position < history->size() ? position : history->size(), entry);
    }
  }

  int removeFromHistory(const QString& filter, const QString& edit) override {
    FilterScript* history = filterHistory();
    for (int i = history == nullptr ? -1 : history->size() - 1; i >= 0; --i) {
      const auto& parameters = history->at(i).second;
      if (history->at(i).filterName() == filter && parameters.hasParameter("edit") &&
          parameters.getString("edit") == edit) {
        history->removeAt(i);
        return i;
      }
    }
    return -1;
  }

 private:
  FilterScript* filterHistory() { return area_->md() != nullptr ? history_of(*area_->md()) : nullptr; }

  MeshModel* find(int id) { return area_->md() != nullptr ? area_->md()->getMesh(id) : nullptr; }

  std::optional<Layer> seen(MeshModel& model) {
    Layer layer;
    layer.id = model.id();
    layer.name = model.shortName();
    layer.file = model.fullName();
    layer.mesh = &model.cm;
    layer.visible = area_->meshVisibilityMap.value(model.id(), true);
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 4; ++k) {
        layer.transform(i, k) = static_cast<double>(model.cm.Tr[i][k]);
      }
    }
    return layer;
  }

  /// Passes the event to the view, as if the tool were suspended.
  void pass(QEvent& event) {
    const bool before = std::exchange(area_->suspendedEditor, true);
    QApplication::sendEvent(area_, &event);
    area_->suspendedEditor = before;
  }

  QString title_;
  GLArea* area_ = nullptr;
  MLSceneGLSharedDataContext* shared_ = nullptr;
};

/// MeshLab never deletes a tool, so it becomes a child of its view.
class HostTool final : public QObject, public HostToolBase {
 public:
  explicit HostTool(const EditToolAction& description) : view_(description.title), tool_(description.make(view_)) {}

  void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { tool_->mousePress(*event); });
  }
  void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { tool_->mouseMove(*event); });
  }
  void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { tool_->mouseRelease(*event); });
  }
  void wheelEvent(QWheelEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { tool_->wheel(*event); });
  }
  void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { tool_->keyPress(*event); });
  }
  void keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea*) override {
    guarded([&] { tool_->keyRelease(*event); });
  }

  /// MeshLab does not pass double clicks to tools; Qt sends one instead of the second press.
  bool eventFilter(QObject*, QEvent* event) override {
    if (event->type() == QEvent::MouseButtonDblClick && !view_.suspended()) {
      guarded([&] { tool_->mousePress(static_cast<QMouseEvent&>(*event)); });
    }
    return false;
  }

 private:
  bool start(GLArea* area, MLSceneGLSharedDataContext* shared) override {
    setParent(area);
    view_.attach(area, shared);
    area->installEventFilter(this);
    return guarded([this] { return tool_->start(); });
  }
  void end(GLArea* area) override {
    area->removeEventFilter(this);
    guarded([this] { tool_->end(); });
  }
  void changeLayer(GLArea* area, MLSceneGLSharedDataContext* shared) override {
    guarded([this] { tool_->end(); });
    view_.attach(area, shared);
    if (area->mm() == nullptr) {
      view_.endTool();  // otherwise MeshLab fails at the next change of layer
      return;
    }
    guarded([this] { return tool_->start(); });
  }
  void draw(GLArea*) override {
    guarded([this] { tool_->draw(); });
  }

  template <class Call>
  auto guarded(const Call& call) -> decltype(call()) {
    using Result = decltype(call());
    std::string failure;
    try {
      return call();
    } catch (const std::exception& error) {
      failure = error.what();
    } catch (...) {
      failure = "The tool failed for an unknown reason.";
    }
    if (view_.attached()) {
      view_.log(failure);
    }
    return Result();
  }

  HostView view_;
  std::unique_ptr<InteractiveTool> tool_;
};

}  // namespace

HostToolBase* makeHostTool(const EditToolAction& description) {
  return new HostTool(description);
}

QAction* makeAction(const EditToolAction& description, QObject* parent) {
  auto* const action = new QAction(QIcon(description.icon), description.title, parent);
  action->setCheckable(true);
  action->setShortcut(description.shortcut);
  action->setToolTip(description.title + " (" + description.shortcut.toString(QKeySequence::NativeText) +
                     "): " + description.description);
  action->setWhatsThis(description.description);
  return action;
}

}  // namespace lapedit::host
