// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/mesh/vertex_tree.h"

/// Coordinate systems of landmarks and meshes, as 3D Slicer names them: "RAS" and "LPS", whose x and y have opposite
/// signs. Other names are kept, but not converted; an empty name stands for an unknown system.
namespace lapedit {

/// Returns the coordinate system that the header of a mesh file names with "SPACE=", as 3D Slicer writes it into the
/// comments of PLY and OBJ and into the label of STL: in upper case, "RAS" or "LPS"; empty if it names none.
/// @param bytes  of the file, or its first 64 KiB
std::string space_in_header(const std::string& bytes);

/// @throws EditError (BadParameter) for a name other than "RAS", "LPS" and the empty one
void require_known_space(const std::string& space);

/// Converts points from one coordinate system to another; does nothing if either is unknown. @return whether the points
/// have changed
/// @throws EditError (BadParameter) for a system that cannot be converted
bool convert(std::vector<Vector3>& points, const std::string& from, const std::string& to);

/// Returns the diagonal of the box around points.
double extent_of(const std::vector<Vector3>& points);

/// Explains why points are far from the surface: finds the unit or the coordinate system with which all are near it.
/// @param space    of the points
/// @param far      smallest distance from the surface, over its diagonal, that counts as far
/// @param extent   size of the points' box that is expected at least; 0: unknown
/// @return a phrase such as "check the unit, since ..."; empty if there is no such unit or system
std::string likely_mistake(const VertexFinder& finder, const std::vector<Vector3>& points, const std::string& space,
                           double far, double extent = 0);

}  // namespace lapedit
