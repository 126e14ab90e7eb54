// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/session/background_task.h"
#include "lapedit/session/snap.h"
#include "lapedit_host/tool/host_view.h"

/// The surfaces of the other visible layers, to snap to. Another thread builds their search trees.
class OtherLayers {
 public:
  /// @param wake  called, on any thread, when targets() may have changed
  explicit OtherLayers(const std::function<void()>& wake) : building_(wake) {}

  /// Reads the layers if their numbers of vertices or transforms have changed. It need not compare positions, since a
  /// filter that changes vertices ends the tool. O(layers), and O(vertices + faces) after a change.
  /// @throws std::runtime_error once, if the surfaces could not be had: then there are none, until the layers change
  void read(const std::vector<lapedit::host::Layer>& layers, int edited);
  /// Returns the surfaces; null until they are ready.
  const std::shared_ptr<const lapedit::SnapTargets>& targets() const { return targets_; }
  bool busy() const { return building_.busy(); }
  void forget();

 private:
  [[noreturn]] void fail(const std::string& sentence);

  std::vector<double> fingerprint_;
  std::shared_ptr<const lapedit::SnapTargets> targets_;
  lapedit::BackgroundTask<std::shared_ptr<const lapedit::SnapTargets>> building_;
};
