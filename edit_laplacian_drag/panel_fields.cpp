// SPDX-License-Identifier: GPL-3.0-or-later
#include <QAbstractItemView>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QSpinBox>
#include <algorithm>
#include <iterator>

#include "panel.h"
#include "panel_widgets.h"

using namespace lapedit;

// Panel: fields, lists, sliders and buttons.

namespace {

constexpr int kFieldWidth = 160;

/// Returns rich text, which tool tips break into lines.
QString tip(const QString& help) {
  return "<qt>" + help.toHtmlEscaped() + "</qt>";
}

/// Returns the label of a setting or of a choice.
QString titleOf(const char* key) {
  return QString::fromStdString(title_of(key));
}

}  // namespace

void Panel::addAdvanced() {
  begin("advanced", tr("Solver"), tr("How the region is deformed; a saved edit has all settings of the solver"));
  for (const Setting& setting : settings_table()) {
    const Access access =
        ofSettings([&setting](const DragSettings& settings) { return setting.get(settings.edit); },
                   [&setting](DragSettings& settings, double value) { setting.set(settings.edit, value); });
    if (QString(setting.key) == "method") {
      QStringList names;
      std::transform(setting.choices.begin(), setting.choices.end(), std::back_inserter(names), titleOf);
      row(titleOf(setting.key), choice(setting.key, names, tip(setting.help), access));
    } else if (setting.kind == Setting::Kind::Switch) {
      auto* const box = check(setting.key, titleOf(setting.subject), tip(setting.help), access);
      shown_.push_back([box, &setting](const DragSession& session) {
        box->setVisible(setting.applies(session.settings().edit.method));
      });
    } else if (QString(setting.key) == "membrane") {
      row(tr("Keep lengths"), number(setting.key, setting.low, setting.high, 6, tip(setting.help), access));
    }
  }
}

void Panel::prepare(QWidget& box, const char* part, const QString& help) {
  box.setObjectName(nameOf(part));
  box.setToolTip(help);
  // Only fields for numbers and text take the keyboard from the view.
  auto* const number = qobject_cast<QAbstractSpinBox*>(&box);
  auto* const text = qobject_cast<QLineEdit*>(&box);
  box.setFocusPolicy(number || text ? Qt::ClickFocus : Qt::NoFocus);
  box.installEventFilter(this);
  box.setMaximumWidth(kFieldWidth);
  if (number) {
    connect(number, &QAbstractSpinBox::editingFinished, this, &Panel::giveKeysBack);
  } else if (text) {
    connect(text, &QLineEdit::editingFinished, this, &Panel::giveKeysBack);
  } else if (auto* const list = qobject_cast<QComboBox*>(&box)) {
    list->view()->installEventFilter(this);
    list->view()->setProperty(kListOf, QVariant::fromValue<QObject*>(list));
  }
}

void Panel::giveKeysBack() {
  if (viewport_ && isAncestorOf(QApplication::focusWidget())) {
    viewport_->setFocus();
  }
}

void Panel::change(const Change& change) {
  if (viewport_) {
    viewport_->setFocus();  // before the change, since show() does not update a field that has the focus
  }
  emit edited(change);
}

Panel::Access Panel::ofSettings(const std::function<double(const DragSettings&)>& get,
                                const std::function<void(DragSettings&, double)>& set) {
  return {[get](const DragSession& session) { return get(session.settings()); },
          [set](DragSession& session, double value) {
            DragSettings settings = session.settings();
            set(settings, value);
            session.set_settings(settings);
          }};
}

template <class Widget, class Value>
void Panel::follow(Widget* box, const Access& access, void (Widget::*changed)(Value), void (Widget::*bring)(Value)) {
  connect(box, changed, this, [this, set = access.set](Value value) {
    change([set, value](DragSession& session) { set(session, value); });
  });
  shown_.push_back([box, bring, get = access.get](const DragSession& session) {
    if (box->hasFocus()) {
      return;  // the user is typing
    }
    const QSignalBlocker blocker(box);
    (box->*bring)(static_cast<Value>(get(session)));
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

QSlider* Panel::slider(const char* part, int high, const QString& help, const std::function<void(int, bool)>& set) {
  auto* const made = prepared<QSlider>(part, help);
  made->setOrientation(Qt::Horizontal);
  made->setRange(0, high);
  const auto go = [made, set] { set(made->value(), made->isSliderDown()); };
  connect(made, &QSlider::valueChanged, this, go);
  connect(made, &QSlider::sliderReleased, this, go);
  return made;
}

QSpinBox* Panel::count(const char* part, int low, int high, const QString& help, const Access& access) {
  auto* const box = prepared<QSpinBox>(part, help);
  box->setRange(low, high);
  box->setKeyboardTracking(false);
  follow(box, access, QOverload<int>::of(&QSpinBox::valueChanged), &QSpinBox::setValue);
  return box;
}

QComboBox* Panel::choice(const char* part, const QStringList& choices, const QString& help, const Access& access) {
  auto* const box = prepared<QComboBox>(part, help);
  box->addItems(choices);
  follow(box, access, QOverload<int>::of(&QComboBox::activated), &QComboBox::setCurrentIndex);
  return box;
}

QCheckBox* Panel::check(const char* part, const QString& text, const QString& help, const Access& access) {
  auto* const box = prepared<QCheckBox>(part, help);
  box->setText(text);
  follow<QAbstractButton, bool>(box, access, &QAbstractButton::clicked, &QAbstractButton::setChecked);
  form_->addRow(box);
  return box;
}

QPushButton* Panel::resetButton() {
  auto* const made = prepared<QPushButton>("defaults", tr("All settings of the panel, as they were at first"));
  made->setText(tr("Reset all"));
  connect(made, &QPushButton::clicked, this, [this] {
    change([settings = defaults_](DragSession& session) mutable {
      settings.edit.detail = session.settings().edit.detail;
      session.set_settings(settings);
      session.set(&Tools::gizmo, false);
      session.set(&Tools::axes, GizmoAxes::Layer);
    });
  });
  return made;
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
