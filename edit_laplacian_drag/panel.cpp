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
constexpr double kLightest = 1e-6, kHeaviest = 1e6;

QString nameOf(const QString& part) {
  return "laplacian_drag_" + part;
}

template <class Widget, class Value>
void setQuietly(Widget* widget, Value value) {
  const QSignalBlocker blocker(widget);
  widget->setValue(value);
}

void chooseQuietly(QComboBox* box, int index) {
  const QSignalBlocker blocker(box);
  box->setCurrentIndex(index);
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

  radius_ = number("radius", 0, kLongest, 4, "Size of a new region, along the surface (wheel)",
                   [](DragSettings& s, double v) { s.radius = v; });
  form->addRow("Radius", radius_);
  padding_ =
      number("padding", 0, 1, 2, "Width of the band of anchors inside the rim, over the region's size (Shift+wheel)",
             [](DragSettings& s, double v) { s.padding = v; });
  padding_->setSingleStep(0.02);
  form->addRow("Padding", padding_);
  addRow(form,
         {button("from_selection", "From selection", "The region is what the selected faces cover"),
          button("component", "Component", "The region is the whole connected piece of the handle"),
          button("grow", "Grow", "Makes the region larger by a ring ( ] )"),
          button("shrink", "Shrink", "Makes the region smaller by a ring ( [ )"),
          button("new_region", "New region", "The next click takes a new region (W)"),
          button("clear", "Clear", "Forgets region and handles; what was applied stays")},
         3);
  brush_ =
      count("brush", 1, 1000, "Radius of the brush on the screen: Ctrl+drag adds to the region, Shift+drag takes away",
            [](DragSettings& s, int v) { s.brush_pixels = v; });
  brush_->setSuffix(" pixels");
  form->addRow("Brush", brush_);
  mode_ = choice("mode", {"Vertex or group", "Curve"},
                 "What clicks make a handle of (C): a curve joins them by shortest paths");
  connect(mode_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    emit handleModeEdited(index == 1 ? HandleMode::Curve : HandleMode::Vertex);
    canvas_->setFocus();
  });
  form->addRow("Handle", mode_);
  handleRadius_ = number("handle_radius", 0, kLongest, 4,
                         "Vertices within it of the one clicked are picked together (Ctrl+wheel); 0: that one alone",
                         [](DragSettings& s, double v) { s.handle_radius = v; });
  form->addRow("Handle radius", handleRadius_);
  addRow(form,
         {button("next_group", "Next group", "The next click makes another handle; those there hold their place (G)"),
          button("move", "Move", "The handle follows the mouse, no button held (T)"),
          button("rotate", "Rotate", "The handle turns about its centre with the mouse (R)"),
          button("scale", "Scale", "The handle grows about its centre with the mouse (S)"),
          button("apply", "Apply", "Applies what is being moved (Return)"),
          button("cancel", "Cancel", "Drops what is being moved (Backspace)")},
         3);

  laplacian_ = choice("laplacian", {"Umbrella", "Cotangent"},
                      "How detail is measured: against the plain mean of the neighbours, or with cotangent weights");
  connect(laplacian_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    edited([index](DragSettings& s) {
      s.edit.laplacian = index == 1 ? LaplacianKind::Cotangent : LaplacianKind::Umbrella;
    });
  });
  form->addRow("Laplacian", laplacian_);
  order_ = count("order", 1, 3, "How often the Laplacian is applied: higher is smoother at the rim, and slower",
                 [](DragSettings& s, int v) { s.edit.order = v; });
  form->addRow("Order", order_);
  rotation_ = choice("detail_rotation", {"None", "Smooth normals", "Smooth surface"},
                     "How details turn with the surface: not at all, by the paper's frames, by the smoothed surface");
  connect(rotation_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    static constexpr DetailRotation kRotations[] = {DetailRotation::None, DetailRotation::SmoothNormals,
                                                    DetailRotation::SmoothSurface};
    edited([index](DragSettings& s) { s.edit.rotation = kRotations[std::clamp(index, 0, 2)]; });
  });
  form->addRow("Detail rotation", rotation_);
  iterations_ = count("iterations", 1, 100, "How often the rotations are estimated anew; more helps large drags",
                      [](DragSettings& s, int v) { s.edit.iterations = v; });
  form->addRow("Iterations", iterations_);
  normalRadius_ =
      number("normal_radius", 0, kLongest, 4, "What is smaller than this is detail; 0: chosen from the mesh",
             [](DragSettings& s, double v) { s.edit.normal_radius = v; });
  normalRadius_->setSpecialValueText("automatic");
  form->addRow("Normal radius", normalRadius_);
  handleWeight_ = number("handle_weight", kLightest, kHeaviest, 6, "How strongly the handle is drawn to its place",
                         [](DragSettings& s, double v) { s.edit.handle_weight = v; });
  form->addRow("Handle weight", handleWeight_);
  anchorWeight_ = number("anchor_weight", kLightest, kHeaviest, 6, "How strongly the anchors are held",
                         [](DragSettings& s, double v) { s.edit.anchor_weight = v; });
  form->addRow("Anchor weight", anchorWeight_);

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
  progress_ = new QProgressBar;
  progress_->setObjectName(nameOf("progress"));
  progress_->setToolTip("How far the region is prepared");
  progress_->setRange(0, 100);
  progress_->setMaximumHeight(14);
  form->addRow(progress_);
  region_ = figure("region", "Vertices of the region by class, and of the mesh outside it");
  times_ = figure("times", "Milliseconds to prepare the region and to solve for the last pose");
  frame_ = figure("frame", "A frame of the drag, from the mouse's move to the picture: medians of the last frames");
  quality_ = figure("quality", "Of the last pose: how far the handle is from its target, and the most stretched edge");
  for (QLabel* label : {region_, times_, frame_, quality_}) {
    form->addRow(label);
  }
  scroll->setWidget(content);
  setWidget(scroll);
  content->setMinimumWidth(content->sizeHint().width());
  scroll->setMinimumWidth(content->sizeHint().width() + 20);
}

QDoubleSpinBox* Panel::number(const char* part, double low, double high, int digits, const QString& help,
                              const std::function<void(DragSettings&, double)>& set) {
  auto* box = new NumberBox;
  box->setObjectName(nameOf(part));
  box->setLocale(QLocale::c());
  box->setDecimals(digits);
  box->setRange(low, high);
  box->setKeyboardTracking(false);
  box->setFocusPolicy(Qt::ClickFocus);
  box->installEventFilter(this);
  box->setToolTip(help);
  box->setMaximumWidth(kFieldWidth);
  connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
          [this, set](double value) { edited([&](DragSettings& s) { set(s, value); }); });
  return box;
}

QSpinBox* Panel::count(const char* part, int low, int high, const QString& help,
                       const std::function<void(DragSettings&, int)>& set) {
  auto* box = new QSpinBox;
  box->setObjectName(nameOf(part));
  box->setRange(low, high);
  box->setKeyboardTracking(false);
  box->setFocusPolicy(Qt::ClickFocus);
  box->installEventFilter(this);
  box->setToolTip(help);
  box->setMaximumWidth(kFieldWidth);
  connect(box, QOverload<int>::of(&QSpinBox::valueChanged), this,
          [this, set](int value) { edited([&](DragSettings& s) { set(s, value); }); });
  return box;
}

QComboBox* Panel::choice(const char* part, const QStringList& names, const QString& help) {
  auto* box = new QComboBox;
  box->setObjectName(nameOf(part));
  box->addItems(names);
  box->setToolTip(help);
  box->setFocusPolicy(Qt::ClickFocus);
  box->installEventFilter(this);
  box->setMaximumWidth(kFieldWidth);
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

void Panel::edited(const Edit& edit) {
  DragSettings changed = settings_;
  edit(changed);
  emit settingsEdited(changed);
  canvas_->setFocus();
}

void Panel::setMeshSize(double size) {
  const int digits = size > 0 ? std::clamp(5 - static_cast<int>(std::floor(std::log10(size))), 2, 12) : 4;
  for (QDoubleSpinBox* box : {radius_, handleRadius_, normalRadius_}) {
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
  setQuietly(radius_, settings_.radius);
  setQuietly(padding_, settings_.padding);
  setQuietly(handleRadius_, settings_.handle_radius);
  setQuietly(brush_, static_cast<int>(settings_.brush_pixels));
  setQuietly(order_, settings_.edit.order);
  setQuietly(iterations_, settings_.edit.iterations);
  setQuietly(normalRadius_, settings_.edit.normal_radius);
  setQuietly(handleWeight_, settings_.edit.handle_weight);
  setQuietly(anchorWeight_, settings_.edit.anchor_weight);
  chooseQuietly(mode_, session->handle_mode() == HandleMode::Curve ? 1 : 0);
  chooseQuietly(laplacian_, settings_.edit.laplacian == LaplacianKind::Cotangent ? 1 : 0);
  chooseQuietly(rotation_, settings_.edit.rotation == DetailRotation::None            ? 0
                           : settings_.edit.rotation == DetailRotation::SmoothNormals ? 1
                                                                                      : 2);
  const DragFigures figures = session->figures();
  const bool moving = session->motion() != nullptr;
  const bool picked = !session->groups().empty();
  buttons_["undo"]->setEnabled(session->can_undo());
  buttons_["redo"]->setEnabled(session->can_redo());
  buttons_["reset"]->setEnabled(figures.steps > 0);
  buttons_["save"]->setEnabled(figures.steps > 0);
  buttons_["copy"]->setEnabled(figures.steps > 0);
  buttons_["apply"]->setEnabled(moving);
  buttons_["cancel"]->setEnabled(moving || session->state() == DragSession::State::Settling);
  for (const char* part : {"component", "next_group", "move", "rotate", "scale"}) {
    buttons_[part]->setEnabled(picked);
  }
  for (const char* part : {"grow", "shrink"}) {
    buttons_[part]->setEnabled(session->region() != nullptr);
  }
  progress_->setValue(session->preparing() ? static_cast<int>(100 * session->progress()) : session->ready() ? 100 : 0);
  progress_->setFormat(session->preparing() ? QString("%1 %p %").arg(session->stage())
                       : session->ready()   ? QString("ready")
                                            : QString());
  region_->setText(QString("Handle %1, free %2, anchors %3, fixed %4; steps: %5")
                       .arg(figures.handle)
                       .arg(figures.free)
                       .arg(figures.anchors)
                       .arg(figures.fixed)
                       .arg(figures.steps));
  times_->setText(QString("Prepared in %1 ms, solved in %2 ms")
                      .arg(figures.prepare_ms, 0, 'f', 1)
                      .arg(figures.solve_ms, 0, 'f', 1));
  frame_->setText(QString("Frame %1 ms (%2/s): solve %3, write %4, upload %5, draw %6")
                      .arg(median.total, 0, 'f', 1)
                      .arg(median.total > 0 ? 1000 / median.total : 0, 0, 'f', 0)
                      .arg(median.solve, 0, 'f', 1)
                      .arg(median.write, 0, 'f', 1)
                      .arg(median.upload, 0, 'f', 1)
                      .arg(median.draw, 0, 'f', 1));
  quality_->setText(QString("Handle off by %1; largest stretch %2 %")
                        .arg(figures.handle_error, 0, 'g', 3)
                        .arg(100 * figures.largest_stretch, 0, 'f', 0));
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
