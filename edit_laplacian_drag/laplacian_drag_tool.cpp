// SPDX-License-Identifier: GPL-3.0-or-later
#include "laplacian_drag_tool.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QSaveFile>
#include <QTimer>
#include <QToolTip>
#include <chrono>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit_host/mesh_edit.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

Eigen::Vector3i sizeOf(const Layer& layer) {
  return {layer.id, layer.mesh->vn, layer.mesh->fn};
}

/// How long leaving a layer waits for a released drag, which many are solved in.
constexpr std::chrono::milliseconds kLongestFinish{50};

// --- Files of edits --------------------------------------------------------------------------------------------------

const char* const kEdits = "Laplacian edits (*.json)";
const char* const kScripts = "Filter scripts of MeshLab (*.mlx)";

/// Returns the text of a script that replays an edit, given as JSON, with the filter Laplacian Edit Replay.
QByteArray filterScript(const QByteArray& edit) {
  return QString(R"(<!DOCTYPE FilterScript>
<FilterScript>
    <filter name="Laplacian Edit Replay">
        <Param type="RichString" name="edit" value="%1"/>
        <Param type="RichFloat" name="fraction" value="1"/>
    </filter>
</FilterScript>
)")
      .arg(QString::fromUtf8(edit).toHtmlEscaped().replace('\n', "&#10;"))
      .toUtf8();
}

/// Returns the default file of a layer's edit: <mesh>.laplacian.json in the folder of the mesh.
QString editFileFor(const Layer& layer) {
  const QFileInfo mesh(layer.file.isEmpty() ? layer.name : layer.file);
  return mesh.absoluteDir().filePath(mesh.completeBaseName() + ".laplacian.json");
}

/// Asks for a file, returns at once, and deletes itself: QFileDialog::fileSelected() has the answer.
QFileDialog* askForFile(QWidget* parent, const QString& suggested, bool saves) {
  auto* const dialog = new QFileDialog(parent, saves ? "Save edit" : "Load edit", QFileInfo(suggested).path());
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setNameFilters(saves ? QStringList{kEdits, kScripts} : QStringList{kEdits});
  if (saves) {
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setDefaultSuffix("json");
    const auto setSuffix = [dialog](const QString& filter) {
      dialog->setDefaultSuffix(filter == kScripts ? "mlx" : "json");
    };
    QObject::connect(dialog, &QFileDialog::filterSelected, dialog, setSuffix);
  } else {
    dialog->setFileMode(QFileDialog::ExistingFile);
  }
  if (saves || QFileInfo::exists(suggested)) {
    dialog->selectFile(suggested);
  }
  dialog->open();
  return dialog;
}

/// Writes an edit as JSON or, if the file's name ends in .mlx, as a filter script. @return a line for the user
QString saveEdit(const QString& path, const Edit& edit) {
  const QByteArray json = QByteArray::fromStdString(write_edit(edit));
  const QByteArray text = path.endsWith(".mlx") ? filterScript(json) : json;
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit()) {
    return QString("The edit could not be written to %1: %2.").arg(path, file.errorString());
  }
  return QString("The edit was saved as %1.").arg(path);
}

}  // namespace

LaplacianDragTool::LaplacianDragTool() : others_([this] { later([this] { poll(); }); }) {}

LaplacianDragTool::~LaplacianDragTool() {
  if (shared_) {
    shared_->end(*this);
    for (const auto& [session, layer] : shared_->left(this)) {
      session->leftBy = nullptr;
      session->session.cancel();
    }
  }
}

void LaplacianDragTool::guarded(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::exception& error) {
    say(error.what());
  }
}

void LaplacianDragTool::later(const std::function<void()>& call) {
  QMetaObject::invokeMethod(
      this, [this, call] { guarded(call); }, Qt::QueuedConnection);
}

void LaplacianDragTool::say(const QString& line) {
  notice_ = line;
  mouse_.noticedAt = mouse_.position;
  window_.log(line.toStdString());
}

// --- On and off -----------------------------------------------------------------------------------------------------

bool LaplacianDragTool::start(GLArea* area, MLSceneGLSharedDataContext* shared) {
  window_.attach(area, shared);
  setParent(&window_.viewport());
  bool isStarted = false;
  guarded([&] { isStarted = begin(); });
  return isStarted;
}

void LaplacianDragTool::end() {
  guarded([this] { leave(); });
}

void LaplacianDragTool::changeLayer(GLArea* area, MLSceneGLSharedDataContext* shared) {
  end();
  window_.attach(area, shared);
  if (!window_.currentLayer()) {
    window_.endTool();  // otherwise MeshLab fails at the next change of layer
  } else {
    guarded([this] { begin(); });
  }
}

/// Begins with the current layer. @return false if the tool stays off
bool LaplacianDragTool::begin() {
  shared_ = &WindowSessions::of(*window_.viewport().window());
  sessionGone();
  nothing_.clear();
  refused_.setConstant(-1);
  notice_.clear();
  shown_ = {};
  mouse_.pressed = mouse_.moved = mouse_.inside = false;
  mouse_.navigating = Qt::NoButton;
  frame_.moved = frame_.posed = false;
  others_.forget();
  overlay_ = Overlay();
  const auto layer = window_.currentLayer();
  if (!layer) {
    nothing_ = tr("There is no mesh: open one first.");
    if (!on_) {
      say(nothing_);
      // The tool does not start, and so cannot draw its line over the picture.
      QWidget& viewport = window_.viewport();
      QToolTip::showText(viewport.mapToGlobal(viewport.rect().center()), nothing_, &viewport);
    }
    return on_;
  }
  shared_->begin(*this, window_.document(), layer->id);
  // Connect by name, since the address of MeshLab's signal differs between versions.
  connect(window_.document(), SIGNAL(meshSetChanged()), this, SLOT(layersChanged()),
          static_cast<Qt::ConnectionType>(Qt::QueuedConnection | Qt::UniqueConnection));
  shared_->forgetGone();
  if (window_.loading()) {
    return showNothing(tr("MeshLab is reading a mesh."));  // the first picture of it starts the session
  }
  LayerSession* known = shared_->find(layer->id);
  const bool resume = known != nullptr && known->writer.matches(*layer->mesh);
  if (known != nullptr && known->leftBy != nullptr && !resume) {
    finishLeft(*known, layer->id, true);
  }
  try {
    active_ = resume ? known : &shared_->make(layer->id, *layer->mesh);
    active_->leftBy = nullptr;
  } catch (const EditError& error) {
    say(error.what());
    refused_ = sizeOf(*layer);
    return showNothing(notice_);
  }
  layer_ = layer->id;
  on_ = true;
  openPanel();
  shared_->panel().setMesh(active_->session.original());
  readOthers();
  refreshPanel();
  window_.viewport().setMouseTracking(true);
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

/// Returns whether the current layer is no longer the one that begin() read, as after an import or *Reload*. O(1).
bool LaplacianDragTool::isStale() {
  const auto layer = on_ && !window_.loading() ? window_.currentLayer() : std::nullopt;
  return layer &&
         (active_ ? layer->id == layer_ && !active_->writer.seems_to_match(*layer->mesh) : sizeOf(*layer) != refused_);
}

/// Ends the use of the layer, which may be deleted.
void LaplacianDragTool::leave() {
  leaveViewport();
  if (shared_ && shared_->isUsedBy(*this)) {
    shared_->hidePanel();
    leaveLayer(true);
    shared_->end(*this);
  }
}

void LaplacianDragTool::handOver(bool sameSession) {
  leaveViewport();
  leaveLayer(!sameSession);
  window_.endTool();
}

void LaplacianDragTool::sessionGone() {
  active_ = nullptr;
  layer_ = -1;
}

/// Ends the session of a deleted layer. MeshLab sends no other signal when the last layer is deleted.
void LaplacianDragTool::layersChanged() {
  guarded([this] {
    if (active_ && !window_.layer(layer_)) {
      shared_->forget(*active_);
      sessionGone();
      nothing_ = tr("There is no mesh: open one first.");
      refreshPanel();
    }
  });
}

/// Gives the view back to MeshLab.
void LaplacianDragTool::leaveViewport() {
  QWidget& viewport = window_.viewport();
  viewport.removeEventFilter(this);
  viewport.setMouseTracking(false);
  viewport.unsetCursor();
  on_ = false;
}

/// Keeps applied steps and cancels a drag in progress. A released drag that is still being solved follows later, see
/// finishLeft(). @param forGood  false: another view continues the session
void LaplacianDragTool::leaveLayer(bool forGood) {
  disconnect(&shared_->panel(), nullptr, this, nullptr);
  CMeshO* const mesh = layer_ >= 0 ? meshOf(layer_) : nullptr;
  if (active_ && !mesh) {
    shared_->forget(*active_);
  } else if (active_) {
    active_->session.leave();
    const bool isFinished = active_->session.finish(kLongestFinish);
    write(*active_, layer_);
    if (forGood && !isFinished) {
      active_->leftBy = this;
    } else if (forGood) {
      conclude(*active_);
    }
  }
  sessionGone();
}

/// Writes what has moved into the layer's mesh, and shows it. @return false if other code has changed the mesh, so that
/// no pose was written
bool LaplacianDragTool::write(LayerSession& known, int layer) {
  CMeshO* const mesh = meshOf(layer);
  const PoseChange* const change = mesh ? known.session.take_change() : nullptr;
  if (change) {
    if (!known.writer.write(*mesh, change->vertices, change->positions, change->settled)) {
      return false;
    }
    window_.uploadGeometry(layer);
    if (change->settled) {
      window_.markModified(layer);
    }
    frame_.posed = true;
  }
  return true;
}

/// Ends the use of a session whose layer is left.
void LaplacianDragTool::conclude(LayerSession& session) {
  if (session.session.has_steps()) {
    session.session.keep_painted();  // frees the factorisation, which takes much memory
  } else {
    shared_->keepInheritance(session);
  }
}

/// Writes a drag that was left while it was being solved, or cancels it if other code has changed the mesh.
void LaplacianDragTool::finishLeft(LayerSession& session, int layer, bool now) {
  guarded([&] {
    CMeshO* const mesh = meshOf(layer);
    if (mesh && window_.loading() && !now) {
      shared_->pollSoon();  // a filter may be reading the mesh
      return;
    }
    const bool isSame = mesh && session.writer.matches(*mesh);
    const auto isSolving = [&] { return session.session.state() == DragSession::State::Settling; };
    if (isSame) {
      session.session.poll();
      if (isSolving() && !now) {
        return;  // called again
      }
    }
    if (isSolving()) {
      session.session.cancel();
      window_.log("The drag released last was cancelled: the layer was changed or closed before it was solved.");
    }
    session.leftBy = nullptr;
    if (!mesh) {
      shared_->forget(session);
      return;
    }
    if (isSame) {
      write(session, layer);
      window_.repaint();
    }
    conclude(session);
  });
}

CMeshO* LaplacianDragTool::meshOf(int layer) {
  const auto present = window_.layer(layer);
  return present ? present->mesh : nullptr;
}

void LaplacianDragTool::openPanel() {
  Panel& panel = shared_->panel();
  panel.setViewport(&window_.viewport());
  disconnect(&panel, nullptr, this, nullptr);
  connect(&panel, &Panel::edited, this, [this](const Panel::Change& change) {
    guarded([&] {
      if (active_) {
        notice_.clear();
        change(active_->session);
        afterEvent();
      }
    });
  });
  connect(&panel, &Panel::command, this,
          [this](const QString& part, std::optional<DragKey> key) { guarded([&] { command(part, key); }); });
  connect(&panel, &Panel::closed, this, [this] { window_.endTool(); });
  shared_->showPanel();
  window_.viewport().removeEventFilter(this);
  window_.viewport().installEventFilter(this);
}

/// Returns the session's layer if it exists, is current and is visible.
std::optional<Layer> LaplacianDragTool::usableLayer() {
  if (!active_ || window_.loading()) {
    return std::nullopt;
  }
  auto layer = window_.currentLayer();
  return layer && layer->id == layer_ && layer->visible ? layer : std::nullopt;
}

/// Reads the layers to snap to, if they have changed.
void LaplacianDragTool::readOthers() {
  if (active_ && active_->session.tools().snaps) {
    others_.read(window_.layers(), layer_);
  }
}

// --- After each event -----------------------------------------------------------------------------------------------

void LaplacianDragTool::poll() {
  guarded([this] {
    if (active_) {
      active_->session.poll();
      hover();
      afterEvent();
    }
  });
}

void LaplacianDragTool::afterEvent() {
  if (!active_) {
    return;
  }
  if (!write(*active_, layer_)) {
    begin();
  }
  readOthers();
  refreshPanel();
  showShape();
  window_.repaint();
}

void LaplacianDragTool::refreshPanel() {
  if (!shared_ || !shared_->isUsedBy(*this)) {
    return;
  }
  DragSession* const session = active_ ? &active_->session : nullptr;
  shared_->panel().show(session);
  const bool isReading = session && session->tools().snaps && (others_.targets() == nullptr || others_.busy());
  const bool isSolving = session && session->state() == DragSession::State::Settling;
  // For tests.
  shared_->panel().setProperty("laplacian_drag_busy",
                               session && (session->busy() || session->searching() || isSolving || isReading));
  shared_->panel().setProperty("laplacian_drag_frames", frame_.count);
}

// --- The panel's buttons --------------------------------------------------------------------------------------------

void LaplacianDragTool::command(const QString& part, std::optional<DragKey> key) {
  if (key == DragKey::Help) {
    shown_.keys = !shown_.keys;
    window_.repaint();
  }
  const auto layer = usableLayer();
  if (!layer) {
    return;
  }
  notice_.clear();
  DragSession& session = active_->session;
  const std::optional<BrushTarget> paint = session.tools().paint;
  if (key) {
    session.key(*key, cursor());
  } else if (part == "from_selection") {
    session.set_painted(paint.value_or(BrushTarget::Region),
                        united(selected_vertices(*layer->mesh, active_->coreVertex),
                               vertices_of_selected_faces(*layer->mesh, active_->coreVertex)));
  } else if (part == "invert" || part == "blur") {
    session.change_painted(part == "blur" ? PaintChange::Blur : PaintChange::Invert);
  } else if (part == "component") {
    session.whole_component();
  } else if (part == "clear") {
    paint ? session.change_painted(PaintChange::Clear) : session.clear();
  } else if (part == "reset") {
    session.go_to(0);
  } else {
    ask(*layer, part == "save");
  }
  takeKeys();
  afterEvent();
}

/// Saves or loads an edit. The dialog does not wait for its answer, since anything may happen to the session while it
/// is open.
void LaplacianDragTool::ask(const Layer& layer, bool saves) {
  const auto answered = [this, saves, id = layer.id,
                         edit = saves ? active_->session.saved() : Edit()](const QString& path) {
    guarded([&] {
      if (!saves) {
        return load(path, id);
      }
      say(saveEdit(path, edit));
      takeKeys();
      window_.repaint();
    });
  };
  const QFileDialog* const dialog = askForFile(window_.viewport().window(), editFileFor(layer), saves);
  connect(dialog, &QFileDialog::fileSelected, this, answered, Qt::QueuedConnection);
}

/// Applies a saved edit to a layer, which has to be the current one still.
void LaplacianDragTool::load(const QString& path, int id) {
  const auto layer = usableLayer();
  if (!layer || layer->id != id) {
    say(tr("The edit was not loaded, since the layer is not the current one any more: switch to it, and load again."));
    return;
  }
  std::vector<DocumentLayer> layers;
  for (const Layer& each : window_.layers()) {
    layers.push_back({each.name, each.file.toStdString(), each.mesh});
  }
  const Edit edit =
      with_scans(load_edit(path.toStdString(), &active_->session.original()), layer_reader(layers, *layer->mesh));
  active_->session.load(in_space(edit, space_of_file(layer->file.toStdString())), transform_note(*layer->mesh));
  takeKeys();
  afterEvent();
}
