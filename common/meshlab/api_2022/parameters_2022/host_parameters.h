// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/parameters/rich_parameter_list.h>

/// MeshLab 2022.02's kinds of parameters and values.
namespace lapedit::host {

using PointParameter = RichPosition;
using LengthParameter = RichAbsPerc;

inline bool is_point(const Value& value) {
  return value.isPoint3f();
}
inline Point3m point_of(const Value& value) {
  return value.getPoint3f();
}
inline QString type_of(const Value& value) {
  return value.typeName();
}

}  // namespace lapedit::host
