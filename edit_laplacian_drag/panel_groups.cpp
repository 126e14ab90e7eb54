// SPDX-License-Identifier: GPL-3.0-or-later
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLineEdit>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QRegularExpression>
#include <QSlider>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <type_traits>
#include <utility>

#include "panel.h"

using namespace lapedit;

// Panel: groups and their rows.

namespace {

constexpr int kPlanes = 6;  // number of mirror planes in the list
constexpr int kHistoryRows = 6;

/// Returns rich text, which tool tips break into lines.
QString tip(const QString& help) {
  return "<qt>" + help.toHtmlEscaped() + "</qt>";
}

/// Returns the label of a setting or of a choice.
QString titleOf(const char* key) {
  return QString::fromStdString(title_of(key));
}

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

template <auto member, int factor>
Panel::Access Panel::access() {
  return ofSettings([](const DragSettings& settings) { return static_cast<double>(settings.*member) * factor; },
                    [](DragSettings& settings, double value) {
                      settings.*member = static_cast<std::decay_t<decltype(settings.*member)>>(value / factor);
                    });
}

void Panel::addBasic() {
  begin("basic", tr("Basic"), tr("Settings that most edits need"), true);
  length("radius", tr("Radius"), tr("Size of a new region, along the surface (wheel)"),
         access<&DragSettings::radius>());
  number("handle_fraction", tr("Handle size"), 0, 100 * kLargestHandleFraction, 1,
         tr("Radius of the disc that a press takes, in percent of the region's radius "
            "(Shift+wheel); 0: the vertex under the cursor alone"),
         access<&DragSettings::handle_fraction, 100>(), tr(" %"));
  addDetail();
  check(
      "automatic", tr("Automatic sizes"),
      tr("A press takes the radius of the ear, nose or limb there, and a fifth of it for the handle, until a radius is "
         "set"),
      ofSettings([](const DragSettings& settings) { return settings.first_radius > 0 ? 1 : 0; },
                 [this](DragSettings& settings, double on) {
                   settings.first_radius = on * defaults_.first_radius;
                   settings.handle_fraction = on > 0 ? defaults_.handle_fraction : settings.handle_fraction;
                 }));
  addPieces();
  auto* const click = choice(
      "mode", tr("Click takes"), {tr("Disc or vertex"), tr("Curve"), tr("Another handle"), tr("New region")},
      tr("What a click takes: a disc or vertex, a curve of shortest paths (C), a handle besides the others, which hold "
         "(G), or a new region (W)"),
      {[](const DragSession& session) {
         const Selection& selection = session.selection();
         return selection.next == Selection::Next::Region  ? 3
                : selection.next == Selection::Next::Group ? 2
                : selection.mode == HandleMode::Curve      ? 1
                                                           : 0;
       },
       [](DragSession& session, int index) {
         if (index >= 2) {
           session.key(index == 2 ? DragKey::NextGroup : DragKey::NewRegion);
         } else {
           session.take_by_click(index == 1 ? HandleMode::Curve : HandleMode::Vertex);
         }
       }});
  click->setItemIcon(0, icon("disc"));
  click->setItemIcon(1, icon("curve"));
  auto* const reset =
      field<QPushButton>("defaults", tr("Settings"), tr("All settings of the panel, as they were at first"));
  reset->setText(tr("Reset all"));
  connect(reset, &QPushButton::clicked, this, [this] {
    change([settings = defaults_](DragSession& session) mutable {
      settings.edit.detail = session.settings().edit.detail;
      session.set_settings(settings);
      session.set(&Tools::gizmo, false);
      session.set(&Tools::axes, GizmoAxes::Layer);
    });
  });
  choice("pivot", tr("Turn about"), {tr("Handle's middle"), tr("Shoulder (edge)"), tr("Point (next click)")},
         tr("The point that turning and scaling go about (P): the middle of the handle, the middle of the region's "
            "edge, as the shoulder of an arm, or a point that the next click picks. With the last two a drag of the "
            "handle turns it; Shift moves it"),
         {[](const DragSession& session) { return static_cast<int>(session.tools().pivot); },
          [](DragSession& session, int index) { session.set(&Tools::pivot, static_cast<Pivot>(index)); }});
  addMirror();
  choice("gizmo", tr("Gizmo"), {tr("Hidden"), tr("Axes of the layer"), tr("Axes of the view"), tr("Along the normal")},
         tr("Arrows move along an axis, rings turn about it, the scale handle scales (V)"),
         {[](const DragSession& session) {
            return session.tools().gizmo ? 1 + static_cast<int>(session.tools().axes) : 0;
          },
          [](DragSession& session, int index) {
            session.set(&Tools::gizmo, index > 0);
            session.set(&Tools::axes, static_cast<GizmoAxes>(std::max(index - 1, 0)));
          }});
  buttons({button("move", tr("Move"), tr("The handle follows the mouse, no button held (T)"), DragKey::Translate),
           button("rotate", tr("Rotate"), tr("The handle turns about its pivot with the mouse (R)"), DragKey::Rotate),
           button("scale", tr("Scale"), tr("The handle grows about its pivot with the mouse (S)"), DragKey::Scale),
           button("apply", tr("Apply"), tr("Applies what is being moved (Return)"), DragKey::Apply),
           button("cancel", tr("Cancel"), tr("Cancels what is being moved (Esc, Backspace, right button)"),
                  DragKey::Cancel)});
  buttons_["apply"]->hide();
  buttons_["cancel"]->hide();
  buttons({button("undo", tr("Undo"), tr("Undoes the last step (Ctrl+Z)"), DragKey::Undo),
           button("redo", tr("Redo"), tr("Redoes the last undone step (Ctrl+Shift+Z)"), DragKey::Redo),
           button("reset", tr("Undo all"), tr("Restores the mesh as it was when the tool began"))});
  buttons(
      {button("save", tr("Save..."), tr("Writes all steps as JSON or as a filter script, for Laplacian Edit Replay")),
       button("load", tr("Load..."), tr("Applies the steps of a saved edit")),
       button("help", tr("Keys"), tr("Shows all keys over the picture (?)"), DragKey::Help)});
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

void Panel::addDetail() {
  slider(
      "detail", {}, 200,
      tr("How much of the detail remains in the region: 0 removes dents and bumps, 100 % keeps them, 200 % "
         "doubles them. "
         "Needs no drag: press on the dent, or paint it, then move this"),
      [](const DragSession& session) { return session.settings().edit.detail; },
      [](DragSession& session, double detail, bool passing) {
        DragSettings settings = session.settings();
        settings.edit.detail = detail;
        session.set_settings(settings, passing);
      });
  shown_.push_back([title = titles_.back()](const DragSession& session) {
    title->setText(tr("Detail %1 %").arg(std::round(100 * session.settings().edit.detail)));
  });
}

void Panel::addPieces() {
  auto* const pieces = check("pieces", {},
                             tr("Small pieces inside the region or touching it, such as eyes and teeth, keep their "
                                "distance to it; otherwise they stay"),
                             access<&DragSettings::pieces>());
  shown_.push_back([pieces](const DragSession& session) {
    const int count = session.figures().pieces;
    pieces->setVisible(count > 0 || !session.settings().pieces);
    pieces->setText(count > 0 ? tr("Small pieces come along: %1").arg(count) : tr("Small pieces come along"));
  });
}

void Panel::addMirror() {
  QStringList choices = {tr("Off")};
  for (const QString& pattern : {tr("%1, through the origin"), tr("%1, through the box's centre")}) {
    for (const char* const axis : {"X", "Y", "Z"}) {
      choices += pattern.arg(axis);
    }
  }
  choices += tr("Found from the mesh");
  choice("mirror", tr("Mirror"), choices, tr("The plane of the layer across which every step is mirrored"),
         {[this](const DragSession& session) {
            int index = 0;
            while (session.tools().mirror && index++ < kPlanes && !(session.tools().mirror == plane(index - 1))) {
            }
            return index;
          },
          [this](DragSession& session, int index) {
            if (index > kPlanes) {
              session.find_mirror();
            } else {
              session.set(&Tools::mirror, index == 0 ? std::nullopt : std::optional(plane(index - 1)));
            }
          }});
}

MirrorPlane Panel::plane(int index) const {
  return {index < kPlanes / 2 ? Vector3(Vector3::Zero()) : middle_, Vector3::Unit(index % (kPlanes / 2))};
}

void Panel::addPaint() {
  begin("paint", tr("Paint"), tr("The region, the handle, or vertices that stay where they are"));
  choice("brush_target", tr("Paint"), {tr("Off"), tr("Region"), tr("Handle"), tr("Fixed")},
         tr("What a drag paints more of, and Shift+drag less, until Esc (B); fixed vertices hold in all "
            "regions. Off: Ctrl+drag and Shift+drag paint the region"),
         {[](const DragSession& session) {
            return session.tools().paint ? 1 + static_cast<int>(*session.tools().paint) : 0;
          },
          [](DragSession& session, int index) {
            session.set(&Tools::paint, index > 0 ? std::optional(static_cast<BrushTarget>(index - 1)) : std::nullopt);
          }});
  number("brush", tr("Brush size"), 1, 1000, 0, tr("Radius of the brush on the screen"),
         access<&DragSettings::brush_pixels>(), tr(" pixels"));
  buttons({button("invert", tr("Invert"), tr("Swaps painted and unpainted vertices")),
           button("blur", tr("Blur"), tr("Makes the outline of what is painted smoother")),
           button("clear", tr("Clear"),
                  tr("Removes all that is painted; with Paint off: region, handles and fixed "
                     "vertices. Applied steps stay"))});
  buttons({button("from_selection", tr("Selected vertices and faces"),
                  tr("Takes MeshLab's selection as the region, the handle or fixed, as Paint says"))});
}

void Panel::addRegion() {
  begin("region", tr("Region and handle"), tr("The part of the surface that follows the handle, and how"));
  buttons({button("grow", tr("Grow"), tr("Makes the region larger by a ring ( ] )"), DragKey::Grow),
           button("shrink", tr("Shrink"), tr("Makes the region smaller by a ring ( [ )"), DragKey::Shrink),
           button("component", tr("Component"), tr("The region is the whole connected piece of the handle"))});
  choice("falloff", tr("Falloff"), {tr("Even"), tr("Sharp"), tr("Smooth"), tr("Dome")},
         tr("How the handle's disc fades out from its middle to its boundary"), access<&DragSettings::falloff>());
  choice("snap", tr("Snap to"), {tr("Off"), tr("Other layers")},
         tr("Where a handle that is moved goes: to the surface of another visible layer under the cursor"),
         {[](const DragSession& session) { return session.tools().snaps ? 1 : 0; },
          [](DragSession& session, int index) { session.set(&Tools::snaps, index == 1); }});
  number("padding", tr("Width of the edge"), 0, 100, 1,
         tr("Width of the band inside the region's edge that stays, in percent of its "
            "radius (Ctrl+Shift+wheel)"),
         access<&DragSettings::padding, 100>(), tr(" %"));
  auto* gap = length("connect_gap", tr("Connect within"),
                     tr("Pieces of the surface, or its borders, that are nearer to each other than this keep their "
                        "distance, such as eyes in a head, or a seam that is open; 0: off"),
                     access<&DragSettings::connect_gap>());
  gap->setSpecialValueText(tr("off"));
}

void Panel::addAdvanced() {
  begin("advanced", tr("Solver"), tr("How the region is deformed; a saved edit has all settings of the solver"));
  for (const Setting& setting : settings_table()) {
    const Access access =
        ofSettings([&setting](const DragSettings& settings) { return setting.get(settings.edit); },
                   [&setting](DragSettings& settings, double value) { setting.set(settings.edit, value); });
    if (QString(setting.key) == "method") {
      QStringList names;
      std::transform(setting.choices.begin(), setting.choices.end(), std::back_inserter(names), titleOf);
      choice(setting.key, titleOf(setting.key), names, tip(setting.help), access);
    } else if (setting.kind == Setting::Kind::Switch) {
      auto* const box = check(setting.key, titleOf(setting.subject), tip(setting.help), access);
      shown_.push_back([box, &setting](const DragSession& session) {
        box->setVisible(setting.applies(session.settings().edit.method));
      });
    } else if (QString(setting.key) == "membrane") {
      number(setting.key, tr("Keep lengths"), setting.low, setting.high, 6, tip(setting.help), access);
    }
  }
}

void Panel::addLastStep() {
  begin("last_step", tr("Last step and history"),
        tr("The last step, which can be changed until something else is picked, and all that was done"));
  auto* const value = field<QLineEdit>("last_value", tr("Moved"),
                                       tr("What the last step did: a displacement along X, Y and Z of the "
                                          "layer, degrees about the axis, or a factor"));
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
  auto* const fraction = slider(
      "last_fraction", tr("Fraction"), 100, tr("Fraction of the path: 0 to 100 percent"),
      [](const DragSession& session) { return session.last_step().value_or(LastStep()).fraction; },
      [](DragSession& session, double part, bool passing) {
        if (const std::optional<LastStep> last = session.last_step()) {
          session.set_last_step(last->motion, part, passing);
        }
      });
  shown_.push_back([fraction](const DragSession& session) { fraction->setEnabled(session.last_step().has_value()); });
  addHistory();
}

void Panel::addHistory() {
  history_ = new QListWidget;
  history_->setObjectName(nameOf("timeline"));
  history_->setToolTip(tr("All steps and strokes in order: a click goes to the state after one; grey ones are undone"));
  history_->setFocusPolicy(Qt::NoFocus);
  history_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  history_->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
  history_->setFixedHeight(kHistoryRows * history_->fontMetrics().lineSpacing());
  connect(history_, &QListWidget::itemClicked, this, [this](const QListWidgetItem* item) {
    const auto row = static_cast<std::size_t>(history_->row(item));
    shownHistory_ = -1;  // fills the list again, since the session may refuse
    change([row](DragSession& session) { session.go_to(row); });
  });
  form_->addRow(history_);
}

void Panel::showHistory(const Timeline& timeline) {
  if (std::exchange(shownHistory_, timeline.serial()) == timeline.serial()) {
    return;
  }
  history_->clear();
  history_->addItem(tr("Start"));
  for (const Action& action : timeline.done()) {
    history_->addItem(QString::fromStdString(action.name));
  }
  history_->setCurrentRow(history_->count() - 1);
  for (auto action = timeline.undone().rbegin(); action != timeline.undone().rend(); ++action) {
    auto* const item = new QListWidgetItem(QString::fromStdString(action->name), history_);
    item->setForeground(palette().brush(QPalette::Disabled, QPalette::Text));
  }
}

void Panel::addView() {
  begin("statistics", tr("View and figures"), tr("Colours over the surface, counts and quality"));
  colours_ = field<QComboBox>("colours", tr("Colours"),
                              tr("What the colours over the surface show; H hides them: with no colours the shading of "
                                 "the surface is seen"));
  colours_->addItems({tr("Region"), tr("Stretch"), tr("None")});
  connect(colours_, QOverload<int>::of(&QComboBox::activated), this, [this] { change([](DragSession&) {}); });
  const std::tuple<QLabel*, const char*, QString> figures[] = {
      {region_, "region", tr("Vertices of the region by class, and of the mesh outside it")},
      {quality_, "quality",
       tr("Of the last pose: how far the handle is from its target, the most stretched edge, and "
          "where it folded")}};
  for (const auto& [label, part, help] : figures) {
    label->setObjectName(nameOf(part));
    label->setToolTip(help);
    label->setWordWrap(true);
    form_->addRow(label);
  }
}

void Panel::begin(const char* group, const QString& title, const QString& help, bool open) {
  auto* const header = new QToolButton;
  header->setObjectName(nameOf(QString("group_") + group));
  header->setToolTip(help);
  header->setText(title);
  header->setCheckable(true);
  header->setChecked(open);
  header->setAutoRaise(true);
  header->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  header->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  header->setFocusPolicy(Qt::NoFocus);
  QFont bold = header->font();
  bold.setBold(true);
  header->setFont(bold);
  auto* const body = new QWidget;
  form_ = new QFormLayout(body);
  form_->setVerticalSpacing(2);
  form_->setHorizontalSpacing(4);
  form_->setContentsMargins(4, 0, 4, 4);
  column_->addWidget(header);
  column_->addWidget(body);
  const auto fold = [header, body](bool shown) {
    body->setVisible(shown);
    header->setArrowType(shown ? Qt::DownArrow : Qt::RightArrow);
  };
  fold(open);
  connect(header, &QToolButton::toggled, body, fold);
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
