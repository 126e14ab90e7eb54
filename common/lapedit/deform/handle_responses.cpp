// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_responses.h"

#include <algorithm>

namespace lapedit {
namespace {

/// Calls body(first, count) for the columns of a matrix, three at a time, as solutions take them.
template <class Body>
void by_threes(Eigen::Index columns, const Body& body) {
  for (Eigen::Index first = 0; first < columns; first += 3) {
    body(first, std::min<Eigen::Index>(3, columns - first));
  }
}

}  // namespace

void HandleResponses::list() {
  const std::vector<int>& group = system_.region.group;
  const int groups = 1 + *std::max_element(group.begin(), group.end());
  std::vector<int> sizes(groups, 0), member(groups, -1);
  for (int i = 0; i < system_.region.size(); ++i) {
    if (group[i] >= 0) {
      ++sizes[group[i]];
      member[group[i]] = i;
    }
  }
  for (int g = 0; g < groups; ++g) {
    for (int column = sizes[g] > 1 ? 0 : 3; column < 4; ++column) {
      responses_.push_back({g, column, sizes[g] > 1 ? -1 : member[g]});
    }
  }
}

/// What the handles move for a unit of each response.
Eigen::MatrixXd HandleResponses::unit_motions() const {
  const int n = system_.region.size();
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(responses_.size()));
  for (std::size_t r = 0; r < responses_.size(); ++r) {
    for (int i = 0; i < n; ++i) {
      if (system_.region.group[i] == responses_[r].group) {
        moved(i, static_cast<Eigen::Index>(r)) =
            responses_[r].column < 3 ? system_.rest.local(i, responses_[r].column) : 1;
      }
    }
  }
  return moved;
}

/// What all vertices move for them by the fall-off.
Eigen::MatrixXd HandleResponses::fallen_off() const {
  Eigen::MatrixXd moved(system_.region.size(), static_cast<Eigen::Index>(responses_.size()));
  for (std::size_t r = 0; r < responses_.size(); ++r) {
    auto column = moved.col(static_cast<Eigen::Index>(r));
    column = system_.falloff.weights.col(responses_[r].group);
    if (responses_[r].column < 3) {
      column.array() *= system_.rest.local.col(responses_[r].column).array();
    }
  }
  return moved;
}

/// u = A^-1 W^2 moved; for handles that the factor does not know that is Z K moved_h, without a solution.
Eigen::MatrixXd HandleResponses::solve_for(const Eigen::MatrixXd& moved, RefinedSolver& solver) const {
  Eigen::MatrixXd found(moved.rows(), moved.cols());
  if (system_.correction) {
    const WoodburyCorrection& correction = *system_.correction;
    Eigen::MatrixXd at(static_cast<Eigen::Index>(correction.rows.size()), moved.cols());
    for (Eigen::Index c = 0; c < at.rows(); ++c) {
      at.row(c) = moved.row(correction.rows[c]);
    }
    found.noalias() = correction.z * (correction.k * at).eval();
    return found;
  }
  Points right, x;
  by_threes(moved.cols(), [&](Eigen::Index first, Eigen::Index columns) {
    right.setZero(moved.rows(), 3);
    right.leftCols(columns) = system_.squared_weights.asDiagonal() * moved.middleCols(first, columns);
    solver.refine_to(right, x, kAccurate);
    found.middleCols(first, columns) = x.leftCols(columns);
  });
  return found;
}

std::unique_ptr<HandleResponses> HandleResponses::make(const LaplacianSystem& system, RefinedSolver& solver) {
  std::unique_ptr<HandleResponses> made(new HandleResponses(system));
  made->list();
  if (made->responses_.size() > DragPreview::kMostResponses) {
    return nullptr;
  }
  const Eigen::MatrixXd found = made->solve_for(made->unit_motions(), solver);
  Eigen::MatrixXd smooth_found;
  PreviewBase parts;
  parts.region = &system.region;
  parts.world = &system.rest.world;
  parts.delta = &system.delta;
  parts.first = system.powers.first.get();
  parts.correction = system.correction.get();
  parts.blended = system.blended.get();
  parts.turns_edges = system.settings.turning == DetailTurning::Edge;
  if (system.settings.rotation == DetailRotation::SmoothSurface) {
    parts.smooth_rest = &system.smooth_rest;
    const Eigen::MatrixXd rough = system.falloff.empty() ? found : made->fallen_off();
    smooth_found.resize(found.rows(), found.cols());
    const auto smoother = system.smoother->share(system.pool);
    Points in, out;
    by_threes(found.cols(), [&](Eigen::Index first, Eigen::Index columns) {
      in.setZero(found.rows(), 3);
      in.leftCols(columns) = rough.middleCols(first, columns);
      smoother->apply_for_preview(in, out);
      smooth_found.middleCols(first, columns) = out.leftCols(columns);
    });
  }
  made->preview_ = std::make_unique<DragPreview>(parts, found, smooth_found, solver.cholesky(), system.pool);
  made->motions_.setZero(found.cols(), 3);
  return made;
}

const Points& HandleResponses::pose(const std::vector<HandleMotion>& handles) {
  paths_.set(handles);
  for (std::size_t r = 0; r < responses_.size(); ++r) {
    const Response& response = responses_[r];
    const LocalMotion& motion = paths_.motions()[response.group];
    motions_.row(static_cast<Eigen::Index>(r)) =
        (response.vertex >= 0  ? motion.displacement(system_.rest.local.row(response.vertex).transpose())
         : response.column < 3 ? Vector3(motion.linear.col(response.column))
                               : motion.translation)
            .transpose();
  }
  if (system_.blended) {
    system_.blended->cells().solve(paths_, false);
  }
  return preview_->pose(motions_, system_.blended.get());
}

}  // namespace lapedit
