// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel.h"

#include <QAction>
#include <QCloseEvent>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QLabel>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVariantMap>
#include <algorithm>
#include <cmath>

using namespace lapedit;

namespace {

constexpr double kLongest = 1e12;
constexpr int kFieldWidth = 130, kButtonWidth = 50;

QString nameOf(const QString& part) {
  return "laplacian_drag_" + part;
}

/// Shows no more digits than it needs.
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

/// As rich text, which is broken into lines.
QString tip(const char* help) {
  return "<qt>" + QString(help).toHtmlEscaped() + "</qt>";
}

/// Rows of buttons.
void addRow(QFormLayout* form, const std::vector<QPushButton*>& buttons, int columns) {
  auto* grid = new QGridLayout;
  grid->setSpacing(2);
  for (std::size_t i = 0; i < buttons.size(); ++i) {
    grid->addWidget(buttons[i], static_cast<int>(i) / columns, static_cast<int>(i) % columns);
  }
  grid->setContentsMargins(0, 0, 0, 0);
  form->addRow(grid);
}

}  // namespace

Panel::Panel(QWidget* parent, QWidget* canvas) : QDockWidget("Laplacian Drag", parent), canvas_(canvas) {
  setObjectName(nameOf("panel"));
  setAllowedAreas(Qt::LeftDockWidgetArea | Qt::RightDockWidgetArea);
  toggleViewAction()->setVisible(false);  // the tool shows and hides it
  auto* scroll = new QScrollArea;
  scroll->setObjectName(nameOf("scroll"));
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* content = new QWidget;
  QFont small = content->font();
  small.setPointSizeF(0.82 * small.pointSizeF());
  content->setFont(small);
  content->setObjectName(nameOf("content"));
  auto* form = new QFormLayout(content);
  form->setVerticalSpacing(2);
  form->setHorizontalSpacing(4);
  form->setContentsMargins(6, 4, 6, 4);

  addRegion(form);
  addHandle(form);
  for (const Setting& setting : settings_table()) {
    form->addRow(QString::fromStdString(title_of(setting.key)), widgetOf(setting));
  }
  addSteps(form);
  addFigures(form);
  scroll->setWidget(content);
  setWidget(scroll);
  content->setMinimumWidth(content->sizeHint().width());
  scroll->setMinimumWidth(content->sizeHint().width() + 20);
}

void Panel::addRegion(QFormLayout* form) {
  form->addRow("Radius",
               length("radius", "Size of a new region, along the surface (wheel)", access<&DragSettings::radius>()));
  auto* padding =
      number("padding", 0, 1, 2, "Width of the band of anchors inside the rim, over the region's size (Shift+wheel)",
             access<&DragSettings::padding>());
  padding->setSingleStep(0.02);
  form->addRow("Padding", padding);
  addRow(form,
         {button("from_selection", "From selection", "The region is what the selected faces cover"),
          button("component", "Component", "The region is the whole connected piece of the handle"),
          button("grow", "Grow", "Makes the region larger by a ring ( ] )"),
          button("shrink", "Shrink", "Makes the region smaller by a ring ( [ )"),
          button("new_region", "New region", "The next click takes a new region (W)"),
          button("clear", "Clear", "Forgets region and handles; what was applied stays")},
         3);
  auto* brush =
      count("brush", 1, 1000, "Radius of the brush on the screen: Ctrl+drag adds to the region, Shift+drag takes away",
            access<&DragSettings::brush_pixels>());
  brush->setSuffix(" pixels");
  form->addRow("Brush", brush);
}

void Panel::addHandle(QFormLayout* form) {
  mode_ = prepared<QComboBox>("mode", "What clicks make a handle of (C): a curve joins them by shortest paths");
  mode_->addItems({"Vertex or group", "Curve"});
  connect(mode_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    emit handleModeEdited(index == 1 ? HandleMode::Curve : HandleMode::Vertex);
    canvas_->setFocus();
  });
  form->addRow("Handle", mode_);
  form->addRow("Handle size",
               number("handle_share", 0, kLargestHandleShare, 2,
                      "Radius of the disc that a click takes, over the region's radius (Ctrl+wheel); 0: one vertex",
                      access<&DragSettings::handle_share>()));
  addRow(form,
         {button("next_group", "Next group", "The next click makes another handle; those there hold their place (G)"),
          button("move", "Move", "The handle follows the mouse, no button held (T)"),
          button("rotate", "Rotate", "The handle turns about its centre with the mouse (R)"),
          button("scale", "Scale", "The handle grows about its centre with the mouse (S)"),
          button("apply", "Apply", "Applies what is being moved (Return)"),
          button("cancel", "Cancel", "Drops what is being moved (Backspace)")},
         3);
}

void Panel::addSteps(QFormLayout* form) {
  addRow(form,
         {button("undo", "Undo", "Takes the last step back (Ctrl+Z)"),
          button("redo", "Redo", "Does it again (Ctrl+Shift+Z)"),
          button("reset", "Reset", "Back to the mesh as it was when the tool began")},
         3);
  addRow(form,
         {button("save", "Save edit...", "Writes all steps as JSON, for Laplacian Edit Replay"),
          button("load", "Load edit...", "Applies the steps of a saved edit"),
          button("copy", "Copy script",
                 "Copies as filter script: puts a filter script (.mlx) with all steps on the clipboard")},
         3);
}

void Panel::addFigures(QFormLayout* form) {
  progress_ = new QProgressBar;
  progress_->setObjectName(nameOf("progress"));
  progress_->setToolTip("How far the region is prepared");
  progress_->setRange(0, 100);
  progress_->setMaximumHeight(14);
  form->addRow(progress_);
  region_ = figure("region", "Vertices of the region by class, and of the mesh outside it");
  times_ = figure("times", "Milliseconds to prepare the region and to solve for the last pose");
  frame_ = figure("frame", "A frame of the drag, from the mouse's move to the picture: medians of the last frames");
  quality_ =
      figure("quality",
             "Of the last pose: how far the handle is from its target, the most stretched edge, and where it folded");
  for (QLabel* label : {region_, times_, frame_, quality_}) {
    form->addRow(label);
  }
}

template <auto member>
Panel::Access Panel::access() {
  return {[](const DragSettings& settings) { return static_cast<double>(settings.*member); },
          [](DragSettings& settings, double value) { settings.*member = value; }};
}

QWidget* Panel::widgetOf(const Setting& setting) {
  const Access access = {[&setting](const DragSettings& settings) { return setting.get(settings.edit); },
                         [&setting](DragSettings& settings, double value) { setting.set(settings.edit, value); }};
  switch (setting.kind) {
    case Setting::Kind::Choice:
      return choice(setting, access);
    case Setting::Kind::Whole:
      return count(setting.key, static_cast<int>(setting.low), static_cast<int>(setting.high), tip(setting.help),
                   access);
    case Setting::Kind::Length: {
      auto* box = length(setting.key, tip(setting.help), access);
      box->setSpecialValueText("automatic");
      return box;
    }
    case Setting::Kind::Number:
      break;
  }
  return number(setting.key, setting.low, setting.high, 6, tip(setting.help), access);
}

template <class Widget>
Widget* Panel::prepared(const char* part, const QString& help) {
  auto* box = new Widget;
  box->setObjectName(nameOf(part));
  box->setToolTip(help);
  box->setFocusPolicy(Qt::ClickFocus);
  box->installEventFilter(this);
  box->setMaximumWidth(kFieldWidth);
  return box;
}

template <class Widget, class Value>
void Panel::follow(Widget* box, const Access& access, void (Widget::*changed)(Value), void (Widget::*bring)(Value)) {
  connect(box, changed, this, [this, set = access.set](Value value) {
    DragSettings settings = settings_;
    set(settings, value);
    emit settingsEdited(settings);
    canvas_->setFocus();
  });
  shown_.push_back([box, bring, get = access.get](const DragSettings& settings) {
    const QSignalBlocker blocker(box);
    (box->*bring)(static_cast<Value>(get(settings)));
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

QComboBox* Panel::choice(const Setting& setting, const Access& access) {
  auto* const box = prepared<QComboBox>(setting.key, tip(setting.help));
  for (const char* name : setting.choices) {
    box->addItem(QString::fromStdString(title_of(name)));
  }
  follow(box, access, QOverload<int>::of(&QComboBox::activated), &QComboBox::setCurrentIndex);
  return box;
}

QPushButton* Panel::button(const char* part, const QString& text, const QString& help) {
  auto* made = new QPushButton(text);
  made->setObjectName(nameOf(part));
  made->setToolTip(help);
  made->setMinimumWidth(kButtonWidth);  // else the style's own, which is wide
  made->setFocusPolicy(Qt::NoFocus);    // keys are the canvas's
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

void Panel::setMeshSize(double size) {
  const int digits = size > 0 ? std::clamp(5 - static_cast<int>(std::floor(std::log10(size))), 2, 12) : 4;
  for (QDoubleSpinBox* box : lengths_) {
    const QSignalBlocker blocker(box);
    box->setDecimals(digits);
    box->setSingleStep(size > 0 ? std::pow(10.0, std::floor(std::log10(size)) - 2) : 0.01);
  }
}

void Panel::show(const DragSession* session, const FrameTimes& median) {
  const bool has = session != nullptr;
  widget()->setEnabled(has);
  if (!has) {
    return;
  }
  settings_ = session->settings();
  for (const auto& bring : shown_) {
    bring(settings_);
  }
  mode_->setCurrentIndex(session->handle_mode() == HandleMode::Curve ? 1 : 0);
  showCommands(*session);
  showFigures(*session, median);
}

void Panel::showCommands(const DragSession& session) {
  const bool steps = session.figures().steps > 0;
  const bool moving = session.motion() != nullptr;
  const bool picked = !session.groups().empty();
  buttons_["undo"]->setEnabled(session.can_undo());
  buttons_["redo"]->setEnabled(session.can_redo());
  buttons_["reset"]->setEnabled(steps);
  buttons_["save"]->setEnabled(steps);
  buttons_["copy"]->setEnabled(steps);
  buttons_["apply"]->setEnabled(moving);
  buttons_["cancel"]->setEnabled(moving || session.state() == DragSession::State::Settling);
  for (const char* part : {"component", "next_group", "move", "rotate", "scale"}) {
    buttons_[part]->setEnabled(picked);
  }
  for (const char* part : {"grow", "shrink"}) {
    buttons_[part]->setEnabled(session.region() != nullptr);
  }
}

void Panel::showFigures(const DragSession& session, const FrameTimes& median) {
  const DragFigures figures = session.figures();
  progress_->setValue(session.preparing() ? static_cast<int>(100 * session.progress()) : session.ready() ? 100 : 0);
  progress_->setFormat(session.preparing() ? QString("%1 %p %").arg(session.stage())
                       : session.ready()   ? QString("ready")
                                           : QString());
  region_->setText(QString("Handle %1, free %2, anchors %3, fixed %4; steps: %5")
                       .arg(figures.handle)
                       .arg(figures.free)
                       .arg(figures.anchors)
                       .arg(figures.fixed)
                       .arg(figures.steps));
  times_->setText(QString("In the hand in %1 ms, prepared in %2 ms, solved in %3 ms")
                      .arg(figures.in_hand_ms.value_or(0), 0, 'f', 1)
                      .arg(figures.prepare_ms.value_or(0), 0, 'f', 1)
                      .arg(figures.solve_ms.value_or(0), 0, 'f', 1));
  frame_->setText(QString("Frame %1 ms (%2/s): solve %3, write %4, upload %5, draw %6")
                      .arg(median.total, 0, 'f', 1)
                      .arg(median.total > 0 ? 1000 / median.total : 0, 0, 'f', 0)
                      .arg(median.solve, 0, 'f', 1)
                      .arg(median.write, 0, 'f', 1)
                      .arg(median.upload, 0, 'f', 1)
                      .arg(median.draw, 0, 'f', 1));
  quality_->setText(QString("Handle off by %1; largest stretch %2 %")
                        .arg(figures.handle_error.value_or(0), 0, 'g', 3)
                        .arg(100 * figures.largest_stretch.value_or(0), 0, 'f', 0) +
                    (figures.advice.empty() ? QString() : "\n" + QString::fromStdString(figures.advice)));
}

void Panel::setBusy(bool busy) {
  setProperty("laplacian_drag_busy", busy);
}

void Panel::setFrames(const std::deque<FrameTimes>& frames) {
  QVariantList list;
  for (const FrameTimes& f : frames) {
    list.append(QVariantMap{
        {"solve", f.solve}, {"write", f.write}, {"upload", f.upload}, {"draw", f.draw}, {"total", f.total}});
  }
  setProperty("laplacian_drag_frames", list);
}

/// The wheel scrolls the panel; it changes a value only after a click on it.
bool Panel::eventFilter(QObject* object, QEvent* event) {
  if (event->type() == QEvent::Wheel && !static_cast<QWidget*>(object)->hasFocus()) {
    event->ignore();
    return true;
  }
  return QDockWidget::eventFilter(object, event);
}

void Panel::closeEvent(QCloseEvent* event) {
  QDockWidget::closeEvent(event);
  emit closed();
}
