// SPDX-License-Identifier: GPL-3.0-or-later
#include "laplacian_drag_tool.h"

#include <QtGui/qopengl.h>
#include <QClipboard>
#include <QGuiApplication>
#include <QMainWindow>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "edit_file_dialogs.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit_host/mesh_bridge.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

constexpr int kDragPixels = 3;     // what moves less is a click
constexpr int kLongestWait = 200;  // milliseconds without a picture
constexpr double kRadiusPerNotch = 1.1, kHandleSharePerNotch = 1.25, kPaddingPerNotch = 0.02;
constexpr double kSmallestHandleShare = 0.01;  // below it is a single vertex

double milliseconds(const QElapsedTimer& timer) {
  return static_cast<double>(timer.nsecsElapsed()) * 1e-6;
}

Eigen::Matrix4d matrixOf(GLenum which) {
  Eigen::Matrix4d matrix;  // by columns, as OpenGL has it
  glGetDoublev(which, matrix.data());
  return matrix;
}

/// The session's name of a key.
std::optional<DragKey> sessionKey(const QKeyEvent& event) {
  const int key = event.key();
  const Qt::KeyboardModifiers modifiers = event.modifiers();
  if ((modifiers & Qt::ControlModifier) && key == Qt::Key_Z) {
    return modifiers & Qt::ShiftModifier ? DragKey::Redo : DragKey::Undo;
  }
  if ((modifiers & Qt::ControlModifier) && key == Qt::Key_Y) {
    return DragKey::Redo;
  }
  // On many keyboards brackets take a modifier.
  if (key == Qt::Key_BracketRight || key == Qt::Key_BracketLeft) {
    return key == Qt::Key_BracketRight ? DragKey::Grow : DragKey::Shrink;
  }
  if (modifiers & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier)) {
    return std::nullopt;
  }
  if (key >= Qt::Key_0 && key <= Qt::Key_9) {
    return digit_key(key - Qt::Key_0);
  }
  static const std::map<int, DragKey> keys = {
      {Qt::Key_Return, DragKey::Apply}, {Qt::Key_Enter, DragKey::Apply}, {Qt::Key_Backspace, DragKey::Cancel},
      {Qt::Key_Period, DragKey::Point}, {Qt::Key_Comma, DragKey::Point}, {Qt::Key_Minus, DragKey::Minus},
      {Qt::Key_X, DragKey::LockX},      {Qt::Key_Y, DragKey::LockY},     {Qt::Key_Z, DragKey::LockZ},
      {Qt::Key_N, DragKey::LockNormal}, {Qt::Key_T, DragKey::Translate}, {Qt::Key_R, DragKey::Rotate},
      {Qt::Key_S, DragKey::Scale},      {Qt::Key_G, DragKey::NextGroup}, {Qt::Key_C, DragKey::Curve},
      {Qt::Key_W, DragKey::NewRegion}};
  const auto found = keys.find(key);
  return found != keys.end() ? std::optional<DragKey>(found->second) : std::nullopt;
}

}  // namespace

LaplacianDragTool::LaplacianDragTool(HostWindow& window) : window_(window) {}

LaplacianDragTool::~LaplacianDragTool() {
  delete panel_;
}

/// Whatever a button or the worker starts must not throw into Qt.
template <class Call>
void LaplacianDragTool::guarded(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    say(error.what());
  }
}

void LaplacianDragTool::say(const std::string& line) {
  notice_ = line;
  window_.log(line);
}

// --- On and off -----------------------------------------------------------------------------------------------------

bool LaplacianDragTool::start() {
  active_ = nullptr;
  layer_ = -1;
  nothing_.clear();
  notice_.clear();
  mouse_.pressed = mouse_.moved = false;
  mouse_.navigating = Qt::NoButton;
  clock_.reset();
  overlay_ = Overlay();
  const auto layer = window_.currentLayer();
  if (!layer) {
    if (!on_) {
      say("There is no mesh: open one first.");
    }
    nothing_ = "There is no mesh: open one first.";
    return on_;
  }
  forgetGoneLayers();
  const auto known = sessions_.find(layer->id);
  const bool resume = known != sessions_.end() && known->second->wasLeftLike(*layer->mesh) &&
                      (known->second->inHistory.isEmpty() ||
                       window_.removeFromHistory("Laplacian Edit Replay", known->second->inHistory));
  try {
    if (!resume) {
      sessions_.erase(layer->id);
      sessions_[layer->id] = std::make_unique<LayerSession>(*layer->mesh, callbacksFor(layer->id));
    }
  } catch (const EditError& error) {
    nothing_ = error.what();
    say(nothing_);
    if (!on_) {
      return false;
    }
    openPanel();
    refreshPanel();
    return true;
  }
  active_ = sessions_[layer->id].get();
  active_->inHistory.clear();
  layer_ = layer->id;
  on_ = true;
  openPanel();
  panel_->setMeshSize(finite_diagonal(*layer->mesh));
  refreshPanel();
  window_.canvas().setFocus();
  window_.canvas().setMouseTracking(true);
  return true;
}

void LaplacianDragTool::end() {
  if (panel_) {
    panel_->hide();
  }
  window_.canvas().removeEventFilter(this);
  window_.canvas().setMouseTracking(false);
  const auto layer = layer_ >= 0 ? window_.layer(layer_) : std::nullopt;
  if (active_ && !layer) {
    sessions_.erase(layer_);
  } else if (active_) {
    DragSession& session = active_->session();
    session.finish();
    if (active_->foundChanged()) {
      sessions_.erase(layer_);
    } else {
      bool settled = true;
      if (active_->takeWritten(settled)) {
        window_.uploadGeometry(layer_);
      }
      const Edit edit = session.recorded();
      if (!edit.steps.empty()) {
        active_->inHistory = QString::fromStdString(write_edit(edit));
        window_.appendToHistory("Laplacian Edit Replay", active_->inHistory, 1);
      }
      session.clear();  // the factor takes much memory
      active_->leave(*layer->mesh);
    }
  }
  active_ = nullptr;
  layer_ = -1;
  on_ = false;
}

LayerSession::Callbacks LaplacianDragTool::callbacksFor(int layer) {
  LayerSession::Callbacks callbacks;
  callbacks.mesh = [this, layer]() -> CMeshO* {
    const auto present = window_.layer(layer);
    return present ? present->mesh : nullptr;
  };
  callbacks.log = [this](const std::string& line) { window_.log(line); };
  callbacks.wake = [this] {
    if (!pollQueued_.exchange(true)) {
      QMetaObject::invokeMethod(
          this, [this] { poll(); }, Qt::QueuedConnection);
    }
  };
  return callbacks;
}

void LaplacianDragTool::forgetGoneLayers() {
  for (auto known = sessions_.begin(); known != sessions_.end();) {
    known = window_.layer(known->first) ? std::next(known) : sessions_.erase(known);
  }
}

void LaplacianDragTool::openPanel() {
  if (!panel_) {
    panel_ = new Panel(window_.mainWindow(), &window_.canvas());
    connect(panel_, &Panel::settingsEdited, this, [this](const DragSettings& settings) {
      guarded([&] {
        if (active_) {
          active_->session().set_settings(settings);
          afterEvent();
        }
      });
    });
    connect(panel_, &Panel::handleModeEdited, this, [this](HandleMode mode) {
      guarded([&] {
        if (active_) {
          active_->session().set_handle_mode(mode);
          afterEvent();
        }
      });
    });
    connect(panel_, &Panel::command, this, [this](const QString& part) { guarded([&] { command(part); }); });
    connect(panel_, &Panel::closed, this, [this] {
      if (on_) {
        window_.endTool();
      }
    });
    if (window_.mainWindow() != nullptr) {
      window_.mainWindow()->addDockWidget(Qt::LeftDockWidgetArea, panel_);
    }
  }
  panel_->QDockWidget::show();
  window_.canvas().removeEventFilter(this);
  window_.canvas().installEventFilter(this);
}

/// The layer that the session belongs to, if it is still there, current and visible.
std::optional<Layer> LaplacianDragTool::usableLayer() {
  if (!active_) {
    return std::nullopt;
  }
  auto layer = window_.currentLayer();
  return layer && layer->id == layer_ && layer->visible ? layer : std::nullopt;
}

// --- Drawing --------------------------------------------------------------------------------------------------------

void LaplacianDragTool::draw() {
  const auto current = window_.currentLayer();
  if (!current) {
    return;
  }
  const auto layer = usableLayer();
  std::string line = nothing_;
  if (active_ && !layer) {
    line = "The layer is hidden: make it visible to edit it.";
  } else if (layer) {
    const QWidget& canvas = window_.canvas();
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glMultMatrixd(layer->transform.data());
    view_ = Camera(matrixOf(GL_PROJECTION_MATRIX) * matrixOf(GL_MODELVIEW_MATRIX), canvas.width(), canvas.height());
    DragSession& session = active_->session();
    Overlay::Options options;
    options.width = canvas.width();
    options.height = canvas.height();
    options.pixelRatio = canvas.devicePixelRatioF();
    const bool takes = mouse_.modifiers & Qt::ShiftModifier;
    if ((takes || mouse_.modifiers & Qt::ControlModifier) && !session.motion()) {
      options.brush = Overlay::Brush{cursor().pixel, session.settings().brush_pixels, takes};
    }
    overlay_.draw(session, view_, options);
    glPopMatrix();
    line = !notice_.empty()      ? notice_
           : window_.suspended() ? "Suspended: the mouse turns the view. Esc goes on with dragging."
                                 : session.message();
    if (session.preparing()) {
      line += "  [preparing: " + std::string(session.stage()) + ", " +
              std::to_string(static_cast<int>(100 * session.progress())) + " %]";
    }
  }
  if (!line.empty()) {
    window_.showLine(kTitle, QString::fromStdString(line));
  }
}

/// MeshLab draws after each mouse move, which is too early while the pose for it is still being solved: drawing twice
/// would take twice as long.
bool LaplacianDragTool::poseIsComing() const {
  return active_ && active_->session().motion() && active_->session().in_hand() && active_->session().busy() &&
         clock_.waitsForPose(kLongestWait);
}

/// Measures drawing from outside: the picture is on the screen once the paint event is over.
bool LaplacianDragTool::eventFilter(QObject* object, QEvent* event) {
  if (event->type() == QEvent::Paint && on_) {
    if (poseIsComing()) {
      return true;
    }
    clock_.paintBegins();
    QMetaObject::invokeMethod(
        this, [this] { framePainted(); }, Qt::QueuedConnection);
  }
  return QObject::eventFilter(object, event);
}

void LaplacianDragTool::framePainted() {
  if (clock_.painted() && panel_) {
    panel_->setFrames(clock_.frames());
    refreshPanel();
  }
}

// --- Mouse and keys -------------------------------------------------------------------------------------------------

Cursor LaplacianDragTool::cursor() const {
  return {view_, Vector2(mouse_.position.x(), mouse_.position.y())};
}

void LaplacianDragTool::mousePress(QMouseEvent& event) {
  mouse_.position = event.localPos();
  mouse_.modifiers = event.modifiers();
  notice_.clear();
  const bool around = event.button() != Qt::LeftButton || (event.modifiers() & Qt::AltModifier);
  if (around) {
    if (mouse_.navigating == Qt::NoButton && !mouse_.pressed) {
      mouse_.navigating = event.button();
      window_.navigate(event, event.button() == Qt::MiddleButton ? Qt::MiddleButton : Qt::LeftButton);
    }
    return;
  }
  const auto layer = usableLayer();
  if (!layer || !view_.valid() || mouse_.navigating != Qt::NoButton) {
    return;
  }
  if (active_->session().state() == DragSession::State::Picked ||
      active_->session().state() == DragSession::State::Idle) {
    if (!active_->matches(*layer->mesh)) {
      say("The mesh was changed by something else: starting afresh from what it is now.");
      sessions_.erase(layer_);
      start();
      if (!active_) {
        return;
      }
    }
  }
  mouse_.pressed = true;
  mouse_.moved = false;
  mouse_.pressedAt = event.localPos();
  active_->session().press(
      cursor(), {bool(event.modifiers() & Qt::ControlModifier), bool(event.modifiers() & Qt::ShiftModifier)});
  afterEvent();
}

void LaplacianDragTool::mouseMove(QMouseEvent& event) {
  mouse_.position = event.localPos();
  mouse_.modifiers = event.modifiers();
  if (mouse_.navigating != Qt::NoButton) {
    window_.navigate(event, mouse_.navigating == Qt::MiddleButton ? Qt::MiddleButton : Qt::LeftButton);
    return;
  }
  if (!usableLayer() || !view_.valid()) {
    return;
  }
  if (mouse_.pressed && !(event.buttons() & Qt::LeftButton)) {
    // The release went elsewhere: to the view while the tool was suspended, or to a dialog.
    mouse_.pressed = false;
    active_->session().cancel();
    afterEvent();
    return;
  }
  if (mouse_.pressed && !mouse_.moved) {
    mouse_.moved = (event.localPos() - mouse_.pressedAt).manhattanLength() >= kDragPixels;
    if (!mouse_.moved) {
      return;
    }
  }
  DragSession& session = active_->session();
  session.move(cursor());
  if (session.motion()) {
    clock_.mouseMoved();
  }
  afterEvent();
}

void LaplacianDragTool::mouseRelease(QMouseEvent& event) {
  mouse_.position = event.localPos();
  mouse_.modifiers = event.modifiers();
  if (mouse_.navigating != Qt::NoButton) {
    if (event.button() == mouse_.navigating) {
      window_.navigate(event, mouse_.navigating == Qt::MiddleButton ? Qt::MiddleButton : Qt::LeftButton);
      mouse_.navigating = Qt::NoButton;
    }
    return;
  }
  if (event.button() != Qt::LeftButton || !std::exchange(mouse_.pressed, false)) {
    return;
  }
  if (!usableLayer() || !view_.valid()) {
    if (active_) {
      active_->session().cancel();  // hidden meanwhile
      afterEvent();
    }
    return;
  }
  Cursor at = cursor();
  if (!mouse_.moved) {
    at.pixel = Vector2(mouse_.pressedAt.x(), mouse_.pressedAt.y());
  }
  active_->session().release(at);
  afterEvent();
}

void LaplacianDragTool::wheel(QWheelEvent& event) {
  event.accept();
  notice_.clear();
  if (event.modifiers() & Qt::AltModifier) {
    window_.navigate(event);
    return;
  }
  if (!usableLayer()) {
    return;
  }
  const int angle = event.angleDelta().y() != 0 ? event.angleDelta().y() : event.angleDelta().x();
  const double notches = angle / 120.0;
  DragSettings settings = active_->session().settings();
  if (event.modifiers() & Qt::ShiftModifier) {
    settings.padding = std::clamp(settings.padding + kPaddingPerNotch * notches, 0.0, 1.0);
  } else if (event.modifiers() & Qt::ControlModifier) {
    const double grown =
        std::max(settings.handle_share, kSmallestHandleShare) * std::pow(kHandleSharePerNotch, notches);
    settings.handle_share = grown < kSmallestHandleShare ? 0 : std::min(grown, kLargestHandleShare);
  } else {
    settings.radius *= std::pow(kRadiusPerNotch, notches);
  }
  active_->session().set_settings(settings);
  afterEvent();
}

void LaplacianDragTool::keyPress(QKeyEvent& event) {
  mouse_.modifiers = event.modifiers();
  if (event.key() == Qt::Key_Control) {
    mouse_.modifiers |= Qt::ControlModifier;
  } else if (event.key() == Qt::Key_Shift) {
    mouse_.modifiers |= Qt::ShiftModifier;
  }
  window_.repaint();
  if (!usableLayer()) {
    return;
  }
  notice_.clear();
  const std::optional<DragKey> key = sessionKey(event);
  if (key && active_->session().key(*key, cursor())) {
    event.accept();
    afterEvent();
  }
}

void LaplacianDragTool::keyRelease(QKeyEvent& event) {
  mouse_.modifiers = event.modifiers();
  if (event.key() == Qt::Key_Control) {
    mouse_.modifiers &= ~Qt::KeyboardModifiers(Qt::ControlModifier);
  } else if (event.key() == Qt::Key_Shift) {
    mouse_.modifiers &= ~Qt::KeyboardModifiers(Qt::ShiftModifier);
  }
  window_.repaint();
}

// --- After each event -----------------------------------------------------------------------------------------------

void LaplacianDragTool::poll() {
  pollQueued_ = false;
  guarded([this] {
    if (active_) {
      active_->session().poll();
      afterEvent();
    }
  });
}

void LaplacianDragTool::afterEvent() {
  if (!active_) {
    return;
  }
  bool settled = true;
  if (active_->takeWritten(settled)) {
    QElapsedTimer upload;
    upload.start();
    window_.uploadGeometry(layer_);
    clock_.poseArrived(active_->session().figures().solve_ms.value_or(0), active_->writeMilliseconds(),
                       milliseconds(upload));
    if (settled) {
      window_.markModified(layer_);
    }
  }
  if (active_->foundChanged()) {
    say("The mesh was changed by something else while it was dragged: starting afresh from what it is now.");
    sessions_.erase(layer_);
    mouse_.pressed = false;
    start();
  }
  refreshPanel();
  window_.repaint();
}

void LaplacianDragTool::refreshPanel() {
  if (!panel_) {
    return;
  }
  const DragSession* session = active_ ? &active_->session() : nullptr;
  panel_->show(session, clock_.median());
  panel_->setBusy(session && (session->busy() || session->state() == DragSession::State::Settling));
}

// --- The panel's buttons --------------------------------------------------------------------------------------------

void LaplacianDragTool::command(const QString& part) {
  const auto layer = usableLayer();
  if (!layer) {
    return;
  }
  notice_.clear();
  DragSession& session = active_->session();
  const std::map<QString, std::function<void()>> commands = {
      {"from_selection",
       [&] { session.set_region(vertices_of_selected_faces(*layer->mesh, read_mesh(*layer->mesh))); }},
      {"component", [&] { session.whole_component(); }},
      {"grow", [&] { session.grow(); }},
      {"shrink", [&] { session.shrink(); }},
      {"new_region", [&] { session.new_region(); }},
      {"clear", [&] { session.clear(); }},
      {"next_group", [&] { session.next_group(); }},
      {"move", [&] { session.key(DragKey::Translate, cursor()); }},
      {"rotate", [&] { session.key(DragKey::Rotate, cursor()); }},
      {"scale", [&] { session.key(DragKey::Scale, cursor()); }},
      {"apply", [&] { session.apply(); }},
      {"cancel", [&] { session.cancel(); }},
      {"undo", [&] { session.undo(); }},
      {"redo", [&] { session.redo(); }},
      {"reset", [&] { session.reset(); }},
      {"save",
       [&] {
         const std::string line = saveEdit(window_.mainWindow(), session.recorded());
         if (!line.empty()) {
           say(line);
         }
       }},
      {"load",
       [&] {
         if (const auto edit = loadEdit(window_.mainWindow())) {
           session.load(*edit);
         }
       }},
      {"copy",
       [&] {
         QGuiApplication::clipboard()->setText(filterScript(QByteArray::fromStdString(write_edit(session.recorded()))));
         say("A filter script with all steps is on the clipboard.");
       }},
  };
  const auto found = commands.find(part);
  if (found != commands.end()) {
    found->second();
  }
  window_.canvas().setFocus();
  afterEvent();
}
