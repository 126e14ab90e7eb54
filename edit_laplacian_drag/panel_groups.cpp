// SPDX-License-Identifier: GPL-3.0-or-later
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QSpinBox>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "panel.h"
#include "panel_widgets.h"

using namespace lapedit;

// Panel: groups and their rows, except the last step and the history.

namespace {

constexpr int kPlanes = 6;  // number of mirror planes in the list

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
  row(tr("Radius"),
      length("radius", tr("Size of a new region, along the surface (wheel)"), access<&DragSettings::radius>()));
  row(tr("Handle size"), percent("handle_fraction", static_cast<int>(100 * kLargestHandleFraction),
                                 tr("Radius of the disc that a press takes, in percent of the region's radius "
                                    "(Shift+wheel); 0: the vertex under the cursor alone"),
                                 access<&DragSettings::handle_fraction, 100>()));
  addDetail();
  addAutomatic();
  addPieces();
  auto* const click = choice(
      "mode", {tr("Disc or vertex"), tr("Curve"), tr("Another handle"), tr("New region")},
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
  click->setItemIcon(0, panelIcon("disc", palette()));
  click->setItemIcon(1, panelIcon("curve", palette()));
  row(tr("Click takes"), click);
  row(tr("Settings"), resetButton());
  row(tr("Turn about"),
      choice(
          "pivot", {tr("Handle's middle"), tr("Shoulder (edge)"), tr("Point (next click)")},
          tr("The point that turning and scaling go about (P): the middle of the handle, the middle of the region's "
             "edge, as the shoulder of an arm, or a point that the next click picks. With the last two a drag of the "
             "handle turns it; Shift moves it"),
          {[](const DragSession& session) { return static_cast<int>(session.tools().pivot); },
           [](DragSession& session, int index) { session.set(&Tools::pivot, static_cast<Pivot>(index)); }}));
  addMirror();
  row(tr("Gizmo"),
      choice("gizmo", {tr("Hidden"), tr("Axes of the layer"), tr("Axes of the view"), tr("Along the normal")},
             tr("Arrows move along an axis, rings turn about it, the scale handle scales (V)"),
             {[](const DragSession& session) {
                return session.tools().gizmo ? 1 + static_cast<int>(session.tools().axes) : 0;
              },
              [](DragSession& session, int index) {
                session.set(&Tools::gizmo, index > 0);
                session.set(&Tools::axes, static_cast<GizmoAxes>(std::max(index - 1, 0)));
              }}));
  buttons({button("move", tr("Move"), tr("The handle follows the mouse, no button held (T)")),
           button("rotate", tr("Rotate"), tr("The handle turns about its pivot with the mouse (R)")),
           button("scale", tr("Scale"), tr("The handle grows about its pivot with the mouse (S)")),
           button("apply", tr("Apply"), tr("Applies what is being moved (Return)")),
           button("cancel", tr("Cancel"), tr("Cancels what is being moved (Esc, Backspace, right button)"))});
  buttons_["apply"]->hide();
  buttons_["cancel"]->hide();
  buttons({button("undo", tr("Undo"), tr("Undoes the last step (Ctrl+Z)")),
           button("redo", tr("Redo"), tr("Redoes the last undone step (Ctrl+Shift+Z)")),
           button("reset", tr("Undo all"), tr("Restores the mesh as it was when the tool began"))});
  buttons(
      {button("save", tr("Save..."), tr("Writes all steps as JSON or as a filter script, for Laplacian Edit Replay")),
       button("load", tr("Load..."), tr("Applies the steps of a saved edit")),
       button("help", tr("Keys"), tr("Shows all keys over the picture (?)"))});
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
  auto* const detail =
      slider("detail", 200,
             tr("How much of the detail remains in the region: 0 removes dents and bumps, 100 % keeps them, 200 % "
                "doubles them. "
                "Needs no drag: press on the dent, or paint it, then move this"),
             [this](int percent, bool passing) {
               change([percent, passing](DragSession& session) {
                 DragSettings settings = session.settings();
                 settings.edit.detail = percent / 100.0;
                 session.set_settings(settings, passing);
               });
             });
  row({}, detail);
  shown_.push_back([detail, title = titles_.back()](const DragSession& session) {
    const QSignalBlocker blocker(detail);
    detail->setValue(static_cast<int>(std::round(100 * session.settings().edit.detail)));
    title->setText(tr("Detail %1 %").arg(detail->value()));
  });
}

void Panel::addAutomatic() {
  check(
      "automatic", tr("Automatic sizes"),
      tr("A press takes the radius of the ear, nose or limb there, and a fifth of it for the handle, until a radius is "
         "set"),
      ofSettings([](const DragSettings& settings) { return settings.first_radius > 0 ? 1 : 0; },
                 [this](DragSettings& settings, double on) {
                   settings.first_radius = on * defaults_.first_radius;
                   settings.handle_fraction = on > 0 ? defaults_.handle_fraction : settings.handle_fraction;
                 }));
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
  row(tr("Mirror"),
      choice("mirror", choices, tr("The plane of the layer across which every step is mirrored"),
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
              }}));
}

MirrorPlane Panel::plane(int index) const {
  return {index < kPlanes / 2 ? Vector3(Vector3::Zero()) : middle_, Vector3::Unit(index % (kPlanes / 2))};
}

void Panel::addPaint() {
  begin("paint", tr("Paint"), tr("The region, the handle, or vertices that stay where they are"));
  row(tr("Paint"),
      choice("brush_target", {tr("Off"), tr("Region"), tr("Handle"), tr("Fixed")},
             tr("What a drag paints more of, and Shift+drag less, until Esc (B); fixed vertices hold in all "
                "regions. Off: Ctrl+drag and Shift+drag paint the region"),
             {[](const DragSession& session) {
                return session.tools().paint ? 1 + static_cast<int>(*session.tools().paint) : 0;
              },
              [](DragSession& session, int index) {
                session.set(&Tools::paint,
                            index > 0 ? std::optional(static_cast<BrushTarget>(index - 1)) : std::nullopt);
              }}));
  auto* brush = count("brush", 1, 1000, tr("Radius of the brush on the screen"), access<&DragSettings::brush_pixels>());
  brush->setSuffix(tr(" pixels"));
  row(tr("Brush size"), brush);
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
  buttons({button("grow", tr("Grow"), tr("Makes the region larger by a ring ( ] )")),
           button("shrink", tr("Shrink"), tr("Makes the region smaller by a ring ( [ )")),
           button("component", tr("Component"), tr("The region is the whole connected piece of the handle"))});
  row(tr("Falloff"),
      choice("falloff", {tr("Even"), tr("Sharp"), tr("Smooth"), tr("Dome")},
             tr("How the handle's disc fades out from its middle to its boundary"), access<&DragSettings::falloff>()));
  row(tr("Snap to"),
      choice("snap", {tr("Off"), tr("Other layers")},
             tr("Where a handle that is moved goes: to the surface of another visible layer under the cursor"),
             {[](const DragSession& session) { return session.tools().snaps ? 1 : 0; },
              [](DragSession& session, int index) { session.set(&Tools::snaps, index == 1); }}));
  row(tr("Width of the edge"), percent("padding", 100,
                                       tr("Width of the band inside the region's edge that stays, in percent of its "
                                          "radius (Ctrl+Shift+wheel)"),
                                       access<&DragSettings::padding, 100>()));
  auto* gap = length("connect_gap",
                     tr("Pieces of the surface, or its borders, that are nearer to each other than this keep their "
                        "distance, such as eyes in a head, or a seam that is open; 0: off"),
                     access<&DragSettings::connect_gap>());
  gap->setSpecialValueText(tr("off"));
  row(tr("Connect within"), gap);
}

void Panel::addView() {
  begin("statistics", tr("View and figures"), tr("Colours over the surface, counts and quality"));
  colours_ =
      prepared<QComboBox>("colours", tr("What the colours over the surface show; H hides them: with no colours, or "
                                        "with none during a drag, the shading of the surface is seen"));
  colours_->addItems({tr("Region"), tr("Region, not in a drag"), tr("Stretch"), tr("None")});
  connect(colours_, QOverload<int>::of(&QComboBox::activated), this, [this] { change([](DragSession&) {}); });
  row(tr("Colours"), colours_);
  region_ = figure("region", tr("Vertices of the region by class, and of the mesh outside it"));
  quality_ = figure("quality", tr("Of the last pose: how far the handle is from its target, the most stretched edge, "
                                  "and where it folded"));
  for (QLabel* label : {region_, quality_}) {
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
