// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace lapedit {

/// Constants of a fit. Internal and not selectable by users.
constexpr struct {
  double first_length = 0.4;        ///< over the template's size
  double unmatched_weight = 0.001;  ///< of a vertex without a partner, so that it keeps its position
  double landmark_weight = 80;      ///< times l^2 over the mean vertex area
  double accuracy = 0.005;          ///< of landmarks over the scan's size
  double trust = 2.5e-5;            ///< times (l / accuracy)^2, at most 1: factor of the landmarks' weight
  double momentum = 0.8;            ///< of a step in the next one (B. Polyak 1964): slow modes converge sooner
  double per_length = 2.5;          ///< vertices and samples that a stage has along its length, of those that there are
  int rounds = 9;                   ///< of a stage
  double average = 0.15;            ///< length of the averages of rotations over the template's size
  /// Weight of the aligned template in the similarity that the shape may undergo for nothing: without it surfaces that
  /// may slide along themselves, as a dome, drift.
  double hold = 0.3;
  double membrane = 2;           ///< stretching against bending at wavelengths of the template's size
  double tangential = 0.2;       ///< of a displacement along the surface, which only landmarks decide
  double times = 5, most = 0.7;  ///< pairs count fully up to `times` the quantile `most` of distances
  double cosine = 0.5;           ///< of the largest angle between normals
} kFit = {};

}  // namespace lapedit
