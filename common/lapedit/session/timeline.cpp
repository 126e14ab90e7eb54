// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/timeline.h"

#include <utility>

namespace lapedit {
namespace {

/// Returns for each setting whether its values differ.
std::vector<bool> differences(const DragSettings& a, const DragSettings& b) {
  std::vector<bool> list = {
      a.radius != b.radius,     a.padding != b.padding,         a.handle_fraction != b.handle_fraction,
      a.softness != b.softness, a.connect_gap != b.connect_gap, a.brush_pixels != b.brush_pixels};
  for (const Setting& setting : settings_table()) {
    list.push_back(setting.get(a.edit) != setting.get(b.edit));
  }
  return list;
}

Action& move_last(std::vector<Action>& from, std::vector<Action>& to) {
  to.push_back(std::move(from.back()));
  from.pop_back();
  return to.back();
}

}  // namespace

void Timeline::add(Action action, const DragSettings& now) {
  // A dragged slider sends many changes: they become one action.
  const Action* const last = done_.empty() ? nullptr : &done_.back();
  const bool joins = undone_.empty() && last && last->settings && action.settings &&
                     differences(*last->settings, *action.settings) == differences(*action.settings, now);
  undone_.clear();
  ++serial_;
  if (!joins) {
    done_.push_back(std::move(action));
  }
}

Action& Timeline::undo() {
  ++serial_;
  return move_last(done_, undone_);
}

Action& Timeline::redo() {
  ++serial_;
  return move_last(undone_, done_);
}

}  // namespace lapedit
