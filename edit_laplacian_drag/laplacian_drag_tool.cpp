// SPDX-License-Identifier: GPL-3.0-or-later
#include "laplacian_drag_tool.h"

#include <QClipboard>
#include <QGuiApplication>
#include <QMainWindow>
#include <QTimer>
#include <QToolTip>
#include <map>
#include <utility>

#include "edit_file_dialogs.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit_host/mesh_edit.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

Eigen::Vector3i sizeOf(const Layer& layer) {
  return {layer.id, layer.mesh->vn, layer.mesh->fn};
}

double milliseconds(const QElapsedTimer& timer) {
  return static_cast<double>(timer.nsecsElapsed()) * 1e-6;
}

}  // namespace

LaplacianDragTool::LaplacianDragTool(HostWindow& window) : window_(window) {}

LaplacianDragTool::~LaplacianDragTool() {
  if (shared_) {
    shared_->end(*this);
  }
}

/// Reports exceptions as messages: Qt must not see those of a button or of the worker's results.
void LaplacianDragTool::guarded(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::exception& error) {
    say(error.what());
  }
}

void LaplacianDragTool::say(const std::string& line) {
  notice_ = QString::fromStdString(line);
  mouse_.noticedAt = mouse_.position;
  window_.log(notice_.toStdString());
}

// --- On and off -----------------------------------------------------------------------------------------------------

bool LaplacianDragTool::start() {
  shared_ = &WindowSessions::of(*window_.canvas().window());
  active_ = nullptr;
  layer_ = -1;
  nothing_.clear();
  refused_.setConstant(-1);
  notice_.clear();
  offered_ = -1;
  keysShown_ = false;
  mouse_.pressed = mouse_.moved = mouse_.inside = false;
  mouse_.navigating = Qt::NoButton;
  clock_.reset();
  targets_ = nullptr;
  overlay_ = Overlay();
  const auto layer = window_.currentLayer();
  if (!layer) {
    nothing_ = tr("There is no mesh: open one first.");
    if (!on_) {
      say(nothing_.toStdString());
      // The tool does not start, and so cannot draw its line over the picture.
      QWidget& canvas = window_.canvas();
      QToolTip::showText(canvas.mapToGlobal(canvas.rect().center()), nothing_, &canvas);
    }
    return on_;
  }
  shared_->begin(*this, window_.document(), layer->id);
  // By name: the address of MeshLab's signal differs between versions.
  connect(window_.document(), SIGNAL(meshSetChanged()), this, SLOT(layersChanged()),
          static_cast<Qt::ConnectionType>(Qt::QueuedConnection | Qt::UniqueConnection));
  shared_->forgetGone();
  if (window_.loading()) {
    return showNothing(tr("MeshLab is reading a mesh."));  // the first picture of it starts the session
  }
  LayerSession* known = shared_->find(layer->id);
  const bool resume =
      known != nullptr && known->wasLeftLike(*layer->mesh) &&
      (known->inHistory.isEmpty() || window_.removeFromHistory("Laplacian Edit Replay", known->inHistory));
  try {
    active_ = resume ? known : &shared_->make(layer->id, *layer->mesh);
  } catch (const EditError& error) {
    say(error.what());
    refused_ = sizeOf(*layer);
    return showNothing(notice_);
  }
  active_->inHistory.clear();
  layer_ = layer->id;
  on_ = true;
  openPanel();
  shared_->panel().setMesh(active_->session().original());
  refreshPanel();
  window_.canvas().setMouseTracking(true);
  takeKeys();
  // The menu or tool bar that started the tool takes the keyboard after this call.
  QTimer::singleShot(0, this, [this] { takeKeys(); });
  return true;
}

/// Keeps the tool on without a session.
bool LaplacianDragTool::showNothing(const QString& reason) {
  nothing_ = reason;
  on_ = true;
  openPanel();
  refreshPanel();
  return true;
}

/// Returns whether the current layer is no longer the one that start() read, as after an import or *Reload*. O(1).
bool LaplacianDragTool::isStale() {
  const auto layer = on_ && !window_.loading() ? window_.currentLayer() : std::nullopt;
  return layer && (active_ ? layer->id == layer_ && !active_->seemsToMatch(*layer->mesh) : sizeOf(*layer) != refused_);
}

void LaplacianDragTool::end() {
  leaveCanvas();
  if (shared_ && shared_->isUsedBy(*this)) {
    shared_->hidePanel();
    leaveLayer(true);
    shared_->end(*this);
  }
}

void LaplacianDragTool::handOver(bool sameSession) {
  leaveCanvas();
  leaveLayer(!sameSession);
  window_.endTool();
}

void LaplacianDragTool::sessionGone() {
  active_ = nullptr;
  layer_ = -1;
  offered_ = -1;
}

/// MeshLab sends no other signal when the last layer is deleted.
void LaplacianDragTool::layersChanged() {
  if (active_ && !window_.layer(layer_)) {
    shared_->forget(layer_);
    sessionGone();
    nothing_ = tr("There is no mesh: open one first.");
    refreshPanel();
  }
}

/// Gives the view back to MeshLab.
void LaplacianDragTool::leaveCanvas() {
  QWidget& canvas = window_.canvas();
  canvas.removeEventFilter(this);
  canvas.setMouseTracking(false);
  canvas.unsetCursor();
  on_ = false;
}

/// Keeps applied steps and cancels a drag in progress. @param forGood  false: another view goes on with the session
void LaplacianDragTool::leaveLayer(bool forGood) {
  disconnect(&shared_->panel(), nullptr, this, nullptr);
  const auto layer = layer_ >= 0 ? window_.layer(layer_) : std::nullopt;
  if (active_ && !layer) {
    shared_->forget(layer_);
  } else if (active_) {
    DragSession& session = active_->session();
    session.leave();
    session.finish();
    const LayerSession::Update update = active_->update(*layer->mesh);
    if (update == LayerSession::Update::Passing || update == LayerSession::Update::Settled) {
      window_.uploadGeometry(layer_);
    }
    if (forGood) {
      const Edit edit = session.recorded();
      if (!edit.steps.empty() && update != LayerSession::Update::MeshChanged) {
        active_->inHistory = QString::fromStdString(write_edit(edit));
        window_.appendToHistory("Laplacian Edit Replay", active_->inHistory, 1);
      }
      session.keep_painted();  // frees the factorisation, which takes much memory
    }
    active_->leave(*layer->mesh);
  }
  sessionGone();
}

CMeshO* LaplacianDragTool::meshOf(int layer) {
  const auto present = window_.layer(layer);
  return present ? present->mesh : nullptr;
}

void LaplacianDragTool::openPanel() {
  Panel& panel = shared_->panel();
  panel.setCanvas(&window_.canvas());
  disconnect(&panel, nullptr, this, nullptr);
  connect(&panel, &Panel::edited, this, [this](const Panel::Change& change) {
    guarded([&] {
      if (active_) {
        notice_.clear();
        change(active_->session());
        afterEvent();
      }
    });
  });
  connect(&panel, &Panel::command, this, [this](const QString& part) { guarded([&] { command(part); }); });
  connect(&panel, &Panel::closed, this, [this] { window_.endTool(); });
  shared_->showPanel();
  window_.canvas().removeEventFilter(this);
  window_.canvas().installEventFilter(this);
}

/// Returns the session's layer if it exists, is current and is visible.
std::optional<Layer> LaplacianDragTool::usableLayer() {
  if (!active_ || window_.loading()) {
    return std::nullopt;
  }
  auto layer = window_.currentLayer();
  return layer && layer->id == layer_ && layer->visible ? layer : std::nullopt;
}

/// Reads the other layers again if their number of vertices or their transform has changed. Nothing else can have: a
/// filter that changes vertices ends the tool.
std::shared_ptr<const SnapTargets> LaplacianDragTool::findTargets() {
  const auto edited = window_.layer(layer_);
  if (!edited) {
    return nullptr;
  }
  std::vector<std::pair<Layer, Affine>> others;
  std::vector<double> found;
  for (const Layer& layer : window_.layers()) {
    if (layer.visible && layer.id != layer_) {
      const Affine toEdited(Eigen::Matrix4d(edited->transform.inverse() * layer.transform));
      others.emplace_back(layer, toEdited);
      found.insert(found.end(), {double(layer.id), double(layer.mesh->vn), double(layer.mesh->fn)});
      found.insert(found.end(), toEdited.data(), toEdited.data() + toEdited.matrix().size());
    }
  }
  if (!targets_ || found != targetsOf_) {
    std::vector<TriangleMesh> meshes;
    for (const auto& [layer, toEdited] : others) {
      TriangleMesh mesh = read_mesh(*layer.mesh).mesh;
      for (auto vertex : mesh.vertices.rowwise()) {
        vertex = (toEdited * Vector3(vertex.transpose())).transpose();
      }
      if (mesh.faces.rows() > 0 && mesh.faces.minCoeff() >= 0) {
        meshes.push_back(std::move(mesh));
      }
    }
    targets_ = std::make_shared<const SnapTargets>(std::move(meshes));
    targetsOf_ = std::move(found);
  }
  return targets_;
}

// --- After each event -----------------------------------------------------------------------------------------------

void LaplacianDragTool::poll() {
  guarded([this] {
    if (active_) {
      active_->session().poll();
      hover();
      afterEvent();
    }
  });
}

void LaplacianDragTool::afterEvent() {
  if (!active_) {
    return;
  }
  CMeshO* const mesh = meshOf(layer_);
  const LayerSession::Update update = mesh ? active_->update(*mesh) : LayerSession::Update::Nothing;
  if (update == LayerSession::Update::MeshChanged) {
    start();
  } else if (update != LayerSession::Update::Nothing) {
    QElapsedTimer upload;
    upload.start();
    window_.uploadGeometry(layer_);
    clock_.poseArrived(active_->session().figures().solve_ms.value_or(0), active_->writeMilliseconds(),
                       milliseconds(upload));
    if (update == LayerSession::Update::Settled) {
      window_.markModified(layer_);
    }
  }
  refreshPanel();
  showShape();
  window_.repaint();
}

void LaplacianDragTool::refreshPanel() {
  if (!shared_ || !shared_->isUsedBy(*this)) {
    return;
  }
  DragSession* const session = active_ ? &active_->session() : nullptr;
  shared_->panel().show(session, clock_.median());
  shared_->panel().setBusy(
      session && (session->busy() || session->searching() || session->state() == DragSession::State::Settling));
}

// --- The panel's buttons --------------------------------------------------------------------------------------------

void LaplacianDragTool::command(const QString& part) {
  if (part == "help") {
    keysShown_ = !keysShown_;
    window_.repaint();
  }
  const auto layer = usableLayer();
  if (!layer) {
    return;
  }
  notice_.clear();
  DragSession& session = active_->session();
  const std::map<QString, std::function<void()>> commands = {
      {"from_selection", [&] { session.set_region(active_->selected(*layer->mesh)); }},
      {"anchors_from_selection", [&] { session.set_anchors(active_->selected(*layer->mesh)); }},
      {"component", [&] { session.whole_component(); }},
      {"grow", [&] { session.key(DragKey::Grow); }},
      {"shrink", [&] { session.key(DragKey::Shrink); }},
      {"new_region", [&] { session.key(DragKey::NewRegion); }},
      {"clear", [&] { session.clear(); }},
      {"next_group", [&] { session.key(DragKey::NextGroup); }},
      {"move", [&] { session.key(DragKey::Translate, cursor()); }},
      {"rotate", [&] { session.key(DragKey::Rotate, cursor()); }},
      {"scale", [&] { session.key(DragKey::Scale, cursor()); }},
      {"keep_fixed", [&] { session.set(&Tools::keeps_fixed, !session.tools().keeps_fixed); }},
      {"apply", [&] { session.apply(); }},
      {"cancel", [&] { session.cancel(); }},
      {"undo", [&] { session.undo(); }},
      {"redo", [&] { session.redo(); }},
      {"reset", [&] { session.go_to(0); }},
      {"save",
       [&] {
         const std::string line = saveEdit(window_.mainWindow(), session.saved(), editFileFor(*layer));
         if (!line.empty()) {
           say(line);
         }
       }},
      {"load",
       [&] {
         if (const auto edit = loadEdit(window_.mainWindow(), editFileFor(*layer))) {
           session.load(in_space(*edit, space_of_file(layer->file.toStdString())));
         }
       }},
      {"copy",
       [&] {
         QGuiApplication::clipboard()->setText(filterScript(QByteArray::fromStdString(write_edit(session.recorded()))));
         say(tr("A filter script with all steps is on the clipboard.").toStdString());
       }},
  };
  const auto found = commands.find(part);
  if (found != commands.end()) {
    found->second();
  }
  takeKeys();
  afterEvent();
}
