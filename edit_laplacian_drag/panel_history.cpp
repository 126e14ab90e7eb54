// SPDX-License-Identifier: GPL-3.0-or-later
#include <QFormLayout>
#include <QHBoxLayout>
#include <QListWidget>
#include <QLocale>
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

}  // namespace

void Panel::addLastStep() {
  begin("last_step", tr("Last step and history"),
        tr("The last step, which can be changed until something else is picked, and all that was done"));
  using Get = std::function<double&(LastStep&)>;
  const auto send = [this](const LastStep& last, bool passing) {
    change([last, passing](DragSession& session) { session.set_last_step(last.motion, last.fraction, passing); });
  };
  const auto field = [&](const char* part, const QString& help, double low, int digits, bool turns, const Get& get) {
    QDoubleSpinBox* const box = prepared<NumberBox>(part, help);
    box->setLocale(QLocale::c());
    box->setDecimals(digits);
    box->setRange(low, kLongest);
    box->setKeyboardTracking(false);
    connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this, get, send](double value) {
      if (LastStep last = lastStep_.value_or(LastStep()); lastStep_) {
        get(last) = value;
        send(last, false);
      }
    });
    shown_.push_back([this, box, get, turns](const DragSession&) {
      box->setEnabled(lastStep_ && !lastStep_->bent && !(turns && lastStep_->single));
      if (!box->hasFocus()) {
        const QSignalBlocker blocker(box);
        LastStep last = lastStep_.value_or(LastStep());
        box->setValue(get(last));
      }
    });
    return box;
  };
  auto* const line = new QWidget;
  auto* const fields = new QHBoxLayout(line);
  fields->setSpacing(2);
  fields->setContentsMargins(0, 0, 0, 0);
  line->setToolTip(tr("Displacement along X, Y and Z of the layer, in model units"));
  for (int axis = 0; axis < 3; ++axis) {
    lengths_.push_back(field(qPrintable(QString("last_") + "xyz"[axis]), line->toolTip(), -kLongest, 4, false,
                             [axis](LastStep& last) -> double& { return last.motion.translation[axis]; }));
    lengths_.back()->setButtonSymbols(QAbstractSpinBox::NoButtons);
    lengths_.back()->setMinimumWidth(kButtonWidth);
    fields->addWidget(lengths_.back(), 1);
  }
  row(tr("Moved"), line);
  auto* const turned = field("last_turn", tr("Rotation about the last axis, or about Z"), -kLongest, 2, true,
                             [](LastStep& last) -> double& { return last.motion.degrees; });
  turned->setSuffix(tr(" degrees"));
  row(tr("Turned"), turned);
  auto* const scaled = field("last_scale", tr("Factor of the scale"), 0.0001, 4, true,
                             [](LastStep& last) -> double& { return last.motion.scale; });
  scaled->setSingleStep(0.1);
  row(tr("Scaled"), scaled);
  auto* const fraction = prepared<QSlider>("last_fraction", tr("Fraction of the path: 0 to 100 percent"));
  fraction->setOrientation(Qt::Horizontal);
  fraction->setRange(0, 100);
  const auto go = [this, fraction, send] {
    if (LastStep last = lastStep_.value_or(LastStep()); lastStep_) {
      last.fraction = fraction->value() / 100.0;
      send(last, fraction->isSliderDown());
    }
  };
  connect(fraction, &QSlider::valueChanged, this, go);
  connect(fraction, &QSlider::sliderReleased, this, go);
  shown_.push_back([this, fraction](const DragSession&) {
    fraction->setEnabled(lastStep_.has_value());
    if (!fraction->isSliderDown()) {
      const QSignalBlocker blocker(fraction);
      fraction->setValue(static_cast<int>(std::round(100 * (lastStep_ ? lastStep_->fraction : 1))));
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
    history_.shown = -1;  // the list is filled again, since the session may refuse
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
