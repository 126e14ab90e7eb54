// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/interfaces.h>

/// MeshLab 2020.09's kinds of parameters and values.
namespace lapedit::host {

using PointParameter = RichPoint3f;
using LengthParameter = RichAbsPerc;

inline bool is_point(const Value& value) {
  return value.isPoint3f();
}
inline Point3m point_of(const Value& value) {
  return Point3m::Construct(value.getPoint3f());
}
inline QString type_of(const Value& value) {
  return value.typeName();
}

}  // namespace lapedit::host
