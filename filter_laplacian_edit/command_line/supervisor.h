// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "failure.h"

/// What the work lets its supervisor know. Written by one process, read by another, even after the first has died.
class Notes {
 public:
  /// @param activity  as in "reading mesh.ply"
  /// @param code      what the program ends with if this stops it
  void doing(const std::string& activity, ExitCode code);
  /// A folder that has to be gone in the end.
  void scratch(const std::string& folder);

 private:
  friend int supervise(const std::function<int(Notes&)>& work);

  char activity_[1024];
  char scratch_[4096];
  int code_;
};

/// Does the work in a process of its own. The host stops at assertions for files that it does not understand; whoever
/// calls this program gets a sentence, an exit code and no rubbish then, as when it is interrupted.
/// To be called before there are threads. @return the exit code
int supervise(const std::function<int(Notes&)>& work);
