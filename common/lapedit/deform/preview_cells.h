// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/blended_rotations.h"
#include "lapedit/deform/preview_tables.h"

namespace lapedit::preview {

/// Of a place: which cells it follows, how much, and how far its rotation is held back.
struct Follow {
  int cells[CellBlend::kReach];
  float weights[CellBlend::kReach];
  float hold;
};

/// What a frame of DragPreview has for DetailRotation::LocalGlobal in place of the smoothed surface: rotations of
/// cells, blended onto the vertices and turning their edges, in single precision.
class CellTurns {
 public:
  /// @param tables  must outlive the object
  CellTurns(const BlendedRotations& blended, const OperatorRows& first, bool by_edges, const Tables& tables);

  /// y_i = sum_j -M_ij ((R_i + R_j) / 2 - I) (p_i - p_j), or with R_i alone, in units of the tables.
  /// @param y  out: by place. Nothing is allocated after the first call
  void turn(const BlendedRotations& blended, Four* y, ThreadPool& pool);

  std::size_t bytes() const;

 private:
  const Tables& tables_;
  bool by_edges_;
  std::vector<Follow> follow_;
  std::vector<float> rows_;  // M_ij, as the tables' neighbours
  std::vector<Line> turns_;  // of a place: the columns of R - I, and p
  std::vector<Four> cells_;  // quaternions of a frame
  std::vector<Eigen::Vector4d> quaternions_;
};

}  // namespace lapedit::preview
