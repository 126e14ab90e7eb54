// SPDX-License-Identifier: GPL-3.0-or-later
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QRegularExpression>
#include <QSignalBlocker>
#include <QSlider>
#include <algorithm>
#include <cmath>
#include <utility>

#include "panel.h"
#include "panel_widgets.h"

using namespace lapedit;

// Panel: the last step, and the list of all steps and strokes.

namespace {

constexpr int kHistoryRows = 6;

MotionKind kindOf(const HandleTransform& motion) {
  return motion.degrees != 0 ? MotionKind::Rotate : motion.scale != 1 ? MotionKind::Scale : MotionKind::Translate;
}

QString numbersOf(const HandleTransform& motion) {
  const auto text = [](double number) { return QString::number(number, 'g', 6); };
  const Vector3& along = motion.translation;
  return kindOf(motion) == MotionKind::Rotate ? text(motion.degrees)
         : kindOf(motion) == MotionKind::Scale
             ? text(motion.scale)
             : QStringList({text(along.x()), text(along.y()), text(along.z())}).join(", ");
}

/// Reads what numbersOf() writes. @return false for other texts, without a change of the motion
bool setNumbers(const QString& text, HandleTransform& motion) {
  QStringList words = text.split(QRegularExpression("[,\\s]+"));
  words.removeAll(QString());
  std::vector<double> numbers;
  for (const QString& word : qAsConst(words)) {
    bool ok = false;
    numbers.push_back(word.toDouble(&ok));
    if (!ok) {
      return false;
    }
  }
  const MotionKind kind = kindOf(motion);
  if (numbers.size() != (kind == MotionKind::Translate ? 3U : 1U)) {
    return false;
  }
  if (kind == MotionKind::Translate) {
    motion.translation = Vector3(numbers[0], numbers[1], numbers[2]);
  } else {
    (kind == MotionKind::Rotate ? motion.degrees : motion.scale) = numbers[0];
  }
  return true;
}

}  // namespace

void Panel::addLastStep() {
  begin("last_step", tr("Last step and history"),
        tr("The last step, which can be changed until something else is picked, and all that was done"));
  auto* const value =
      prepared<QLineEdit>("last_value", tr("What the last step did: a displacement along X, Y and Z of the "
                                           "layer, degrees about the axis, or a factor"));
  row(tr("Moved"), value);
  connect(value, &QLineEdit::editingFinished, this, [this, value] {
    if (value->text() == value->property(kValue).toString()) {
      return;
    }
    change([text = value->text()](DragSession& session) {
      std::optional<LastStep> last = session.last_step();
      if (last && setNumbers(text, last->motion)) {
        session.set_last_step(last->motion, last->fraction);
      }
    });
  });
  shown_.push_back([value, title = titles_.back()](const DragSession& session) {
    const std::optional<LastStep> last = session.last_step();
    value->setEnabled(last && !last->bent);
    const HandleTransform motion = last.value_or(LastStep()).motion;
    title->setText(kindOf(motion) == MotionKind::Rotate  ? tr("Turned")
                   : kindOf(motion) == MotionKind::Scale ? tr("Scaled")
                                                         : tr("Moved"));
    value->setProperty(kValue, numbersOf(motion));
    if (!value->hasFocus()) {
      value->setText(numbersOf(motion));
    }
  });
  auto* const fraction =
      slider("last_fraction", 100, tr("Fraction of the path: 0 to 100 percent"), [this](int percent, bool passing) {
        change([percent, passing](DragSession& session) {
          if (const std::optional<LastStep> last = session.last_step()) {
            session.set_last_step(last->motion, percent / 100.0, passing);
          }
        });
      });
  shown_.push_back([fraction](const DragSession& session) {
    const std::optional<LastStep> last = session.last_step();
    fraction->setEnabled(last.has_value());
    if (!fraction->isSliderDown()) {
      const QSignalBlocker blocker(fraction);
      fraction->setValue(static_cast<int>(std::round(100 * (last ? last->fraction : 1))));
    }
  });
  row(tr("Fraction"), fraction);
  addHistory();
}

void Panel::addHistory() {
  history_.list = new QListWidget;
  history_.list->setObjectName(nameOf("timeline"));
  history_.list->setToolTip(
      tr("All steps and strokes in order: a click goes to the state after one; grey ones are undone"));
  history_.list->setFocusPolicy(Qt::NoFocus);
  history_.list->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  history_.list->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
  history_.list->setFixedHeight(kHistoryRows * history_.list->fontMetrics().lineSpacing());
  connect(history_.list, &QListWidget::itemClicked, this, [this](const QListWidgetItem* item) {
    const auto row = static_cast<std::size_t>(history_.list->row(item));
    history_.shown = -1;  // fills the list again, since the session may refuse
    change([row](DragSession& session) { session.go_to(row); });
  });
  form_->addRow(history_.list);
}

void Panel::showHistory(const Timeline& timeline) {
  if (std::exchange(history_.shown, timeline.serial()) == timeline.serial()) {
    return;
  }
  history_.list->clear();
  history_.list->addItem(tr("Start"));
  for (const Action& action : timeline.done()) {
    history_.list->addItem(QString::fromStdString(action.name));
  }
  history_.list->setCurrentRow(history_.list->count() - 1);
  for (auto action = timeline.undone().rbegin(); action != timeline.undone().rend(); ++action) {
    auto* const item = new QListWidgetItem(QString::fromStdString(action->name), history_.list);
    item->setForeground(palette().brush(QPalette::Disabled, QPalette::Text));
  }
}
