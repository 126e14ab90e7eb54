// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_settings.h"

#include <cmath>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"

namespace lapedit {
namespace {

void require(bool holds, const char* setting, double value, const char* range) {
  if (!holds) {
    throw EditError(ErrorCause::BadParameter,
                    std::string("The ") + setting + " is " + number_text(value) + ": give " + range + ".");
  }
}

}  // namespace

void validate(const EditSettings& settings) {
  require(settings.order >= 1 && settings.order <= 3, "order of the Laplacian", settings.order, "1, 2 or 3");
  require(settings.iterations >= 1 && settings.iterations <= 100, "number of iterations", settings.iterations,
          "a whole number from 1 to 100");
  require(settings.normal_radius >= 0 && std::isfinite(settings.normal_radius), "normal radius", settings.normal_radius,
          "a finite length, or 0 for an automatic one");
  for (const auto& [weight, name] :
       {std::pair{settings.handle_weight, "handle weight"}, std::pair{settings.anchor_weight, "anchor weight"}}) {
    require(weight >= 1e-6 && weight <= 1e6, name, weight, "a number from 0.000001 to 1000000");
  }
}

}  // namespace lapedit
