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

/// How far faces are stretched, weighted by their areas before, in logarithms of the two principal ratios of lengths.
struct AreaStretch {
  double rms = 0;    ///< of the logarithms
  double shear = 0;  ///< RMS of the logarithm of the larger over the smaller ratio
  double worst = 0;  ///< mean of the larger absolute logarithm over the worst hundredth of the area
};
/// Faces without area before are left out.
AreaStretch area_stretch(const lapedit::Faces& faces, const std::vector<int>& looked_at, const lapedit::Points& before,
                         const lapedit::Points& after);

/// Mean angle in degrees by which details are tilted against the smooth surface below them. A detail is the difference
/// of a vertex from the surface after 20 averagings over neighbours; each weighs its squared length.
double detail_tilt(const lapedit::Adjacency& adjacency, const lapedit::Faces& faces, const std::vector<int>& vertices,
                   const lapedit::Points& before, const lapedit::Points& after);

/// How even a motion is along a straight line, from slices of equal width across it.
struct Evenness {
  double twist =
      0;  ///< largest difference of a slice's rotation against the one before from the mean of these, over it
  double asymmetry = 0;  ///< largest distance of a slice's centroid from the half-turn of its counterpart, over the
                         ///< distance of the first from the last
};
/// @param along  unit vector @param from, to  the part of the line that is looked at
Evenness evenness(const lapedit::Vector3& along, double from, double to, const lapedit::Points& before,
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
