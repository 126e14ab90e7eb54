// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lapedit/session/selection.h"

namespace lapedit {

/// One action that undo() reverses.
struct Action {
  enum class Kind {
    Stroke,   ///< of the brush
    Step,     ///< of the history
    Settings  ///< changed settings, with which the last step was solved again
  };
  Kind kind;
  std::string name;  ///< for a list
  // The state before the action or, once it is undone, after it.
  std::optional<Selection> selection = {};    ///< empty for steps of a saved edit
  std::optional<DragSettings> settings = {};  ///< Kind::Settings only, like the next
  std::optional<AppliedStep> replaced = {};   ///< the step
};

/// All actions in their order.
class Timeline {
 public:
  const std::vector<Action>& done() const { return done_; }      ///< the oldest first
  const std::vector<Action>& undone() const { return undone_; }  ///< the one that redo() takes last
  /// Adds an action and deletes the undone ones. A change of the same settings as the last action's is merged with it.
  void add(Action action, const DragSettings& now);
  /// Moves the last action of one list, which must not be empty, to the other. @return it; the caller exchanges its
  /// contents with the current state
  Action& undo();
  Action& redo();
  int serial() const { return serial_; }  ///< counts the changes of both lists

 private:
  std::vector<Action> done_, undone_;
  int serial_ = 0;
};

}  // namespace lapedit
