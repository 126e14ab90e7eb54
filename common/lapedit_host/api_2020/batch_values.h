// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "batch_plugins.h"

/// MeshLab 2020.09's values of parameters, as far as others have them otherwise. Only the program uses them, see
/// batch_plugins.h.
namespace lapedit::host {

using ChoiceValue = EnumValue;
using LengthValue = AbsPercValue;
using MatrixValue = Matrix44fValue;
using PathValue = FileValue;
using PointValue = Point3fValue;
using SliderValue = DynamicFloatValue;

/// @param number  place in the list of layers. @return null if there is no such layer
inline std::unique_ptr<Value> layer_value(MeshDocument& document, int number) {
  if (number < 0 || number >= document.meshList.size()) {
    return nullptr;
  }
  return std::make_unique<MeshValue>(&document, number);
}

}  // namespace lapedit::host
