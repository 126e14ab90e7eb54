// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/mesh/region.h"

/// How good an edit's shape is, measured on positions alone, so that every method is measured alike. `before` and
/// `after` are whole meshes of the same faces, n x 3.
namespace quality {

/// Faces with a corner in the region, ascending.
std::vector<int> region_faces(const lapedit::Adjacency& adjacency, const lapedit::Region& region);

/// Faces whose normal turned by more than 90 degrees against their surroundings: the rotation that fits best, from
/// before to after, the vertices and the normals within two rings of each corner, by area; the mean over the three
/// corners. Faces without area before or after are left out.
int flipped_triangles(const lapedit::Adjacency& adjacency, const lapedit::Faces& faces,
                      const std::vector<int>& looked_at, const lapedit::Points& before, const lapedit::Points& after);

/// Mean absolute change, in degrees, of the angle between the normals of neighbouring faces among those looked at, with
/// its sign: positive where the surface is convex. Edges of more than two faces, and at faces without area, are left
/// out.
double dihedral_change(const lapedit::Faces& faces, const std::vector<int>& looked_at, const lapedit::Points& before,
                       const lapedit::Points& after);

/// Change of the volume below some faces over what they enclose before, closed by a fan over their border's centroid;
/// not a number where they are as good as flat.
double volume_change(const lapedit::Faces& faces, const std::vector<int>& looked_at, const lapedit::Points& before,
                     const lapedit::Points& after);

/// Pairs of faces that cut or touch each other elsewhere than in what they share, at least one of each pair among those
/// looked at: decided exactly, by CGAL's predicates. Lower number first, ascending. Faces without area are left out.
std::vector<std::pair<int, int>> intersecting_pairs(const lapedit::Faces& faces, const std::vector<int>& looked_at,
                                                    const lapedit::Points& positions);

/// How many pairs there are after that were not there before.
int new_pairs(const std::vector<std::pair<int, int>>& before, const std::vector<std::pair<int, int>>& after);

}  // namespace quality
