// SPDX-License-Identifier: GPL-3.0-or-later
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "lapedit/session/presets.h"
#include "panel.h"
#include "panel_icons.h"
#include "panel_widgets.h"

using namespace lapedit;

// Panel: groups and their rows, but for the last step and the history.

namespace {

// Ends of the slider for the radius, as shares of the mesh's size.
constexpr double kSmallestRadius = 0.002, kLargestRadius = 1;
constexpr int kPlanes = 6;  // to mirror at
}  // namespace

template <auto member, int factor>
Panel::Access Panel::access() {
  return {[](const DragSettings& settings) { return static_cast<double>(settings.*member) * factor; },
          [](DragSettings& settings, double value) { settings.*member = value / factor; }};
}

void Panel::addBasic() {
  begin("basic", tr("Basic"), tr("Settings that most edits need"), true);
  const Access radius = access<&DragSettings::radius>();
  row(tr("Radius"),
      dragged(
          length("radius", tr("Size of a new region, along the surface (wheel)"), radius),
          [this](double position) {
            return threeDigits(size_ * kSmallestRadius * std::pow(kLargestRadius / kSmallestRadius, position));
          },
          [this](double value) {
            return std::log(value / (size_ * kSmallestRadius)) / std::log(kLargestRadius / kSmallestRadius);
          },
          radius));
  const double largest = 100 * kLargestHandleFraction;
  const Access fraction = access<&DragSettings::handle_fraction, 100>();
  row(tr("Handle size"), dragged(
                             percent("handle_fraction", static_cast<int>(largest),
                                     tr("Radius of the disc that a press takes, in percent of the region's radius "
                                        "(Shift+wheel); 0: the vertex under the cursor alone"),
                                     fraction),
                             [largest](double position) { return std::round(largest * position); },
                             [largest](double value) { return value / largest; }, fraction));
  auto* const mode = state(
      "mode", {tr("Disc or vertex"), tr("Curve")},
      tr("How clicks make a handle (C): a curve joins them by shortest paths"),
      [](const DragSession& session) { return session.tools().mode == HandleMode::Curve ? 1 : 0; },
      [](DragSession& session, int index) {
        session.set(&Tools::mode, index == 1 ? HandleMode::Curve : HandleMode::Vertex);
      });
  mode->setItemIcon(0, panelIcon("disc", palette()));
  mode->setItemIcon(1, panelIcon("curve", palette()));
  row(tr("Handle"), mode);
  row(tr("Preset"), presetChoice());
  auto* const defaults = button("defaults", tr("Defaults"), tr("Resets all settings to their initial values"));
  connect(defaults, &QPushButton::clicked, this, [this] {
    change([settings = defaults_](DragSession& session) {
      session.set_settings(settings);
      session.set(&Tools::gizmo, false);
      session.set(&Tools::axes, GizmoAxes::Layer);
    });
  });
  buttons({defaults, button("help", tr("Keys"), tr("Shows all keys over the picture (?)"))});
  row(tr("Turn about"),
      state(
          "pivot", {tr("Handle's middle"), tr("Shoulder (edge)"), tr("Point (next click)")},
          tr("The point that turning and scaling go about (P): the middle of the handle, the middle "
             "of the region's edge, as the shoulder of an arm, or a point that the next click picks"),
          [](const DragSession& session) { return static_cast<int>(session.tools().pivot); },
          [](DragSession& session, int index) { session.set(&Tools::pivot, static_cast<Pivot>(index)); }));
  buttons({button("move", tr("Move"), tr("The handle follows the mouse, no button held (T)")),
           button("rotate", tr("Rotate"), tr("The handle turns about its pivot with the mouse (R)")),
           button("scale", tr("Scale"), tr("The handle grows about its pivot with the mouse (S)"))});
  auto* const fixed =
      button("keep_fixed", tr("Keep fixed"),
             tr("Paint the vertices to keep fixed, no key held; Shift removes them. They hold for all regions"));
  fixed->setCheckable(true);
  shown_.push_back([fixed](const DragSession& session) { fixed->setChecked(session.tools().keeps_fixed); });
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

void Panel::addRegion() {
  begin("region", tr("Region"), tr("The part of the surface that follows the handle"));
  buttons({button("from_selection", tr("Selection"), tr("The region consists of the selected vertices and faces")),
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
                     tr("Pieces of the surface, or its borders, that are nearer to each other than this keep their "
                        "distance, such as eyes in a head, or a seam that is open; 0: off"),
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
          [](const DragSession& session) { return static_cast<int>(session.tools().brush); },
          [](DragSession& session, int index) { session.set(&Tools::brush, static_cast<BrushTarget>(index)); }));
  auto* brush = count("brush", 1, 1000, tr("Radius of the brush on the screen"), access<&DragSettings::brush_pixels>());
  brush->setSuffix(tr(" pixels"));
  row(tr("Brush size"), brush);
  row(tr("Softness"), percent("softness", 100,
                              tr("Over how much of its radius the disc's weight falls off towards its rim, in percent; "
                                 "0: all of it is held equally"),
                              access<&DragSettings::softness, 100>()));
  row(tr("Snap to"),
      state(
          "snap", {tr("Off"), tr("Other layers")},
          tr("Where a handle that is moved goes: to the surface of another visible layer under the cursor"),
          [](const DragSession& session) { return session.tools().snaps ? 1 : 0; },
          [](DragSession& session, int index) { session.set(&Tools::snaps, index == 1); }));
  buttons({button("anchors_from_selection", tr("Fix the selection"),
                  tr("The selected vertices and faces hold in all regions, in this one instead of its fixed edge"))});
  buttons({button("next_group", tr("Add a handle"), tr("The next click adds a handle; the other handles hold (G)"))});
}

void Panel::addGizmo() {
  begin("gizmo", tr("Gizmo"), tr("Arrows, rings and a knob at the handle"));
  const auto set = [this](bool on, GizmoAxes axes) {
    change([on, axes](DragSession& session) {
      session.set(&Tools::gizmo, on);
      session.set(&Tools::axes, axes);
    });
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
    shown->setChecked(session.tools().gizmo);
    axes->setCurrentIndex(static_cast<int>(session.tools().axes));
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
                          while (session.tools().mirror && index++ < kPlanes &&
                                 (session.tools().mirror->point != plane(index - 1).point ||
                                  session.tools().mirror->normal != plane(index - 1).normal)) {
                          }
                          return index;
                        },
                        [this](DragSession& session, int index) {
                          if (index > kPlanes) {
                            session.find_mirror();
                          } else {
                            session.set(&Tools::mirror, index == 0 ? std::nullopt : std::optional(plane(index - 1)));
                          }
                        }));
}

MirrorPlane Panel::plane(int index) const {
  return {index < kPlanes / 2 ? Vector3(Vector3::Zero()) : middle_, Vector3::Unit(index % (kPlanes / 2))};
}

void Panel::addStatistics() {
  begin("statistics", tr("Statistics"), tr("Counts, times and quality"));
  region_ = figure("region", tr("Vertices of the region by class, and of the mesh outside it"));
  times_ = figure("times",
                  tr("Milliseconds until the first frame of a drag was possible, to prepare the region and to solve "
                     "for the last pose"));
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
