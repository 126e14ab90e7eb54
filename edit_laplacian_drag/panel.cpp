// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel.h"

#include <Eigen/Geometry>
#include <QAbstractItemView>
#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QCloseEvent>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QKeyEvent>
#include <QLineEdit>
#include <QLocale>
#include <QPainter>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSlider>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <utility>

using namespace lapedit;

namespace {

constexpr int kFieldWidth = 160, kButtonWidth = 50;        // pixels; buttons have at least that
constexpr double kLongest = 1e12;                          // limit of lengths
constexpr const char* kListOf = "laplacian_drag_list_of";  // property of a list: the box that it belongs to

constexpr const char* kMethod = "panel/method";  // in the file of settings

const char* const kUnknown = "\u2013";  // a dash, so that no outdated value is shown

/// A number without trailing zeros.
class NumberBox : public QDoubleSpinBox {
 public:
  QString textFromValue(double value) const override {
    QString text = QDoubleSpinBox::textFromValue(value);
    while (text.contains('.') && (text.endsWith('0') || text.endsWith('.'))) {
      text.chop(1);
    }
    return text;
  }
};

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
  shownHistory_ = -1;  // the list shows another session
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
  const double method = settings_table().front().get(session->settings().edit);
  if (file_.value(kMethod).toDouble() != method) {
    file_.setValue(kMethod, method);
  }
  for (const auto& bring : shown_) {
    bring(*session);
  }
  showCommands(*session);
  showHistory(session->timeline());
  showFigures(*session);
}

void Panel::recall(DragSession& session) const {
  const Setting& method = settings_table().front();
  const double value = file_.value(kMethod).toDouble();
  if (value >= method.low && value <= method.high) {  // the file may have any number
    DragSettings settings = session.settings();
    method.set(settings.edit, value);
    session.set_settings(settings);
  }
}

void Panel::showCommands(const DragSession& session) {
  const bool moving = session.motion() != nullptr, picked = !session.selection().groups.empty();
  const bool busy = moving || session.state() == DragSession::State::Settling;
  const bool region = session.shown().region() != nullptr;
  const std::pair<const char*, bool> enabled[] = {{"undo", session.can_undo()},
                                                  {"redo", session.can_redo()},
                                                  {"reset", session.figures().steps > 0},
                                                  {"save", session.can_save()},
                                                  {"move", picked},
                                                  {"rotate", picked},
                                                  {"scale", picked},
                                                  {"component", picked},
                                                  {"apply", moving},
                                                  {"grow", region},
                                                  {"shrink", region}};
  for (const auto& [part, isEnabled] : enabled) {
    buttons_[part]->setEnabled(isEnabled);
  }
  for (const char* part : {"apply", "cancel"}) {
    buttons_[part]->setVisible(busy);
  }
  for (const char* part : {"move", "rotate", "scale"}) {
    buttons_[part]->setVisible(!busy);
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
  const auto figure = [&figures](double EditReport::*value, double factor, char format, int digits) {
    return figures.report ? QString::number(factor * *figures.report.*value, format, digits) : QString(kUnknown);
  };
  const std::string advice = figures.advice();
  quality_->setText(
      tr("Handle %1 from its target; largest stretch %2 %")
          .arg(figure(&EditReport::handle_residual, 1, 'g', 3), figure(&EditReport::stretch_max, 100, 'f', 0)) +
      (advice.empty() ? QString() : "\n" + QString::fromStdString(advice)));
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
  if (auto* const slider = qobject_cast<QSlider*>(object); slider && type == QEvent::WindowDeactivate) {
    slider->setSliderDown(false);  // the dialog that opens would take the mouse button's release
  }
  const bool key = type == QEvent::ShortcutOverride || type == QEvent::KeyPress;
  if (key && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
    event->accept();
    if (type == QEvent::KeyPress) {
      if (auto* const list = qobject_cast<QComboBox*>(object->property(kListOf).value<QObject*>())) {
        list->hidePopup();
      } else {
        if (auto* const number = qobject_cast<QDoubleSpinBox*>(object)) {
          number->setValue(number->value());  // discards the text that was typed
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

/// Draws the icon's shape in the palette's colours.
QIcon Panel::icon(const QString& part) const {
  const QImage shape(":/laplacian_drag/icons/" + part + ".png");
  QIcon icon;
  for (const QIcon::Mode mode : {QIcon::Normal, QIcon::Disabled}) {
    if (QImage image = shape; !image.isNull()) {
      QPainter painter(&image);
      painter.setCompositionMode(QPainter::CompositionMode_SourceIn);
      painter.fillRect(image.rect(), palette().color(mode == QIcon::Normal ? QPalette::Active : QPalette::Disabled,
                                                     QPalette::ButtonText));
      painter.end();
      image.setDevicePixelRatio(2);
      icon.addPixmap(QPixmap::fromImage(image), mode);
    }
  }
  return icon;
}

// --- Fields, lists, sliders and buttons ------------------------------------------------------------------------------

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

QDoubleSpinBox* Panel::number(const char* part, const QString& title, double low, double high, int digits,
                              const QString& help, const Access& access, const QString& suffix) {
  QDoubleSpinBox* const box = field<NumberBox>(part, title, help);
  box->setLocale(QLocale::c());
  box->setDecimals(digits);
  box->setSuffix(suffix);
  box->setRange(low, high);
  box->setKeyboardTracking(false);
  follow(box, access, QOverload<double>::of(&QDoubleSpinBox::valueChanged), &QDoubleSpinBox::setValue);
  return box;
}

QDoubleSpinBox* Panel::length(const char* part, const QString& title, const QString& help, const Access& access) {
  lengths_.push_back(number(part, title, 0, kLongest, 4, help, access));
  return lengths_.back();
}

QSlider* Panel::slider(const char* part, const QString& title, int high, const QString& help,
                       const std::function<double(const DragSession&)>& get,
                       const std::function<void(DragSession&, double, bool)>& set) {
  auto* const made = field<QSlider>(part, title, help);
  made->setOrientation(Qt::Horizontal);
  made->setRange(0, high);
  const auto go = [this, made, set] {
    change([set, value = made->value() / 100.0, passing = made->isSliderDown()](DragSession& session) {
      set(session, value, passing);
    });
  };
  connect(made, &QSlider::valueChanged, this, go);
  connect(made, &QSlider::sliderReleased, this, go);
  shown_.push_back([made, get](const DragSession& session) {
    if (!made->isSliderDown()) {
      const QSignalBlocker blocker(made);
      made->setValue(static_cast<int>(std::round(100 * get(session))));
    }
  });
  return made;
}

QComboBox* Panel::choice(const char* part, const QString& title, const QStringList& choices, const QString& help,
                         const Access& access) {
  auto* const box = field<QComboBox>(part, title, help);
  box->addItems(choices);
  follow(box, access, QOverload<int>::of(&QComboBox::activated), &QComboBox::setCurrentIndex);
  return box;
}

QCheckBox* Panel::check(const char* part, const QString& text, const QString& help, const Access& access) {
  auto* const box = new QCheckBox(text);
  prepare(*box, part, help);
  follow<QAbstractButton, bool>(box, access, &QAbstractButton::clicked, &QAbstractButton::setChecked);
  form_->addRow(box);
  return box;
}

QPushButton* Panel::button(const char* part, const QString& text, const QString& help, std::optional<DragKey> key) {
  auto* made = new QPushButton(icon(part), text);
  made->setObjectName(nameOf(part));
  made->setToolTip(help);
  made->setMinimumWidth(kButtonWidth);  // the style's own minimum is wider
  made->setFocusPolicy(Qt::NoFocus);
  connect(made, &QPushButton::clicked, this, [this, name = QString(part), key] { emit command(name, key); });
  buttons_[part] = made;
  return made;
}
