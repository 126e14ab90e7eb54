// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/presets.h"

namespace lapedit {
namespace {

/// All that a preset is about.
struct Values {
  LaplacianKind laplacian;
  int order;
  DetailRotation rotation;
  DetailTurning turning;
  double membrane, handle_share, softness;
};

void set(DragSettings& settings, const Values& values) {
  const EditSettings machine = settings.edit;
  settings.edit = EditSettings();
  settings.edit.backend = machine.backend;
  settings.edit.threads = machine.threads;
  settings.edit.laplacian = values.laplacian;
  settings.edit.order = values.order;
  settings.edit.rotation = values.rotation;
  settings.edit.turning = values.turning;
  settings.edit.membrane = values.membrane;
  settings.handle_share = values.handle_share;
  settings.softness = values.softness;
}

}  // namespace

const std::vector<Preset>& presets() {
  using Kind = LaplacianKind;
  using Rotation = DetailRotation;
  static const std::vector<Preset> list = {
      {"General", "What suits most surfaces.",
       [](DragSettings& s) {
         s.handle_share = DragSettings().handle_share, s.softness = 0,
         set(s, {EditSettings().laplacian, EditSettings().order, EditSettings().rotation, EditSettings().turning,
                 EditSettings().membrane, DragSettings().handle_share, DragSettings().softness});
       }},
      {"Limb", "Arms, legs, tails and horns: bends as a whole and keeps its thickness.",
       [](DragSettings& s) {
         set(s, {Kind::MeanValue, 1, Rotation::LocalGlobal, DetailTurning::Edge, 1000, 0.25, 0});
       }},
      {"Face", "Noses, lips, ears and cheeks: a soft dab that runs out smoothly.",
       [](DragSettings& s) {
         set(s, {Kind::MeanValue, 1, Rotation::LocalGlobal, DetailTurning::Edge, 200, 0.25, 1});
       }},
      {"Terrain", "Hills and height fields: details stay upright, as nothing is turned.",
       [](DragSettings& s) {
         set(s, {Kind::MeanValue, 1, Rotation::None, DetailTurning::Edge, 0, 0.3, 1});
       }},
      {"Sharp", "Machined parts and letters: edges of the handle stay as they are, nothing falls off.",
       [](DragSettings& s) {
         set(s, {Kind::MeanValue, 1, Rotation::LocalGlobal, DetailTurning::Edge, 1000, 0.15, 0});
       }},
  };
  return list;
}

int preset_of(const DragSettings& settings) {
  for (std::size_t i = 0; i < presets().size(); ++i) {
    DragSettings set = settings;
    presets()[i].set(set);
    if (set.edit == settings.edit && set.handle_share == settings.handle_share && set.softness == settings.softness) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace lapedit
