// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/presets.h"

namespace lapedit {
namespace {

void set(DragSettings& settings, const EditSettings& edit, double handle_fraction, Falloff falloff) {
  settings.edit = edit;
  settings.handle_fraction = handle_fraction;
  settings.falloff = falloff;
}

EditSettings with_membrane(double membrane) {
  EditSettings edit;
  edit.membrane = membrane;
  return edit;
}

}  // namespace

const std::vector<Preset>& presets() {
  static const std::vector<Preset> list = {
      {"General", "Suits most surfaces.",
       [](DragSettings& s) { set(s, EditSettings(), DragSettings().handle_fraction, Falloff::Even); }},
      {"Limb", "Arms, legs, tails and horns: a larger handle, less stretch, the limb bends and keeps its thickness.",
       [](DragSettings& s) { set(s, with_membrane(1000), 0.25, Falloff::Even); }},
      {"Face", "Noses, lips, ears and cheeks: a soft disc that fades out smoothly.",
       [](DragSettings& s) { set(s, with_membrane(200), 0.25, Falloff::Smooth); }},
      {"Terrain", "Hills and height fields: details stay upright, since they are not rotated.",
       [](DragSettings& s) {
         EditSettings edit = EditSettings::of(EditMethod::Linear);
         edit.laplacian = LaplacianKind::MeanValue;
         edit.handle_weight = edit.anchor_weight = 30;
         set(s, edit, 0.25, Falloff::Smooth);
       }},
      {"Sharp", "Machined parts and letters: a small handle, edges and corners keep their shape.",
       [](DragSettings& s) { set(s, with_membrane(1000), 0.1, Falloff::Even); }},
  };
  return list;
}

int preset_of(const DragSettings& settings) {
  for (std::size_t i = 0; i < presets().size(); ++i) {
    DragSettings set = settings;
    presets()[i].set(set);
    if (set.edit == settings.edit && set.handle_fraction == settings.handle_fraction &&
        set.falloff == settings.falloff) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace lapedit
