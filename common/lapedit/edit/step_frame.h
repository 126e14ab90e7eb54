// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/edit/step_solver.h"

namespace lapedit {

/// Scratch memory of frames.
struct StepSolver::Frame {
  ThreadPool pool;  ///< used until there is a system; the thread that makes the system uses the pool of that system
  double unit;      ///< length unit of displacements and of coordinates in single precision
  std::unique_ptr<CellModel::Transform[]> transforms;
  Points displacement;    ///< from the rest pose, in units; the last row is padding
  int passes = 0;         ///< solves in the last frame
  bool is_quick = false;  ///< whether its cells were posed with few passes

  // For the solve.
  std::vector<int> constrained;  ///< vertices with a weight
  Points edges, product, with_links, residual;
  // For further passes.
  Points before, relative;  ///< rigidly moved pose, and displacement from it
  std::vector<Matrix3> rotations;
  Extrapolation ahead;

  Frame(const RestPose& rest, int threads);
};

}  // namespace lapedit
