// SPDX-License-Identifier: GPL-3.0-or-later
#include <QApplication>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "laplacian_drag_tool.h"

using namespace lapedit;
using namespace lapedit::host;

// LaplacianDragTool: mouse and keys.

namespace {

constexpr int kDragPixels = 3;     // a shorter move is a click
constexpr int kNoticePixels = 12;  // a move of the mouse that ends a notice
constexpr double kRadiusPerNotch = 1.1, kHandleSharePerNotch = 1.25, kPaddingPerNotch = 0.02;
constexpr double kSmallestHandleShare = 0.01;  // a smaller one becomes a single vertex

double threeDigits(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return step * std::round(value / step);
}

/// Returns the session's key for an event.
std::optional<DragKey> sessionKey(const QKeyEvent& event) {
  const int key = event.key();
  const Qt::KeyboardModifiers modifiers = event.modifiers();
  if ((modifiers & Qt::ControlModifier) && key == Qt::Key_Z) {
    return modifiers & Qt::ShiftModifier ? DragKey::Redo : DragKey::Undo;
  }
  if (modifiers == Qt::ControlModifier && key == Qt::Key_Y) {
    return DragKey::Redo;
  }
  // On many keyboards brackets need a modifier.
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
  // Qt's codes of letters are those of ASCII, and kKeyHelp names letters as the keyboard does.
  const auto letter = std::find_if(std::begin(kKeyHelp), std::end(kKeyHelp),
                                   [key](const KeyHelp& help) { return help.name[0] == key && help.name[1] == '\0'; });
  return letter != std::end(kKeyHelp) ? std::optional<DragKey>(letter->key) : std::nullopt;
}

/// Returns whether the window handles a key; MeshLab may have a shortcut with the same key.
bool isOfWindow(std::optional<DragKey> key) {
  return key == DragKey::Tint || key == DragKey::Help;
}

}  // namespace

/// Gives the keyboard to the view, over which the mouse is.
void LaplacianDragTool::takeKeys() {
  if (on_ && !window_.viewport().hasFocus() && QApplication::activePopupWidget() == nullptr &&
      QApplication::activeModalWidget() == nullptr) {
    window_.viewport().setFocus(Qt::MouseFocusReason);
  }
}

/// Receives events that MeshLab does not pass to tools.
bool LaplacianDragTool::eventFilter(QObject* object, QEvent* event) {
  bool isHandled = false;
  guarded([&] { isHandled = handle(*event); });
  return isHandled || QObject::eventFilter(object, event);
}

/// Handles an event before the view does, and measures drawing: the picture is on the screen once the paint event is
/// over. @return whether the view shall not get the event
bool LaplacianDragTool::handle(QEvent& event) {
  switch (event.type()) {
    case QEvent::Paint:
      if (poseIsComing()) {
        return true;
      }
      later([this] { framePainted(); });
      break;
    case QEvent::ShortcutOverride:
      if (isOfWindow(sessionKey(static_cast<QKeyEvent&>(event)))) {
        event.accept();
        return true;
      }
      return escape(event);
    case QEvent::KeyPress:
      return escape(event);
    case QEvent::Enter:
      takeKeys();
      break;
    case QEvent::Leave:
      mouse_.inside = false;
      if (active_) {
        active_->session.leave();
        window_.repaint();
      }
      break;
    case QEvent::MouseButtonDblClick:  // Qt sends it in place of the second press, and MeshLab does not pass it to
                                       // tools
      if (!window_.suspended()) {
        input(event);
      }
      break;
    case QEvent::DeferredDelete:  // the view is being closed
      leave();
      for (const auto& [session, layer] : shared_ ? shared_->left(this) : WindowSessions::Left()) {
        finishLeft(*session, layer, true);
      }
      break;
    default:
      break;
  }
  return false;
}

/// Handles Esc before MeshLab does: it hides the table of keys, cancels a motion or computation, or ends painting.
/// @return whether it did one of these; otherwise Esc suspends the tool
bool LaplacianDragTool::escape(QEvent& event) {
  if (static_cast<QKeyEvent&>(event).key() != Qt::Key_Escape || !active_ || window_.suspended()) {
    return false;
  }
  const DragSession::State state = active_->session.state();
  const bool moves = state == DragSession::State::Dragging || state == DragSession::State::Settling;
  if (!moves && !active_->session.tools().paint && !shown_.keys) {
    return false;
  }
  event.accept();
  if (event.type() != QEvent::KeyPress) {
    return true;
  }
  if (shown_.keys) {
    shown_.keys = false;
    window_.repaint();
  } else {
    mouse_.pressed = false;
    notice_.clear();
    active_->session.key(DragKey::Cancel);
    afterEvent();
  }
  return true;
}

void LaplacianDragTool::cancelMotion() {
  if (active_) {
    mouse_.pressed = false;
    notice_.clear();
    active_->session.cancel();
    afterEvent();
  }
}

Cursor LaplacianDragTool::cursor() const {
  Cursor cursor;
  cursor.view = view_;
  cursor.pixel = Vector2(mouse_.position.x(), mouse_.position.y());
  cursor.snap = mouse_.modifiers & Qt::ControlModifier;
  return cursor;
}

PressModifiers LaplacianDragTool::pressModifiers() const {
  const bool add = mouse_.modifiers & Qt::ControlModifier, take = mouse_.modifiers & Qt::ShiftModifier;
  return {add, take, (add || take) && (mouse_.modifiers & Qt::AltModifier)};
}

/// Shows what a press would pick.
void LaplacianDragTool::hover() {
  if (mouse_.inside && !window_.suspended() && usableLayer() && view_.valid() &&
      active_->session.hover(cursor(), pressModifiers())) {
    window_.repaint();
  }
}

/// Gives the cursor the shape for what a press would do.
void LaplacianDragTool::showShape() {
  if (!active_ || window_.suspended() || mouse_.navigating != Qt::NoButton) {
    return;
  }
  const DragSession& session = active_->session;
  const HoverPreview* const hover = session.hover();
  const Qt::CursorShape shape = session.motion() ? Qt::ClosedHandCursor
                                : session.preparation().running && !session.preparation().has_preview ? Qt::BusyCursor
                                : !pressModifiers().none()                                            ? Qt::CrossCursor
                                : session.gizmo_element() != GizmoElement::None ? Qt::SizeAllCursor
                                : !hover                                        ? Qt::ArrowCursor
                                : hover->kind == HoverPreview::Kind::Group      ? Qt::OpenHandCursor
                                                                                : Qt::PointingHandCursor;
  if (window_.viewport().cursor().shape() != shape) {
    window_.viewport().setCursor(shape);
  }
}

void LaplacianDragTool::input(QEvent& event) {
  guarded([&] {
    if (event.type() == QEvent::KeyPress || event.type() == QEvent::KeyRelease) {
      return keyEvent(static_cast<QKeyEvent&>(event));
    }
    if (event.type() == QEvent::Wheel) {
      return wheel(static_cast<QWheelEvent&>(event));
    }
    const auto& mouse = static_cast<QMouseEvent&>(event);
    mouse_.position = mouse.localPos();
    mouse_.modifiers = mouse.modifiers();
    mouse_.inside = mouse.buttons() == Qt::NoButton;
    event.type() == QEvent::MouseMove            ? mouseMove(mouse)
    : event.type() == QEvent::MouseButtonRelease ? mouseRelease(mouse)
                                                 : mousePress(mouse);
  });
}

/// Passes the mouse to MeshLab's navigation.
void LaplacianDragTool::navigate(const QMouseEvent& event) {
  window_.navigate(event, mouse_.navigating == Qt::MiddleButton ? Qt::MiddleButton : Qt::LeftButton);
}

void LaplacianDragTool::mousePress(const QMouseEvent& event) {
  takeKeys();
  if (event.button() == Qt::LeftButton && line_.contains(mouse_.position.toPoint()) && active_ &&
      !active_->session.warning().empty() && !active_->session.motion()) {
    shown_.warning = true;  // a click on the line colours the stretch and marks folds
    afterEvent();
    return;
  }
  notice_.clear();
  shown_.keys = false;
  if (event.button() == Qt::RightButton && active_ && active_->session.motion()) {
    cancelMotion();
    return;
  }
  const bool lasso = pressModifiers().lasso;
  const bool around = event.button() != Qt::LeftButton || ((event.modifiers() & Qt::AltModifier) && !lasso);
  if (around) {
    if (mouse_.navigating == Qt::NoButton && !mouse_.pressed) {
      mouse_.navigating = event.button();
      navigate(event);
    }
    return;
  }
  const auto layer = usableLayer();
  if (!layer || !view_.valid() || mouse_.navigating != Qt::NoButton) {
    return;
  }
  if (isStale()) {
    begin();
    if (!active_) {
      return;
    }
  }
  mouse_.pressed = true;
  mouse_.moved = false;
  mouse_.pressedAt = event.localPos();
  const bool covered = !active_->session.motion() && !lasso && isCovered();
  if (covered || (!active_->session.press(cursor(), pressModifiers()) && event.modifiers() == Qt::NoModifier)) {
    mouse_.pressed = false;
    mouse_.navigating = Qt::LeftButton;
    navigate(event);
  }
  afterEvent();
  if (covered) {
    say(tr("Another layer covers the surface there: hide it, or make it the current one."));
  }
}

void LaplacianDragTool::mouseMove(const QMouseEvent& event) {
  takeKeys();
  if ((mouse_.position - mouse_.noticedAt).manhattanLength() > kNoticePixels) {
    notice_.clear();
    if (active_ && event.buttons() == Qt::NoButton) {
      active_->session.forget_refusal();
    }
  }
  if (mouse_.navigating != Qt::NoButton) {
    navigate(event);
    return;
  }
  if (!usableLayer() || !view_.valid()) {
    return;
  }
  if (mouse_.pressed && !(event.buttons() & Qt::LeftButton)) {
    // The release went to another receiver: to the view while the tool was suspended, or to a dialog.
    mouse_.pressed = false;
    active_->session.cancel();
    afterEvent();
    return;
  }
  if (mouse_.pressed && !mouse_.moved) {
    mouse_.moved = (event.localPos() - mouse_.pressedAt).manhattanLength() >= kDragPixels;
    if (!mouse_.moved) {
      return;
    }
  }
  DragSession& session = active_->session;
  session.move(cursor());
  if (session.motion()) {
    if (!std::exchange(frame_.moved, true)) {
      frame_.posed = false;  // an earlier pose does not show this move
      frame_.sinceMove.start();
    }
    afterEvent();
  } else if (mouse_.pressed) {
    afterEvent();
  } else {
    hover();
    showShape();
  }
}

void LaplacianDragTool::mouseRelease(const QMouseEvent& event) {
  if (mouse_.navigating != Qt::NoButton) {
    if (event.button() == mouse_.navigating) {
      navigate(event);
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
      active_->session.cancel();  // the layer was hidden meanwhile
      afterEvent();
    }
    return;
  }
  Cursor at = cursor();
  if (!mouse_.moved) {
    at.pixel = Vector2(mouse_.pressedAt.x(), mouse_.pressedAt.y());
  }
  active_->session.release(at);
  hover();
  afterEvent();
}

void LaplacianDragTool::wheel(QWheelEvent& event) {
  event.accept();
  notice_.clear();
  if (active_) {
    active_->session.forget_refusal();
  }
  const bool control = event.modifiers() & Qt::ControlModifier, shift = event.modifiers() & Qt::ShiftModifier;
  if ((event.modifiers() & Qt::AltModifier) || (control && !shift)) {
    window_.navigate(event);
    return;
  }
  if (!usableLayer()) {
    return;
  }
  mouse_.position = event.position();
  mouse_.inside = event.buttons() == Qt::NoButton;
  hover();
  constexpr qint64 kRest = 500;  // milliseconds; zooming may bring the mesh under the cursor
  const bool zooms = mouse_.zoomed.isValid() && mouse_.zoomed.elapsed() < kRest;
  if (event.modifiers() == Qt::NoModifier && mouse_.inside && (zooms || active_->session.is_beside())) {
    mouse_.zoomed.start();
    window_.navigate(event);
    return;
  }
  const int angle = event.angleDelta().y() != 0 ? event.angleDelta().y() : event.angleDelta().x();
  const double notches = angle / 120.0;
  const DragSettings before = active_->session.settings();
  DragSettings settings = before;
  if (control) {
    settings.padding = std::clamp(settings.padding + kPaddingPerNotch * notches, 0.0, 1.0);
  } else if (shift) {
    const double grown =
        std::max(settings.handle_fraction, kSmallestHandleShare) * std::pow(kHandleSharePerNotch, notches);
    settings.handle_fraction = grown < kSmallestHandleShare ? 0 : std::min(grown, kLargestHandleFraction);
  } else {
    settings = active_->session.settings_at_cursor();
    const double disc = disc_radius(settings);  // stays as it is
    settings.radius = threeDigits(settings.radius * std::pow(kRadiusPerNotch, notches));
    settings.handle_fraction = std::min(disc / settings.radius, kLargestHandleFraction);
  }
  active_->session.set_settings(settings);
  saySettings(before);
  hover();
  afterEvent();
}

/// Shows the value that the wheel has changed, unless it was refused.
void LaplacianDragTool::saySettings(const DragSettings& before) {
  const DragSettings& now = active_->session.settings();
  const auto number = [](double value) { return QString::number(value, 'g', 3); };
  if (now.radius != before.radius) {
    notice_ = (active_->session.shown().region() ? tr("Radius: %1 (Shift: handle size, Ctrl: zoom)")
                                                 : tr("Radius of the next region: %1 (Shift: handle size, Ctrl: zoom)"))
                  .arg(number(now.radius));
  } else if (now.handle_fraction != before.handle_fraction) {
    notice_ = now.handle_fraction == 0
                  ? tr("Handle size: one vertex")
                  : tr("Handle size: %1 %, %2").arg(number(100 * now.handle_fraction), number(disc_radius(now)));
  } else if (now.padding != before.padding) {
    notice_ = tr("Padding: %1 % of the radius").arg(number(100 * now.padding));
  }
  mouse_.noticedAt = mouse_.position;
}

void LaplacianDragTool::keyEvent(QKeyEvent& event) {
  const bool pressed = event.type() == QEvent::KeyPress;
  // Qt reports the modifiers as they were before the event.
  const Qt::KeyboardModifiers own = event.key() == Qt::Key_Control ? Qt::ControlModifier
                                    : event.key() == Qt::Key_Shift ? Qt::ShiftModifier
                                                                   : Qt::NoModifier;
  const Qt::KeyboardModifiers before = mouse_.modifiers;
  mouse_.modifiers = pressed ? event.modifiers() | own : event.modifiers() & ~own;
  // Here, or while another widget had the keyboard.
  const bool control = (mouse_.modifiers ^ before) & Qt::ControlModifier;
  window_.repaint();
  const std::optional<DragKey> key = pressed ? sessionKey(event) : std::nullopt;
  if (key == DragKey::Help) {
    shown_.keys = !shown_.keys;
  } else if (key == DragKey::Tint && shared_) {
    Panel& panel = shared_->panel();
    panel.setColours(panel.colours() == Colours::None ? Colours::Region : Colours::None);
  }
  if (isOfWindow(key) || (pressed && !usableLayer())) {
    return;
  }
  if (pressed) {
    notice_.clear();
  }
  if (control && usableLayer() && view_.valid() && active_->session.motion()) {
    active_->session.move(cursor());  // Ctrl makes a motion go in steps
    afterEvent();
  } else {
    hover();
    showShape();
  }
  if (key && active_->session.key(*key, cursor())) {
    event.accept();
    saySwitch(*key);
    afterEvent();
  }
}

/// Reports a setting that a key has switched, if the picture may not show it.
void LaplacianDragTool::saySwitch(DragKey key) {
  const DragSession& session = active_->session;
  if (key == DragKey::Curve) {
    notice_ = session.selection().mode == HandleMode::Curve ? tr("Clicks make a curve now. C: a disc or vertex again.")
                                                            : tr("Clicks make a disc or vertex now. C: a curve.");
  } else if (key == DragKey::Gizmo) {
    notice_ = session.tools().gizmo ? tr("Arrows and rings are shown at the handle. V hides them.")
                                    : tr("Arrows and rings are hidden. V shows them.");
  }
  mouse_.noticedAt = mouse_.position;
}
