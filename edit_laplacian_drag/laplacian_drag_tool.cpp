// SPDX-License-Identifier: GPL-3.0-or-later
#include "laplacian_drag_tool.h"

#include <QtGui/qopengl.h>
#include <QApplication>
#include <QClipboard>
#include <QGuiApplication>
#include <QMainWindow>
#include <QTimer>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "edit_file_dialogs.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/mesh/ray_cast.h"
#include "lapedit_host/mesh_bridge.h"
#include "panel_widgets.h"
#include "pen.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

constexpr int kDragPixels = 3;     // what moves less is a click
constexpr int kNoticePixels = 12;  // a notice goes when the mouse has gone on by this
constexpr int kLongestWait = 200;  // milliseconds without a picture
constexpr int kDashWait = 100;     // milliseconds between pictures that only show that something is prepared
constexpr int kDashShare = 5;      // and at least as many times what one takes
constexpr const char* kLineProperty = "laplacian_drag_line";  // of the canvas, for tests
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
  if (modifiers == Qt::ControlModifier && (key == Qt::Key_Y || key == Qt::Key_C)) {
    return key == Qt::Key_Y ? DragKey::Redo : DragKey::Copy;
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
  static const std::map<int, DragKey> keys = {{Qt::Key_Return, DragKey::Apply},     {Qt::Key_Enter, DragKey::Apply},
                                              {Qt::Key_Backspace, DragKey::Cancel}, {Qt::Key_Period, DragKey::Point},
                                              {Qt::Key_Comma, DragKey::Point},      {Qt::Key_Minus, DragKey::Minus},
                                              {Qt::Key_F1, DragKey::Help}};
  const auto found = keys.find(key);
  if (found != keys.end()) {
    return found->second;
  }
  // Qt numbers letters as ASCII does, and those of the session are called as they are on the keyboard.
  const auto letter = std::find_if(std::begin(kKeyHelp), std::end(kKeyHelp),
                                   [key](const KeyHelp& help) { return help.name[0] == key && help.name[1] == '\0'; });
  return letter != std::end(kKeyHelp) ? std::optional<DragKey>(letter->first) : std::nullopt;
}

/// Keys that are the window's business, and that MeshLab may have another use for.
bool isOfWindow(std::optional<DragKey> key) {
  return key == DragKey::Copy || key == DragKey::Help;
}

/// "1, 2, 3"
QString placeOf(const TriangleMesh& mesh, int vertex, int digits) {
  QStringList numbers;
  for (int k = 0; k < 3; ++k) {
    numbers += QString::number(mesh.vertices(vertex, k), 'g', digits);
  }
  return numbers.join(", ");
}

}  // namespace

LaplacianDragTool::LaplacianDragTool(HostWindow& window) : window_(window) {}

LaplacianDragTool::~LaplacianDragTool() {
  if (shared_) {
    shared_->end(*this);
  }
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

/// Keys are for what the mouse is over.
void LaplacianDragTool::takeKeys() {
  if (on_ && !window_.canvas().hasFocus() && QApplication::activePopupWidget() == nullptr &&
      QApplication::activeModalWidget() == nullptr) {
    window_.canvas().setFocus(Qt::MouseFocusReason);
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
      // The tool does not start, so that the picture is not its own.
      QWidget& canvas = window_.canvas();
      QToolTip::showText(canvas.mapToGlobal(canvas.rect().center()), nothing_, &canvas);
    }
    return on_;
  }
  shared_->begin(*this, window_.document(), layer->id);
  // By name, as MeshLab's signals have no address that plugins of all versions could take.
  connect(window_.document(), SIGNAL(meshSetChanged()), this, SLOT(layersChanged()),
          static_cast<Qt::ConnectionType>(Qt::QueuedConnection | Qt::UniqueConnection));
  shared_->forgetGone();
  LayerSession* known = shared_->find(layer->id);
  const bool resume =
      known != nullptr && known->wasLeftLike(*layer->mesh) &&
      (known->inHistory.isEmpty() || window_.removeFromHistory("Laplacian Edit Replay", known->inHistory));
  try {
    active_ = resume ? known : &shared_->make(layer->id, *layer->mesh);
    if (!resume) {
      shared_->panel().remembered().bringTo(active_->session());
    }
  } catch (const EditError& error) {
    nothing_ = error.what();
    say(error.what());
    on_ = true;
    openPanel();
    refreshPanel();
    return true;
  }
  active_->inHistory.clear();
  layer_ = layer->id;
  on_ = true;
  openPanel();
  shared_->panel().setMesh(active_->session().original());
  refreshPanel();
  window_.canvas().setMouseTracking(true);
  takeKeys();
  // Menus, tool bars and docks take them after this.
  QTimer::singleShot(0, this, [this] { takeKeys(); });
  return true;
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

/// Of the last layer MeshLab says nothing when it goes.
void LaplacianDragTool::layersChanged() {
  if (active_ && !window_.layer(layer_)) {
    shared_->forget(layer_);
    sessionGone();
    nothing_ = tr("There is no mesh: open one first.");
    refreshPanel();
  }
}

/// The view is the host's again.
void LaplacianDragTool::leaveCanvas() {
  QWidget& canvas = window_.canvas();
  canvas.removeEventFilter(this);
  canvas.setMouseTracking(false);
  canvas.unsetCursor();
  on_ = false;
}

/// What was applied stays, what is in progress is dropped. @param forGood  not for another view
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
    if (update == LayerSession::Update::MeshChanged) {
      shared_->forget(layer_);
    } else {
      if (update != LayerSession::Update::Nothing) {
        window_.uploadGeometry(layer_);
      }
      if (forGood) {
        const Edit edit = session.recorded();
        if (!edit.steps.empty()) {
          active_->inHistory = QString::fromStdString(write_edit(edit));
          window_.appendToHistory("Laplacian Edit Replay", active_->inHistory, 1);
        }
        session.clear();  // the factor takes much memory
      }
      active_->leave(*layer->mesh);
    }
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
  const auto layer = usableLayer();
  const QWidget& canvas = window_.canvas();
  worldToClip_ = matrixOf(GL_PROJECTION_MATRIX) * matrixOf(GL_MODELVIEW_MATRIX);
  if (layer) {
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glMultMatrixd(layer->transform.data());
    view_ = Camera(worldToClip_ * layer->transform, canvas.width(), canvas.height());
    DragSession& session = active_->session();
    Overlay::Options options;
    options.width = canvas.width();
    options.height = canvas.height();
    options.pixelRatio = canvas.devicePixelRatioF();
    options.heat = shared_->panel().heat();
    const bool takes = mouse_.modifiers & Qt::ShiftModifier;
    if ((takes || mouse_.modifiers & Qt::ControlModifier || session.keeps_fixed()) && !session.motion()) {
      options.brush = Overlay::Brush{cursor().pixel, session.settings().brush_pixels, takes};
    }
    overlay_.draw(session, view_, options);
    glPopMatrix();
    if (window_.suspended() && session.motion()) {
      // By MeshLab's button or menu; not from here, since nothing can be uploaded while drawing.
      QMetaObject::invokeMethod(
          this, [this] { dropMotion(); }, Qt::QueuedConnection);
    }
  }
  drawLine(line(layer.has_value()));
}

/// What the line over the picture says. @param usable  there is a layer to edit
LinePicture::Line LaplacianDragTool::line(bool usable) {
  if (!usable) {
    return {active_ ? tr("The layer is hidden: make it visible to edit it.") : nothing_, {}, {}};
  }
  const DragSession& session = active_->session();
  LinePicture::Line line;
  line.text = !notice_.isEmpty()    ? notice_
              : window_.suspended() ? tr("Suspended: the mouse turns the view. Esc resumes the tool.")
                                    : QString::fromStdString(session.message());
  if (session.preparing()) {
    line.text += tr("  [preparing: %1, %2 %]").arg(session.stage()).arg(static_cast<int>(100 * session.progress()));
  }
  if (const std::string warning = session.warning(); !warning.empty() && notice_.isEmpty()) {
    line.warning = QString::fromStdString(warning);
    if (!session.motion() && !shared_->panel().heat()) {
      line.warning += tr(" Click here to see where.");
    }
  }
  if (const HoverPreview* const hover = session.hover(); hover && !window_.suspended() && !session.motion()) {
    line.place =
        tr("Vertex %1 at %2 (Ctrl+C copies)").arg(hover->vertex).arg(placeOf(session.mesh(), hover->vertex, 6));
  }
  return line;
}

/// The cursor, unless the line is there to be pressed, and the handle.
QVector<QPointF> LaplacianDragTool::notToCover() const {
  QVector<QPointF> pixels;
  if (active_ && view_.valid()) {
    const DragSession& session = active_->session();
    if (offered_ < 0 && session.warning().empty()) {
      pixels += mouse_.position;
    }
    if (session.active_group() >= 0) {
      const Vector3 place = session.active_map() *
                            centroid(session.mesh().vertices, session.groups()[std::size_t(session.active_group())]);
      const Vector2 pixel = view_.pixel(place);
      pixels += QPointF(pixel.x(), pixel.y());
    }
  }
  return pixels;
}

void LaplacianDragTool::drawLine(const LinePicture::Line& line) {
  QWidget& canvas = window_.canvas();
  QStringList texts{line.text, line.warning, line.place};
  texts.removeAll(QString());
  canvas.setProperty(kLineProperty, keysShown_ ? "keys" : texts.join('\n'));
  if (texts.isEmpty()) {
    return;
  }
  const pen::FlatState state;
  const pen::InPixels pixels(canvas.width(), canvas.height());
  if (keysShown_) {
    linePicture_.drawKeys(canvas.size(), canvas.devicePixelRatioF());
  } else {
    linePicture_.draw(line, canvas.size(), canvas.devicePixelRatioF(), notToCover());
  }
}

/// MeshLab draws after each mouse move, which is too early while the pose for it is still being solved: drawing twice
/// would take twice as long.
bool LaplacianDragTool::poseIsComing() const {
  return active_ && active_->session().motion() && active_->session().in_hand() && active_->session().busy() &&
         clock_.waitsForPose(kLongestWait);
}

/// Measures drawing from outside: the picture is on the screen once the paint event is over. Takes what MeshLab tells
/// no tool of.
bool LaplacianDragTool::eventFilter(QObject* object, QEvent* event) {
  switch (event->type()) {
    case QEvent::Paint:
      if (poseIsComing()) {
        return true;
      }
      clock_.paintBegins();
      QMetaObject::invokeMethod(
          this, [this] { framePainted(); }, Qt::QueuedConnection);
      break;
    case QEvent::ShortcutOverride:
      if (isOfWindow(sessionKey(static_cast<QKeyEvent&>(*event)))) {
        event->accept();
        return true;
      }
      return escape(*event);
    case QEvent::KeyPress:
      return escape(*event);
    case QEvent::Enter:
      takeKeys();
      break;
    case QEvent::Leave:
      mouse_.inside = false;
      if (active_) {
        active_->session().leave();
        window_.repaint();
      }
      break;
    case QEvent::DeferredDelete:  // the view is being closed
      guarded([this] { end(); });
      break;
    default:
      break;
  }
  return QObject::eventFilter(object, event);
}

/// Esc hides the table of keys, drops what is moved or worked out, ends painting; without these it is MeshLab's, which
/// would take it first. @return whether the event is over
bool LaplacianDragTool::escape(QEvent& event) {
  if (static_cast<QKeyEvent&>(event).key() != Qt::Key_Escape || !active_ || window_.suspended()) {
    return false;
  }
  DragSession& session = active_->session();
  const DragSession::State state = session.state();
  const bool moves = state == DragSession::State::Dragging || state == DragSession::State::Settling;
  if (!moves && !session.keeps_fixed() && !keysShown_) {
    return false;
  }
  event.accept();
  if (event.type() != QEvent::KeyPress) {
    return true;
  }
  if (keysShown_) {
    keysShown_ = false;
    window_.repaint();
  } else if (moves) {
    dropMotion();
  } else {
    session.set_keep_fixed(false);
    afterEvent();
  }
  return true;
}

void LaplacianDragTool::dropMotion() {
  guarded([this] {
    if (active_) {
      mouse_.pressed = false;
      notice_.clear();
      active_->session().cancel();
      afterEvent();
    }
  });
}

void LaplacianDragTool::framePainted() {
  if (clock_.painted() && shared_ && shared_->isUsedBy(*this)) {
    shared_->panel().setFrames(clock_.frames());
    refreshPanel();
  }
  // While a region is prepared its outline wanders, as often as leaves the processor to the preparation.
  if (active_ && active_->session().preparing() && !std::exchange(repaintQueued_, true)) {
    QTimer::singleShot(std::max(kDashWait, kDashShare * clock_.sincePaint()), this, [this] {
      repaintQueued_ = false;
      if (on_) {
        window_.repaint();
      }
    });
  }
}

// --- Mouse and keys -------------------------------------------------------------------------------------------------

Cursor LaplacianDragTool::cursor() const {
  Cursor cursor;
  cursor.view = view_;
  cursor.pixel = Vector2(mouse_.position.x(), mouse_.position.y());
  cursor.snap = mouse_.modifiers & Qt::ControlModifier;
  return cursor;
}

PressModifiers LaplacianDragTool::pressModifiers() const {
  return {bool(mouse_.modifiers & Qt::ControlModifier), bool(mouse_.modifiers & Qt::ShiftModifier)};
}

/// Shows what a press would take.
void LaplacianDragTool::hover() {
  if (mouse_.inside && !window_.suspended() && usableLayer() && view_.valid() &&
      active_->session().hover(cursor(), pressModifiers())) {
    window_.repaint();
  }
}

Qt::CursorShape LaplacianDragTool::shape() const {
  const DragSession& session = active_->session();
  if (session.motion()) {
    return Qt::ClosedHandCursor;
  }
  if (session.preparing() && !session.in_hand()) {
    return Qt::BusyCursor;
  }
  if (mouse_.modifiers & (Qt::ControlModifier | Qt::ShiftModifier)) {
    return Qt::CrossCursor;
  }
  if (session.gizmo_part() != GizmoPart::None) {
    return Qt::SizeAllCursor;
  }
  const HoverPreview* const hover = session.hover();
  return !hover                                     ? Qt::ArrowCursor
         : hover->kind == HoverPreview::Kind::Group ? Qt::OpenHandCursor
                                                    : Qt::PointingHandCursor;
}

void LaplacianDragTool::showShape() {
  QWidget& canvas = window_.canvas();
  if (!active_ || window_.suspended() || mouse_.navigating != Qt::NoButton) {
    return;
  }
  if (canvas.cursor().shape() != shape()) {
    canvas.setCursor(shape());
  }
}

void LaplacianDragTool::mousePress(QMouseEvent& event) {
  mouse_.position = event.localPos();
  mouse_.modifiers = event.modifiers();
  takeKeys();
  if (event.button() == Qt::LeftButton && pressLine()) {
    return;
  }
  notice_.clear();
  offered_ = -1;
  keysShown_ = false;
  if (event.button() == Qt::RightButton && active_ && active_->session().motion()) {
    dropMotion();
    return;
  }
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
      shared_->forget(layer_);
      start();
      say(tr("The mesh was changed by another tool or filter: the session starts again from its current state.")
              .toStdString());
      if (!active_) {
        return;
      }
    }
  }
  mouse_.pressed = true;
  mouse_.moved = false;
  mouse_.pressedAt = event.localPos();
  if (!active_->session().press(cursor(), pressModifiers()) && event.modifiers() == Qt::NoModifier) {
    mouse_.pressed = false;
    offerLayer();
    mouse_.navigating = Qt::LeftButton;
    window_.navigate(event, Qt::LeftButton);
  }
  afterEvent();
}

/// Reads other layers again where their number of vertices or their transform has changed; what changes their vertices
/// ends the tool.
std::shared_ptr<const SnapTargets> LaplacianDragTool::findTargets(SnapTo snap) {
  const auto own = window_.layer(layer_);
  if (!own) {
    return nullptr;
  }
  const bool surfaces = snap == SnapTo::Surfaces;
  std::vector<std::pair<Layer, Affine>> others;
  std::vector<double> found{static_cast<double>(snap)};
  std::vector<Vector3> points;
  for (const Layer& layer : window_.layers()) {
    if (!layer.visible || (surfaces && layer.id == layer_)) {
      continue;
    }
    const Affine toOwn(Eigen::Matrix4d(own->transform.inverse() * layer.transform));
    others.emplace_back(layer, toOwn);
    found.insert(found.end(), {double(layer.id), double(layer.mesh->vn), double(layer.mesh->fn)});
    found.insert(found.end(), toOwn.data(), toOwn.data() + toOwn.matrix().size());
    for (const Vector3& point : surfaces ? std::vector<Vector3>() : picked_points(*layer.mesh)) {
      points.push_back(toOwn * point);
      found.insert(found.end(), points.back().data(), points.back().data() + 3);
    }
  }
  if (!targets_ || found != targetsOf_) {
    std::vector<TriangleMesh> meshes;
    for (std::size_t k = 0; surfaces && k < others.size(); ++k) {
      TriangleMesh mesh = read_mesh(*others[k].first.mesh).mesh;
      for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        mesh.vertices.row(v) = (others[k].second * Vector3(mesh.vertices.row(v).transpose())).transpose();
      }
      if (mesh.faces.rows() > 0 && mesh.faces.minCoeff() >= 0) {
        meshes.push_back(std::move(mesh));
      }
    }
    targets_ = std::make_shared<const SnapTargets>(std::move(meshes), std::move(points));
    targetsOf_ = std::move(found);
  }
  return targets_;
}

/// Does what the line over the picture offers. @return whether it was pressed
bool LaplacianDragTool::pressLine() {
  if (!linePicture_.rectangle().contains(mouse_.position) || keysShown_) {
    return false;
  }
  if (offered_ >= 0) {
    window_.setCurrentLayer(std::exchange(offered_, -1));
    notice_.clear();
    return true;
  }
  if (active_ && !active_->session().warning().empty() && !active_->session().motion()) {
    shared_->panel().setHeat(true);
    afterEvent();
    return true;
  }
  return false;
}

/// Where the cursor is on the surface of another layer. @return whether it is
bool LaplacianDragTool::offerLayer() {
  const QWidget& canvas = window_.canvas();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Layer& layer : window_.layers()) {
    const Camera view(worldToClip_ * layer.transform, canvas.width(), canvas.height());
    if (layer.id == layer_ || !layer.visible || !view.valid()) {
      continue;
    }
    const Ray ray = view.ray(cursor().pixel);
    if (const auto hit = first_hit(read_mesh(*layer.mesh).mesh, ray)) {
      const Eigen::Vector4d clip = worldToClip_ * layer.transform * hit->point.homogeneous();
      if (clip.z() / clip.w() < nearest) {
        nearest = clip.z() / clip.w();
        offered_ = layer.id;
        notice_ = tr("This is the layer %1, which is not the current one: click here to edit it.").arg(layer.name);
      }
    }
  }
  return offered_ >= 0;
}

/// Number and coordinates of the vertex under the cursor, to the clipboard.
void LaplacianDragTool::copyPlace() {
  if (const HoverPreview* const hover = usableLayer() ? active_->session().hover() : nullptr) {
    const QString place = placeOf(active_->session().mesh(), hover->vertex, 9);
    QGuiApplication::clipboard()->setText(QString("%1 [%2]").arg(hover->vertex).arg(place));
    say(tr("On the clipboard: vertex %1 at %2").arg(hover->vertex).arg(place).toStdString());
    window_.repaint();
  }
}

void LaplacianDragTool::mouseMove(QMouseEvent& event) {
  mouse_.position = event.localPos();
  mouse_.modifiers = event.modifiers();
  mouse_.inside = event.buttons() == Qt::NoButton;
  takeKeys();
  // An offer can be reached.
  if (offered_ < 0 && (mouse_.position - mouse_.noticedAt).manhattanLength() > kNoticePixels) {
    notice_.clear();
    if (active_ && event.buttons() == Qt::NoButton) {
      active_->session().forget_refusal();
    }
  }
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
    afterEvent();
  } else if (mouse_.pressed) {
    afterEvent();
  } else {
    hover();
    showShape();
  }
}

void LaplacianDragTool::mouseRelease(QMouseEvent& event) {
  mouse_.position = event.localPos();
  mouse_.modifiers = event.modifiers();
  mouse_.inside = event.buttons() == Qt::NoButton;
  if (mouse_.navigating != Qt::NoButton) {
    if (event.button() == mouse_.navigating) {
      window_.navigate(event, mouse_.navigating == Qt::MiddleButton ? Qt::MiddleButton : Qt::LeftButton);
      mouse_.navigating = Qt::NoButton;
      showShape();
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
  hover();
  afterEvent();
}

void LaplacianDragTool::wheel(QWheelEvent& event) {
  event.accept();
  notice_.clear();
  offered_ = -1;
  if (active_) {
    active_->session().forget_refusal();
  }
  const bool control = event.modifiers() & Qt::ControlModifier, shift = event.modifiers() & Qt::ShiftModifier;
  if ((event.modifiers() & Qt::AltModifier) || (control && !shift)) {
    window_.navigate(event);
    return;
  }
  if (!usableLayer()) {
    return;
  }
  const int angle = event.angleDelta().y() != 0 ? event.angleDelta().y() : event.angleDelta().x();
  const double notches = angle / 120.0;
  const DragSettings before = active_->session().settings();
  DragSettings settings = before;
  if (control) {
    settings.padding = std::clamp(settings.padding + kPaddingPerNotch * notches, 0.0, 1.0);
  } else if (shift) {
    const double grown =
        std::max(settings.handle_share, kSmallestHandleShare) * std::pow(kHandleSharePerNotch, notches);
    settings.handle_share = grown < kSmallestHandleShare ? 0 : std::min(grown, kLargestHandleShare);
  } else {
    settings.radius = threeDigits(settings.radius * std::pow(kRadiusPerNotch, notches));
  }
  active_->session().set_settings(settings);
  saySettings(before);
  hover();
  afterEvent();
}

/// Says what the wheel has changed, unless that was refused.
void LaplacianDragTool::saySettings(const DragSettings& before) {
  const DragSettings& now = active_->session().settings();
  const auto number = [](double value) { return QString::number(value, 'g', 3); };
  if (now.radius != before.radius) {
    notice_ = (active_->session().region() ? tr("Radius: %1 (Shift: handle size, Ctrl: zoom)")
                                           : tr("Radius of the next region: %1 (Shift: handle size, Ctrl: zoom)"))
                  .arg(number(now.radius));
  } else if (now.handle_share != before.handle_share) {
    notice_ = now.handle_share == 0 ? tr("Handle size: one vertex")
                                    : tr("Handle size: %1 % of the radius, %2")
                                          .arg(number(100 * now.handle_share), number(now.handle_share * now.radius));
  } else if (now.padding != before.padding) {
    notice_ = tr("Padding: %1 % of the radius").arg(number(100 * now.padding));
  }
  mouse_.noticedAt = mouse_.position;
}

void LaplacianDragTool::keyPress(QKeyEvent& event) {
  mouse_.modifiers = event.modifiers();
  if (event.key() == Qt::Key_Control) {
    mouse_.modifiers |= Qt::ControlModifier;
  } else if (event.key() == Qt::Key_Shift) {
    mouse_.modifiers |= Qt::ShiftModifier;
  }
  window_.repaint();
  const std::optional<DragKey> key = sessionKey(event);
  if (key == DragKey::Help) {
    keysShown_ = !keysShown_;
  } else if (key == DragKey::Copy) {
    copyPlace();
  }
  if (isOfWindow(key) || !usableLayer()) {
    return;
  }
  notice_.clear();
  modifiersChanged(event.key());
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
  modifiersChanged(event.key());
}

/// Ctrl snaps a motion, and with Shift changes what a press does.
void LaplacianDragTool::modifiersChanged(int key) {
  if (key == Qt::Key_Control && usableLayer() && view_.valid() && active_->session().motion()) {
    active_->session().move(cursor());
    afterEvent();
    return;
  }
  hover();
  showShape();
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
    shared_->forget(layer_);
    start();
    say(tr("The mesh was changed by another tool or filter during a drag: the session starts again from its current "
           "state.")
            .toStdString());
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
  const DragSession* session = active_ ? &active_->session() : nullptr;
  shared_->panel().show(session, clock_.median());
  shared_->panel().setBusy(session && (session->busy() || session->state() == DragSession::State::Settling));
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
      {"from_selection",
       [&] { session.set_region(vertices_of_selected_faces(*layer->mesh, read_mesh(*layer->mesh))); }},
      {"anchors_from_selection",
       [&] { session.set_anchors(vertices_of_selected_faces(*layer->mesh, read_mesh(*layer->mesh))); }},
      {"component", [&] { session.whole_component(); }},
      {"grow", [&] { session.grow(); }},
      {"shrink", [&] { session.shrink(); }},
      {"new_region", [&] { session.new_region(); }},
      {"clear", [&] { session.clear(); }},
      {"next_group", [&] { session.next_group(); }},
      {"move", [&] { session.key(DragKey::Translate, cursor()); }},
      {"rotate", [&] { session.key(DragKey::Rotate, cursor()); }},
      {"scale", [&] { session.key(DragKey::Scale, cursor()); }},
      {"keep_fixed", [&] { session.set_keep_fixed(!session.keeps_fixed()); }},
      {"apply", [&] { session.apply(); }},
      {"cancel", [&] { session.cancel(); }},
      {"undo", [&] { session.undo(); }},
      {"redo", [&] { session.redo(); }},
      {"reset", [&] { session.reset(); }},
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
           session.load(*edit);
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
