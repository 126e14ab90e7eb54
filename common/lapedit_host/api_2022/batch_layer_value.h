// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "batch_plugins.h"

/// Values of parameters that MeshLab has had alike since 2021. Only the program uses them, see batch_plugins.h.
namespace lapedit::host {

using ChoiceValue = IntValue;
using LengthValue = FloatValue;
using PathValue = StringValue;
using SliderValue = FloatValue;

/// @param number  the layer's. @return null if there is no such layer
inline std::unique_ptr<Value> layer_value(MeshDocument& document, int number) {
  if (number < 0 || document.getMesh(static_cast<unsigned int>(number)) == nullptr) {
    return nullptr;
  }
  return std::make_unique<IntValue>(number);
}

}  // namespace lapedit::host
