// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lapedit/session/selection.h"

namespace lapedit {

/// One action that undo() reverses: a step of the history, or a stroke of the brush.
struct Action {
  std::string name;  ///< for a list
  bool is_step;
  Selection before;
  Selection after = {};  ///< of a stroke: set when it is undone
};

/// All actions in their order.
class Timeline {
 public:
  const std::vector<Action>& done() const { return done_; }      ///< the oldest first
  const std::vector<Action>& undone() const { return undone_; }  ///< the last one is the next to redo
  /// Adds an action and deletes the undone ones.
  void add(Action action) {
    done_.push_back(std::move(action));
    change_last();
  }
  /// Returns the last action to be changed. There has to be one. Deletes the undone actions, since they followed its
  /// former state.
  Action& change_last() {
    undone_.clear();
    ++serial_;
    return done_.back();
  }
  /// Moves the last action of one list, which must not be empty, to the other. @return it
  Action& undo() { return move_last(done_, undone_); }
  Action& redo() { return move_last(undone_, done_); }
  int serial() const { return serial_; }  ///< counts the changes of both lists

 private:
  Action& move_last(std::vector<Action>& from, std::vector<Action>& to) {
    to.push_back(std::move(from.back()));
    from.pop_back();
    ++serial_;
    return to.back();
  }

  std::vector<Action> done_, undone_;
  int serial_ = 0;
};

}  // namespace lapedit
