// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel.h"

#include <Eigen/Geometry>
#include <QAction>
#include <QApplication>
#include <QCloseEvent>
#include <QComboBox>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "panel_widgets.h"

using namespace lapedit;

namespace {

const char* const kUnknown = "\u2013";

/// Returns a dash where there is no value, so that no outdated one is shown.
QString text(const std::optional<double>& figure, char format, int digits) {
  return figure ? QString::number(*figure, format, digits) : QString(kUnknown);
}

}  // namespace

Panel::Panel(QWidget* parent) : QDockWidget("Laplacian Drag", parent), column_(new QVBoxLayout) {
  setObjectName(nameOf("panel"));
  setAllowedAreas(Qt::LeftDockWidgetArea | Qt::RightDockWidgetArea);
  toggleViewAction()->setVisible(false);  // the tool shows and hides it
  auto* scroll = new QScrollArea;
  scroll->setObjectName(nameOf("scroll"));
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setFocusPolicy(Qt::NoFocus);  // a click between fields leaves the keyboard to the view
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* content = new QWidget;
  QFont small = content->font();
  small.setPointSizeF(0.82 * small.pointSizeF());
  content->setFont(small);
  content->setObjectName(nameOf("content"));
  column_->setSpacing(0);
  column_->setContentsMargins(2, 0, 2, 0);
  content->setLayout(column_);

  addBasic();
  addPaint();
  addLastStep();
  addRegion();
  addAdvanced();
  addView();
  column_->addStretch();
  int widest = 0;
  for (QLabel* const title : titles_) {
    title->setFont(small);  // the label has not inherited it yet
    widest = std::max(widest, title->sizeHint().width());
  }
  for (QLabel* const title : titles_) {
    title->setMinimumWidth(widest);
  }
  scroll->setWidget(content);
  setWidget(scroll);
  content->setMinimumWidth(content->sizeHint().width());
  scroll->setMinimumWidth(content->sizeHint().width() + 16);
}

// --- Showing --------------------------------------------------------------------------------------------------------

void Panel::setMesh(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounding_box(mesh.vertices);
  const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  const double size = diagonal > 0 && std::isfinite(diagonal) ? diagonal : 1;
  defaults_ = settings_for(mesh);
  history_.shown = -1;  // the list shows another session
  middle_ = box.isEmpty() ? Vector3(Vector3::Zero()) : Vector3(box.center());
  const int digits = std::clamp(5 - static_cast<int>(std::floor(std::log10(size))), 2, 12);
  for (QDoubleSpinBox* length : lengths_) {
    const QSignalBlocker blocker(length);
    length->setDecimals(digits);
    length->setSingleStep(std::pow(10.0, std::floor(std::log10(size)) - 2));
  }
}

void Panel::show(const DragSession* session) {
  const bool has = session != nullptr;
  widget()->setEnabled(has);
  if (!has) {
    return;
  }
  remembered_.keep(*session);
  for (const auto& bring : shown_) {
    bring(*session);
  }
  showCommands(*session);
  showHistory(session->timeline());
  showFigures(*session);
}

void Panel::showCommands(const DragSession& session) {
  const bool steps = session.figures().steps > 0;
  const bool moving = session.motion() != nullptr;
  const bool picked = !session.selection().groups.empty();
  buttons_["undo"]->setEnabled(session.can_undo());
  buttons_["redo"]->setEnabled(session.can_redo());
  buttons_["save"]->setEnabled(session.can_save());
  buttons_["reset"]->setEnabled(steps);
  const bool busy = moving || session.state() == DragSession::State::Settling;
  for (const char* part : {"apply", "cancel"}) {
    buttons_[part]->setVisible(busy);
  }
  buttons_["apply"]->setEnabled(moving);
  for (const char* part : {"move", "rotate", "scale"}) {
    buttons_[part]->setVisible(!busy);
    buttons_[part]->setEnabled(picked);
  }
  buttons_["component"]->setEnabled(picked);
  for (const char* part : {"grow", "shrink"}) {
    buttons_[part]->setEnabled(session.shown().region() != nullptr);
  }
}

void Panel::showFigures(const DragSession& session) {
  const DragFigures figures = session.figures();
  progress_->setVisible(session.preparation().running);
  progress_->setValue(static_cast<int>(100 * session.preparation().progress));
  progress_->setFormat(QString("%1 %p %").arg(session.preparation().stage.c_str()));
  const bool known = session.shown().region() != nullptr;
  const auto count = [known](int vertices) { return known ? QString::number(vertices) : QString(kUnknown); };
  region_->setText(tr("Handle %1, free %2, anchors %3, fixed %4; steps: %5")
                       .arg(count(figures.handle), count(figures.free), count(figures.anchors), count(figures.fixed))
                       .arg(figures.steps));
  const auto stretch = figures.largest_stretch ? std::optional(100 * *figures.largest_stretch) : std::nullopt;
  quality_->setText(tr("Handle %1 from its target; largest stretch %2 %")
                        .arg(text(figures.handle_error, 'g', 3), text(stretch, 'f', 0)) +
                    (figures.advice.empty() ? QString() : "\n" + QString::fromStdString(figures.advice)));
}

Colours Panel::colours() const {
  return static_cast<Colours>(colours_->currentIndex());
}

void Panel::setColours(Colours colours) {
  colours_->setCurrentIndex(static_cast<int>(colours));
}

/// Lets the wheel scroll the panel, unless a click has given the focus to the number under the cursor. Makes Esc close
/// a list or restore a number: Qt would close the list before MeshLab's shortcut Esc, which would then suspend the
/// tool.
bool Panel::eventFilter(QObject* object, QEvent* event) {
  const QEvent::Type type = event->type();
  if (type == QEvent::Wheel && !static_cast<QWidget*>(object)->hasFocus()) {
    event->ignore();
    return true;
  }
  const bool key = type == QEvent::ShortcutOverride || type == QEvent::KeyPress;
  if (key && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
    event->accept();
    if (type == QEvent::KeyPress) {
      if (auto* const list = qobject_cast<QComboBox*>(object->property(kListOf).value<QObject*>())) {
        list->hidePopup();
      } else {
        if (auto* const whole = qobject_cast<QSpinBox*>(object)) {
          whole->setValue(whole->value());  // discards the text that was typed
        } else if (auto* const number = qobject_cast<QDoubleSpinBox*>(object)) {
          number->setValue(number->value());
        } else if (auto* const line = qobject_cast<QLineEdit*>(object)) {
          line->setText(line->property(kValue).toString());
        }
        giveKeysBack();
      }
    }
    return true;
  }
  return QDockWidget::eventFilter(object, event);
}

void Panel::closeEvent(QCloseEvent* event) {
  QDockWidget::closeEvent(event);
  emit closed();
}
