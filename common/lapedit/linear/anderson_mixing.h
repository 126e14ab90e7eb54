// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/types.h"

namespace lapedit {

/// Finds fixed points x = G(x) in fewer steps than x <- G(x) takes: the next x is the combination of the last few that
/// would leave the least of G(x) - x, were G linear. Sums are taken in a fixed order, so that the bits are the same
/// everywhere. Source: D. Anderson, JACM 1965; for local-global solvers Y. Peng et al., SIGGRAPH 2018.
class AndersonMixing {
 public:
  explicit AndersonMixing(int window) : window_(window) {}

  void restart() { count_ = 0; }
  /// @param x  where G was asked; out: where to ask next. @param g  G(x); out: scratch. Nothing is allocated after the
  /// first call
  void step(Points& x, Points& g);

 private:
  int window_;
  int count_ = 0;  // steps since the restart
  double last_left_ = 0;
  Points last_g_, last_left_over_;
  std::vector<Points> g_steps_, left_steps_;
};

}  // namespace lapedit
