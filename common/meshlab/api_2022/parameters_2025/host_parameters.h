// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/parameters/rich_parameter_list.h>

/// MeshLab 2025.07's kinds of parameters and values.
namespace lapedit::host {

using PointParameter = RichPosition;
using LengthParameter = RichPercentage;

inline bool is_point(const Value& value) {
  return value.isPoint3();
}
inline Point3m point_of(const Value& value) {
  return value.getPoint3();
}

inline QString type_of(const Value& value) {
  return value.isBool()       ? "Bool"
         : value.isInt()      ? "Int"
         : value.isFloat()    ? "Float"
         : value.isString()   ? "String"
         : value.isPoint3()   ? "Point3"
         : value.isMatrix44() ? "Matrix44"
         : value.isShot()     ? "Shot"
         : value.isColor()    ? "Color"
                              : "value of another kind";
}

}  // namespace lapedit::host
