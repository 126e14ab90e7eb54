// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lapedit/session/selection.h"

namespace lapedit {

/// What undo takes back at a time.
struct Action {
  enum class Kind {
    Stroke,   ///< of the brush
    Step,     ///< of the history
    Settings  ///< other settings, with which the last step was solved again
  };
  Kind kind;
  std::string name;                           ///< for a list
  std::optional<Selection> selection = {};    ///< on the other side of it; empty for steps of a saved edit
  std::optional<DragSettings> settings = {};  ///< Kind::Settings: those on the other side
  std::optional<AppliedStep> replaced = {};   ///< Kind::Settings: the step on the other side
};

/// All that was done, in order.
class Timeline {
 public:
  const std::vector<Action>& done() const { return done_; }      ///< the oldest first
  const std::vector<Action>& undone() const { return undone_; }  ///< the one that redo() takes last
  /// Adds an action; what was undone is gone. Settings that change again what the last action changed join it.
  void add(Action action, const DragSettings& now);
  /// Moves the last action of one list to the other. There has to be one. @return it, to be turned round by the caller
  Action& undo();
  Action& redo();
  int serial() const { return serial_; }  ///< counts the changes of both lists

 private:
  std::vector<Action> done_, undone_;
  int serial_ = 0;
};

}  // namespace lapedit
