// SPDX-License-Identifier: GPL-3.0-or-later
#include <QAbstractItemView>
#include <QApplication>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QMap>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QSpinBox>
#include <algorithm>
#include <cmath>

#include "lapedit/session/presets.h"
#include "panel.h"
#include "panel_icons.h"
#include "panel_widgets.h"

using namespace lapedit;

// Panel: fields, lists, sliders and buttons.

namespace {

constexpr int kFieldWidth = 160, kBoxBesideSlider = 72;
constexpr int kSliderSteps = 1000;
/// Returns rich text, which tool tips break into lines.
QString tip(const QString& help) {
  return "<qt>" + help.toHtmlEscaped() + "</qt>";
}

/// Returns the label of a setting or of a choice.
QString titleOf(const char* key) {
  static const QMap<QString, const char*> titles = {{"order", "Smoothness"},     {"iterations", "Passes"},
                                                    {"rough", "First estimate"}, {"unrotated", "Details at rest"},
                                                    {"falloff", "Falloff"},      {"membrane", "Stiffness"}};
  return titles.contains(key) ? QString(titles[key]) : QString::fromStdString(title_of(key));
}

}  // namespace

void Panel::addAdvanced() {
  begin("advanced", tr("Advanced"), tr("Settings of the solver"));
  for (const Setting& setting : settings_table()) {
    QWidget* const field = widgetOf(setting);
    row(titleOf(setting.key), field);
    shown_.push_back([&setting, field, title = titles_.back()](const DragSession& session) {
      const bool varies = setting.varies(session.settings().edit.method);
      field->setVisible(varies);
      title->setVisible(varies);
    });
  }
}

QWidget* Panel::widgetOf(const Setting& setting) {
  const Access access = {[&setting](const DragSettings& settings) { return setting.get(settings.edit); },
                         [&setting](DragSettings& settings, double value) { setting.set(settings.edit, value); }};
  const QString help = tip(setting.help);
  switch (setting.kind) {
    case Setting::Kind::Choice:
      return choice(setting, access);
    case Setting::Kind::Whole: {
      auto* box = count(setting.key, static_cast<int>(setting.low), static_cast<int>(setting.high), help, access);
      box->setSpecialValueText(setting.low == 0 ? tr("automatic") : QString());
      return box;
    }
    case Setting::Kind::Length: {
      auto* box = length(setting.key, help, access);
      box->setSpecialValueText(tr("automatic"));
      box->setSuffix(tr(" units"));
      return box;
    }
    case Setting::Kind::Number:
      break;
  }
  auto* box = number(setting.key, setting.low, setting.high, 6, help, access);
  box->setPrefix(tr("\u00d7 "));
  return box;
}

void Panel::prepare(QWidget& box, const char* part, const QString& help) {
  box.setObjectName(nameOf(part));
  box.setToolTip(help);
  // Only fields that are typed into take the keyboard from the view.
  auto* const typed = qobject_cast<QAbstractSpinBox*>(&box);
  box.setFocusPolicy(typed ? Qt::ClickFocus : Qt::NoFocus);
  box.installEventFilter(this);
  box.setMaximumWidth(kFieldWidth);
  if (typed) {
    connect(typed, &QAbstractSpinBox::editingFinished, this, &Panel::giveKeysBack);
  } else if (auto* const list = qobject_cast<QComboBox*>(&box)) {
    list->view()->installEventFilter(this);
    list->view()->setProperty(kListOf, QVariant::fromValue<QObject*>(list));
  }
}

void Panel::giveKeysBack() {
  if (canvas_ && isAncestorOf(QApplication::focusWidget())) {
    canvas_->setFocus();
  }
}

void Panel::change(const Change& change) {
  if (canvas_) {
    canvas_->setFocus();  // first: show() does not update the field that has the keyboard
  }
  emit edited(change);
}

template <class Widget, class Value>
void Panel::follow(Widget* box, const Access& access, void (Widget::*changed)(Value), void (Widget::*bring)(Value)) {
  connect(box, changed, this, [this, set = access.set](Value value) {
    DragSettings settings = settings_;
    set(settings, value);
    change([settings](DragSession& session) { session.set_settings(settings); });
  });
  shown_.push_back([box, bring, get = access.get](const DragSession& session) {
    if (box->hasFocus()) {
      return;  // the user is typing
    }
    const QSignalBlocker blocker(box);
    (box->*bring)(static_cast<Value>(get(session.settings())));
  });
}

QDoubleSpinBox* Panel::number(const char* part, double low, double high, int digits, const QString& help,
                              const Access& access) {
  QDoubleSpinBox* const box = prepared<NumberBox>(part, help);
  box->setLocale(QLocale::c());
  box->setDecimals(digits);
  box->setRange(low, high);
  box->setKeyboardTracking(false);
  follow(box, access, QOverload<double>::of(&QDoubleSpinBox::valueChanged), &QDoubleSpinBox::setValue);
  return box;
}

QDoubleSpinBox* Panel::percent(const char* part, int high, const QString& help, const Access& access) {
  QDoubleSpinBox* const box = number(part, 0, high, 1, help, access);
  box->setSuffix(tr(" %"));
  return box;
}

QDoubleSpinBox* Panel::length(const char* part, const QString& help, const Access& access) {
  lengths_.push_back(number(part, 0, kLongest, 4, help, access));
  return lengths_.back();
}

QSpinBox* Panel::count(const char* part, int low, int high, const QString& help, const Access& access) {
  auto* const box = prepared<QSpinBox>(part, help);
  box->setRange(low, high);
  box->setKeyboardTracking(false);
  follow(box, access, QOverload<int>::of(&QSpinBox::valueChanged), &QSpinBox::setValue);
  return box;
}

QWidget* Panel::dragged(QDoubleSpinBox* box, const std::function<double(double)>& valueAt,
                        const std::function<double(double)>& positionOf, const Access& access) {
  const QString part = box->objectName().mid(nameOf("").size()) + "_slider";
  auto* const slider = prepared<QSlider>(qPrintable(part), box->toolTip());
  slider->setOrientation(Qt::Horizontal);
  slider->setRange(0, kSliderSteps);
  follow(static_cast<QAbstractSlider*>(slider),
         Access{[access, positionOf](const DragSettings& settings) {
                  return std::round(kSliderSteps * std::clamp(positionOf(access.get(settings)), 0.0, 1.0));
                },
                [access, valueAt](DragSettings& settings, double position) {
                  access.set(settings, valueAt(position / kSliderSteps));
                }},
         &QAbstractSlider::valueChanged, &QAbstractSlider::setValue);
  box->setFixedWidth(kBoxBesideSlider);
  auto* const both = new QWidget;
  both->setToolTip(box->toolTip());
  auto* const line = new QHBoxLayout(both);
  line->setSpacing(4);
  line->setContentsMargins(0, 0, 0, 0);
  line->addWidget(slider, 1);
  line->addWidget(box);
  return both;
}

QComboBox* Panel::choice(const Setting& setting, const Access& access) {
  auto* const box = prepared<QComboBox>(setting.key, tip(setting.help));
  for (const char* name : setting.choices) {
    box->addItem(titleOf(name));
  }
  follow(box, access, QOverload<int>::of(&QComboBox::activated), &QComboBox::setCurrentIndex);
  return box;
}

QComboBox* Panel::presetChoice() {
  auto* const box = prepared<QComboBox>("preset", tr("Sets handle size and solver for a kind of surface"));
  for (const Preset& preset : presets()) {
    box->addItem(preset.name);
    box->setItemData(box->count() - 1, tip(preset.help), Qt::ToolTipRole);
  }
  box->addItem(tr("Custom"));
  box->setItemData(box->count() - 1, tip(tr("Values that no preset has.")), Qt::ToolTipRole);
  connect(box, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    DragSettings settings = settings_;
    if (index < static_cast<int>(presets().size())) {
      presets()[static_cast<std::size_t>(index)].set(settings);
    }
    change([settings](DragSession& session) { session.set_settings(settings); });
  });
  shown_.push_back([box](const DragSession& session) {
    const int preset = preset_of(session.settings());
    box->setCurrentIndex(preset >= 0 ? preset : box->count() - 1);
  });
  return box;
}

QComboBox* Panel::state(const char* part, const QStringList& choices, const QString& help,
                        const std::function<int(const DragSession&)>& get,
                        const std::function<void(DragSession&, int)>& set) {
  auto* const box = prepared<QComboBox>(part, help);
  box->addItems(choices);
  connect(box, QOverload<int>::of(&QComboBox::activated), this,
          [this, set](int index) { change([set, index](DragSession& session) { set(session, index); }); });
  shown_.push_back([box, get](const DragSession& session) { box->setCurrentIndex(get(session)); });
  return box;
}

QPushButton* Panel::button(const char* part, const QString& text, const QString& help) {
  auto* made = new QPushButton(panelIcon(part, palette()), text);
  made->setObjectName(nameOf(part));
  made->setToolTip(help);
  made->setMinimumWidth(kButtonWidth);  // the style's own minimum is wider
  made->setFocusPolicy(Qt::NoFocus);
  const QString name = part;
  connect(made, &QPushButton::clicked, this, [this, name] { emit command(name); });
  buttons_[name] = made;
  return made;
}

QLabel* Panel::figure(const char* part, const QString& help) {
  auto* label = new QLabel;
  label->setObjectName(nameOf(part));
  label->setToolTip(help);
  label->setWordWrap(true);
  return label;
}
