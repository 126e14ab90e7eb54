// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel.h"

#include <Eigen/Geometry>
#include <QAbstractItemView>
#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QCloseEvent>
#include <QComboBox>
#include <QFormLayout>
#include <QInputDialog>
#include <QKeyEvent>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QMap>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSlider>
#include <QSpinBox>
#include <QToolButton>
#include <QVBoxLayout>
#include <QVariantMap>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "lapedit/session/presets.h"
#include "panel_icons.h"
#include "panel_widgets.h"

using namespace lapedit;

namespace {

constexpr double kLongest = 1e12;
constexpr int kFieldWidth = 160, kButtonWidth = 50, kBoxBesideSlider = 72;
constexpr int kSliderSteps = 1000;
constexpr int kHistoryRows = 6;
// Of the mesh's size: ends of the slider for the radius.
constexpr double kSmallestRadius = 0.002, kLargestRadius = 1;
constexpr int kPlanes = 6;  // to mirror at
const char* const kUnknown = "\u2013";
const char* const kListOf = "laplacian_drag_list_of";  // property: the box that a list belongs to

QString nameOf(const QString& part) {
  return "laplacian_drag_" + part;
}

/// As rich text, which is broken into lines.
QString tip(const QString& help) {
  return "<qt>" + help.toHtmlEscaped() + "</qt>";
}

/// What users see in place of a setting's key or of a choice.
QString titleOf(const char* key) {
  static const QMap<QString, const char*> titles = {
      {"order", "Smoothness"},          {"iterations", "Passes"}, {"turning", "Rotate details"},
      {"vertex", "By vertex"},          {"edge", "By edge"},      {"rough", "First estimate"},
      {"unrotated", "Details at rest"}, {"falloff", "Falloff"},   {"membrane", "Stiffness"}};
  return titles.contains(key) ? QString(titles[key]) : QString::fromStdString(title_of(key));
}

/// Empty where there is no value, so that no outdated one is shown.
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
  scroll->setFocusPolicy(Qt::NoFocus);  // a click beside a value leaves the keys to the canvas
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
  addLastStep();
  addRegion();
  addHandles();
  addGizmo();
  addSymmetry();
  addAdvanced();
  addStatistics();
  column_->addStretch();
  int widest = 0;
  for (QLabel* const title : titles_) {
    title->setFont(small);  // not inherited yet
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

// --- Groups ---------------------------------------------------------------------------------------------------------

void Panel::addBasic() {
  begin("basic", tr("Basic"), tr("Settings that most edits need"), true);
  const Access radius = access<&DragSettings::radius>();
  row(tr("Radius"),
      dragged(
          length("radius", tr("Size of a new region, along the surface (wheel)"), radius),
          [this](double place) {
            return threeDigits(size_ * kSmallestRadius * std::pow(kLargestRadius / kSmallestRadius, place));
          },
          [this](double value) {
            return std::log(value / (size_ * kSmallestRadius)) / std::log(kLargestRadius / kSmallestRadius);
          },
          radius));
  const double largest = 100 * kLargestHandleShare;
  const Access share = access<&DragSettings::handle_share, 100>();
  row(tr("Handle size"), dragged(
                             percent("handle_share", static_cast<int>(largest),
                                     tr("Radius of the disc that a press takes, in percent of the region's radius "
                                        "(Shift+wheel); 0: the vertex under the cursor alone"),
                                     share),
                             [largest](double place) { return std::round(largest * place); },
                             [largest](double value) { return value / largest; }, share));
  auto* const mode = state(
      "mode", {tr("Disc or vertex"), tr("Curve")},
      tr("How clicks make a handle (C): a curve joins them by shortest paths"),
      [](const DragSession& session) { return session.handle_mode() == HandleMode::Curve ? 1 : 0; },
      [](DragSession& session, int index) {
        session.set_handle_mode(index == 1 ? HandleMode::Curve : HandleMode::Vertex);
      });
  mode->setItemIcon(0, panelIcon("disc", palette()));
  mode->setItemIcon(1, panelIcon("curve", palette()));
  row(tr("Handle"), mode);
  row(tr("Preset"), presetChoice());
  auto* const save = button("save_preset", tr("Save preset..."), tr("Stores the values as a preset of your own"));
  auto* const defaults = button("defaults", tr("Defaults"), tr("Resets all settings to their initial values"));
  connect(save, &QPushButton::clicked, this, &Panel::saveOrRemovePreset);
  connect(defaults, &QPushButton::clicked, this, [this] {
    change([settings = defaults_](DragSession& session) {
      session.set_settings(settings);
      session.show_gizmo(false, GizmoAxes::Layer);
    });
  });
  buttons({save, defaults, button("help", tr("Keys"), tr("Shows all keys over the picture (?)"))});
  row(tr("Turn about"), state(
                            "pivot", {tr("Handle's middle"), tr("Shoulder (edge)"), tr("Point (next click)")},
                            tr("The point that turning and scaling go about (P): the middle of the handle, the middle "
                               "of the region's edge, as the shoulder of an arm, or a point that the next click picks"),
                            [](const DragSession& session) { return static_cast<int>(session.pivot()); },
                            [](DragSession& session, int index) { session.set_pivot(static_cast<Pivot>(index)); }));
  buttons({button("move", tr("Move"), tr("The handle follows the mouse, no button held (T)")),
           button("rotate", tr("Rotate"), tr("The handle turns about its pivot with the mouse (R)")),
           button("scale", tr("Scale"), tr("The handle grows about its pivot with the mouse (S)"))});
  auto* const fixed =
      button("keep_fixed", tr("Keep fixed"),
             tr("Paint the vertices to keep fixed, no key held; Shift removes them. They hold for all regions"));
  fixed->setCheckable(true);
  shown_.push_back([fixed](const DragSession& session) { fixed->setChecked(session.keeps_fixed()); });
  buttons({button("apply", tr("Apply"), tr("Applies what is being moved (Return)")),
           button("cancel", tr("Cancel"), tr("Cancels what is being moved (Esc, Backspace, right button)")), fixed});
  buttons({button("undo", tr("Undo"), tr("Undoes the last step (Ctrl+Z)")),
           button("redo", tr("Redo"), tr("Redoes the last undone step (Ctrl+Shift+Z)")),
           button("reset", tr("Reset"), tr("Restores the mesh as it was when the tool began"))});
  buttons({button("save", tr("Save..."), tr("Writes all steps as JSON, for Laplacian Edit Replay")),
           button("load", tr("Load..."), tr("Applies the steps of a saved edit")),
           button("copy", tr("Script"),
                  tr("Copies as filter script: puts a filter script (.mlx) with all steps on the clipboard"))});
  progress_ = new QProgressBar;
  progress_->setObjectName(nameOf("progress"));
  progress_->setToolTip(tr("Progress of preparing the region"));
  progress_->setRange(0, 100);
  progress_->setMaximumHeight(14);
  QSizePolicy keepsPlace = progress_->sizePolicy();
  keepsPlace.setRetainSizeWhenHidden(true);
  progress_->setSizePolicy(keepsPlace);
  form_->addRow(progress_);
}

void Panel::addLastStep() {
  begin("last_step", tr("Last step and history"),
        tr("The last step, which can be changed until something else is picked, and all that was done"));
  using Get = std::function<double&(LastStep&)>;
  const auto send = [this](const LastStep& last, bool passing) {
    change([last, passing](DragSession& session) { session.set_last_step(last.motion, last.share, passing); });
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
  auto* const share = prepared<QSlider>("last_share", tr("Share of the path: 0 to 100 percent"));
  share->setOrientation(Qt::Horizontal);
  share->setRange(0, 100);
  const auto go = [this, share, send] {
    if (LastStep last = lastStep_.value_or(LastStep()); lastStep_) {
      last.share = share->value() / 100.0;
      send(last, share->isSliderDown());
    }
  };
  connect(share, &QSlider::valueChanged, this, go);
  connect(share, &QSlider::sliderReleased, this, go);
  shown_.push_back([this, share](const DragSession&) {
    share->setEnabled(lastStep_.has_value());
    if (!share->isSliderDown()) {
      const QSignalBlocker blocker(share);
      share->setValue(static_cast<int>(std::round(100 * (lastStep_ ? lastStep_->share : 1))));
    }
  });
  row(tr("Share of path"), share);
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
    history_.shown = -1;  // the click has chosen a row, which may be refused
    change([row](DragSession& session) { session.go_to(row); });
  });
  form_->addRow(history_.list);
}

void Panel::addRegion() {
  begin("region", tr("Region"), tr("The part of the surface that follows the handle"));
  buttons({button("from_selection", tr("Selection"), tr("The region consists of the selected faces")),
           button("component", tr("Component"), tr("The region is the whole connected piece of the handle")),
           button("clear", tr("Clear"), tr("Removes region and handles; applied steps stay"))});
  buttons({button("grow", tr("Grow"), tr("Makes the region larger by a ring ( ] )")),
           button("shrink", tr("Shrink"), tr("Makes the region smaller by a ring ( [ )")),
           button("new_region", tr("New"), tr("The next click takes a new region (W)"))});
  row(tr("Fixed edge"), percent("padding", 100,
                                tr("Width of the band inside the region's edge that stays, in percent of its radius "
                                   "(Ctrl+Shift+wheel)"),
                                access<&DragSettings::padding, 100>()));
  auto* gap = length("connect_gap",
                     tr("Pieces of the surface that are nearer to each other than this follow as one, such as eyes in "
                        "a head; 0: off"),
                     access<&DragSettings::connect_gap>());
  gap->setSpecialValueText(tr("off"));
  row(tr("Join pieces"), gap);
}

void Panel::addHandles() {
  begin("handle", tr("Brush and handle"), tr("What moves, and what holds"));
  row(tr("Brush"),
      state(
          "brush_target", {tr("Region"), tr("Handle"), tr("Keep fixed")},
          tr("What Ctrl+drag paints more of, and Shift+drag less (B)"),
          [](const DragSession& session) { return static_cast<int>(session.brush_target()); },
          [](DragSession& session, int index) { session.set_brush_target(static_cast<BrushTarget>(index)); }));
  auto* brush = count("brush", 1, 1000, tr("Radius of the brush on the screen"), access<&DragSettings::brush_pixels>());
  brush->setSuffix(tr(" pixels"));
  row(tr("Brush size"), brush);
  row(tr("Softness"), percent("softness", 100,
                              tr("Over how much of its radius the disc's weight falls off towards its rim, in percent; "
                                 "0: all of it is held equally"),
                              access<&DragSettings::softness, 100>()));
  row(tr("Snap to"),
      state(
          "snap", {tr("Off"), tr("Other layers"), tr("Picked points")},
          tr("Where a handle that is moved goes: to the surface of another visible layer under the cursor, or to the "
             "nearest point of MeshLab's tool PickPoints"),
          [](const DragSession& session) { return static_cast<int>(session.snap()); },
          [](DragSession& session, int index) { session.set_snap(static_cast<SnapTo>(index)); }));
  buttons({button("anchors_from_selection", tr("Fix the selection"),
                  tr("The vertices of the selected faces hold, instead of the region's fixed edge"))});
  buttons({button("next_group", tr("Add a handle"), tr("The next click adds a handle; the other handles hold (G)"))});
}

void Panel::addGizmo() {
  begin("gizmo", tr("Gizmo"), tr("Arrows, rings and a knob at the handle"));
  const auto set = [this](bool on, GizmoAxes axes) {
    change([on, axes](DragSession& session) { session.show_gizmo(on, axes); });
  };
  auto* const shown =
      prepared<QCheckBox>("gizmo", tr("Arrows move along an axis, rings turn about it, the knob scales (V)"));
  shown->setText(tr("Show gizmo"));
  auto* const axes = prepared<QComboBox>("gizmo_axes", tr("Directions of the gizmo's arrows"));
  axes->addItems({tr("Layer"), tr("View"), tr("Normal")});
  const auto edit = [set, shown, axes] { set(shown->isChecked(), static_cast<GizmoAxes>(axes->currentIndex())); };
  connect(shown, &QCheckBox::clicked, this, edit);
  connect(axes, QOverload<int>::of(&QComboBox::activated), this, edit);
  shown_.push_back([shown, axes](const DragSession& session) {
    shown->setChecked(session.gizmo_shown());
    axes->setCurrentIndex(static_cast<int>(session.gizmo_axes()));
  });
  form_->addRow(shown);
  row(tr("Axes"), axes);
}

void Panel::addSymmetry() {
  begin("symmetry", tr("Symmetry"), tr("Every step on both sides of a plane at once"));
  QStringList choices = {tr("Off")};
  for (const QString& pattern : {tr("%1, through the origin"), tr("%1, through the box's centre")}) {
    for (const char* const axis : {"X", "Y", "Z"}) {
      choices += pattern.arg(axis);
    }
  }
  choices += tr("Found from the mesh");
  row(tr("Mirror"), state(
                        "mirror", choices, tr("The plane of the layer across which edits are mirrored"),
                        [this](const DragSession& session) {
                          int index = 0;
                          while (session.mirror() && index++ < kPlanes &&
                                 (session.mirror()->point != plane(index - 1).point ||
                                  session.mirror()->normal != plane(index - 1).normal)) {
                          }
                          return index;
                        },
                        [this](DragSession& session, int index) {
                          if (index > kPlanes) {
                            session.find_mirror();
                          } else {
                            session.set_mirror(index == 0 ? std::nullopt : std::optional(plane(index - 1)));
                          }
                        }));
}

MirrorPlane Panel::plane(int index) const {
  return {index < kPlanes / 2 ? Vector3(Vector3::Zero()) : middle_, Vector3::Unit(index % (kPlanes / 2))};
}

void Panel::addAdvanced() {
  begin("advanced", tr("Advanced"), tr("Settings of the solver"));
  for (const Setting& setting : settings_table()) {
    row(titleOf(setting.key), widgetOf(setting));
  }
}

void Panel::addStatistics() {
  begin("statistics", tr("Statistics"), tr("Counts, times and quality"));
  region_ = figure("region", tr("Vertices of the region by class, and of the mesh outside it"));
  times_ = figure("times",
                  tr("Milliseconds until the first frame of a drag was possible, to prepare the region and to solve "
                     "for the last pose, and what was reused of the region before"));
  frame_ = figure("frame", tr("A frame of the drag, from the mouse's move to the picture: medians of the last frames"));
  quality_ = figure("quality", tr("Of the last pose: how far the handle is from its target, the most stretched edge, "
                                  "and where it folded"));
  heat_ = prepared<QCheckBox>("heat", tr("Colours the region by the stretch of its edges"));
  heat_->setText(tr("Show stretch"));
  connect(heat_, &QCheckBox::clicked, this, [this] { change([](DragSession&) {}); });
  form_->addRow(heat_);
  for (QLabel* label : {region_, times_, frame_, quality_}) {
    form_->addRow(label);
  }
}

void Panel::begin(const char* group, const QString& title, const QString& help, bool open) {
  auto* const made = new FoldGroup(title, open);
  made->header()->setObjectName(nameOf(QString("group_") + group));
  made->header()->setToolTip(help);
  column_->addWidget(made);
  form_ = made->form();
}

void Panel::row(const QString& label, QWidget* field) {
  auto* const title = new QLabel(label);
  title->setToolTip(field->toolTip());
  titles_.push_back(title);
  form_->addRow(title, field);
}

void Panel::buttons(const std::vector<QPushButton*>& row) {
  auto* const line = new QHBoxLayout;
  line->setSpacing(2);
  line->setContentsMargins(0, 0, 0, 0);
  for (QPushButton* const each : row) {
    line->addWidget(each, 1);
  }
  form_->addRow(line);
}

// --- Widgets --------------------------------------------------------------------------------------------------------

template <auto member, int factor>
Panel::Access Panel::access() {
  return {[](const DragSettings& settings) { return static_cast<double>(settings.*member) * factor; },
          [](DragSettings& settings, double value) { settings.*member = value / factor; }};
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

template <class Widget>
Widget* Panel::prepared(const char* part, const QString& help) {
  auto* box = new Widget;
  box->setObjectName(nameOf(part));
  box->setToolTip(help);
  // Keys are the canvas's. Only what is typed into needs them, until the value is entered or the mouse is elsewhere.
  box->setFocusPolicy(std::is_base_of_v<QAbstractSpinBox, Widget> ? Qt::ClickFocus : Qt::NoFocus);
  box->installEventFilter(this);
  box->setMaximumWidth(kFieldWidth);
  if constexpr (std::is_base_of_v<QAbstractSpinBox, Widget>) {
    connect(box, &QAbstractSpinBox::editingFinished, this, &Panel::giveKeysBack);
  } else if constexpr (std::is_base_of_v<QComboBox, Widget>) {
    box->view()->installEventFilter(this);
    box->view()->setProperty(kListOf, QVariant::fromValue<QObject*>(box));
  }
  return box;
}

void Panel::giveKeysBack() {
  if (canvas_ && isAncestorOf(QApplication::focusWidget())) {
    canvas_->setFocus();
  }
}

void Panel::change(const Change& change) {
  if (canvas_) {
    canvas_->setFocus();  // first, since what has the keyboard is not brought up to date
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
                        const std::function<double(double)>& placeOf, const Access& access) {
  const QString part = box->objectName().mid(nameOf("").size()) + "_slider";
  auto* const slider = prepared<QSlider>(qPrintable(part), box->toolTip());
  slider->setOrientation(Qt::Horizontal);
  slider->setRange(0, kSliderSteps);
  follow(static_cast<QAbstractSlider*>(slider),
         Access{[access, placeOf](const DragSettings& settings) {
                  return std::round(kSliderSteps * std::clamp(placeOf(access.get(settings)), 0.0, 1.0));
                },
                [access, valueAt](DragSettings& settings, double place) {
                  access.set(settings, valueAt(place / kSliderSteps));
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
  const auto fill = [this, box] {
    box->clear();
    for (const Preset& preset : presets()) {
      box->addItem(preset.name);
      box->setItemData(box->count() - 1, tip(preset.help), Qt::ToolTipRole);
    }
    for (const QString& name : remembered_.presets()) {
      box->addItem(name);
      box->setItemData(box->count() - 1, tip(tr("A preset of your own.")), Qt::ToolTipRole);
    }
    box->addItem(tr("Custom"));
    box->setItemData(box->count() - 1, tip(tr("Values that no preset has.")), Qt::ToolTipRole);
  };
  fill();
  connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box](int index) {
    DragSettings settings = settings_;
    if (index < static_cast<int>(presets().size())) {
      presets()[static_cast<std::size_t>(index)].set(settings);
    } else if (index < box->count() - 1) {
      remembered_.usePreset(box->itemText(index), settings);
    }
    change([settings](DragSession& session) { session.set_settings(settings); });
  });
  shown_.push_back([this, box, fill](const DragSession& session) {
    const int builtIn = static_cast<int>(presets().size()), own = remembered_.presets().size();
    if (box->count() != builtIn + own + 1) {
      fill();
    }
    const int preset = preset_of(session.settings());
    const int ofOwn = remembered_.presets().indexOf(remembered_.presetOf(session.settings()));
    box->setCurrentIndex(ofOwn >= 0 ? builtIn + ofOwn : preset >= 0 ? preset : box->count() - 1);
    buttons_["save_preset"]->setText(ofOwn >= 0 ? tr("Delete preset") : tr("Save preset..."));
  });
  return box;
}

/// The own preset that is chosen goes; else the values become one.
void Panel::saveOrRemovePreset() {
  const QString own = remembered_.presetOf(settings_);
  if (!own.isEmpty()) {
    remembered_.removePreset(own);
  } else {
    bool accepted = false;
    const QString name =
        QInputDialog::getText(this, tr("Save preset"), tr("Name of the preset:"), QLineEdit::Normal, {}, &accepted);
    if (accepted) {
      remembered_.savePreset(name, settings_);
    }
  }
  change([](DragSession&) {});
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

// --- Showing --------------------------------------------------------------------------------------------------------

void Panel::setMesh(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounding_box(mesh.vertices);
  const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  size_ = diagonal > 0 ? diagonal : 1;
  defaults_ = settings_for(mesh);
  history_.shown = -1;  // of another session
  middle_ = box.isEmpty() ? Vector3(Vector3::Zero()) : Vector3(box.center());
  const int digits = std::clamp(5 - static_cast<int>(std::floor(std::log10(size_))), 2, 12);
  for (QDoubleSpinBox* length : lengths_) {
    const QSignalBlocker blocker(length);
    length->setDecimals(digits);
    length->setSingleStep(std::pow(10.0, std::floor(std::log10(size_)) - 2));
  }
}

void Panel::show(const DragSession* session, const FrameTimes& median) {
  const bool has = session != nullptr;
  widget()->setEnabled(has);
  if (!has) {
    return;
  }
  settings_ = session->settings();
  lastStep_ = session->last_step();
  remembered_.keep(*session);
  for (const auto& bring : shown_) {
    bring(*session);
  }
  showCommands(*session);
  showHistory(session->timeline());
  showFigures(*session, median);
}

void Panel::showCommands(const DragSession& session) {
  const bool steps = session.figures().steps > 0;
  const bool moving = session.motion() != nullptr;
  const bool picked = !session.groups().empty();
  buttons_["undo"]->setEnabled(session.can_undo());
  buttons_["redo"]->setEnabled(session.can_redo());
  for (const char* part : {"reset", "save", "copy"}) {
    buttons_[part]->setEnabled(steps);
  }
  buttons_["apply"]->setEnabled(moving);
  buttons_["cancel"]->setEnabled(moving || session.state() == DragSession::State::Settling);
  for (const char* part : {"component", "next_group", "move", "rotate", "scale"}) {
    buttons_[part]->setEnabled(picked);
  }
  for (const char* part : {"grow", "shrink", "anchors_from_selection"}) {
    buttons_[part]->setEnabled(session.region() != nullptr);
  }
}

void Panel::showFigures(const DragSession& session, const FrameTimes& median) {
  const DragFigures figures = session.figures();
  progress_->setVisible(session.preparing());
  progress_->setValue(static_cast<int>(100 * session.progress()));
  progress_->setFormat(QString("%1 %p %").arg(session.stage()));
  const bool known = session.region() != nullptr;
  const auto count = [known](int vertices) { return known ? QString::number(vertices) : QString(kUnknown); };
  region_->setText(tr("Handle %1, free %2, anchors %3, fixed %4; steps: %5")
                       .arg(count(figures.handle), count(figures.free), count(figures.anchors), count(figures.fixed))
                       .arg(figures.steps));
  times_->setText(
      tr("First frame after %1 ms, prepared in %2 ms, solved in %3 ms")
          .arg(text(figures.in_hand_ms, 'f', 1), text(figures.prepare_ms, 'f', 1), text(figures.solve_ms, 'f', 1)) +
      (figures.taken_over.empty() ? QString()
                                  : "\n" + tr("Reused: %1").arg(QString::fromStdString(figures.taken_over))));
  const auto frame = [&](double milliseconds, int digits) {
    return text(median.total > 0 ? std::optional(milliseconds) : std::nullopt, 'f', digits);
  };
  frame_->setText(tr("Frame %1 ms (%2/s): solve %3, write %4, send %5, draw %6")
                      .arg(frame(median.total, 1), frame(1000 / median.total, 0), frame(median.solve, 1),
                           frame(median.write, 1), frame(median.upload, 1), frame(median.draw, 1)));
  const auto stretch = figures.largest_stretch ? std::optional(100 * *figures.largest_stretch) : std::nullopt;
  quality_->setText(tr("Handle %1 from its target; largest stretch %2 %")
                        .arg(text(figures.handle_error, 'g', 3), text(stretch, 'f', 0)) +
                    (figures.advice.empty() ? QString() : "\n" + QString::fromStdString(figures.advice)));
}

bool Panel::heat() const {
  return heat_->isChecked();
}

void Panel::setHeat(bool on) {
  heat_->setChecked(on);
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

/// The wheel scrolls the panel; it changes a number only after a click on it. Esc leaves a list or a number alone,
/// where Qt closes the list already when it asks for shortcuts, and MeshLab's own Esc would follow.
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
          whole->setValue(whole->value());  // what was typed is no value yet
        } else if (auto* const number = qobject_cast<QDoubleSpinBox*>(object)) {
          number->setValue(number->value());
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
