// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_frame.h"

#include <cmath>

#include "lapedit/base/simd.h"

namespace lapedit {
namespace {

using Transform = CellModel::Transform;

constexpr int kGrain = 1024;

float dot(Floats4 a, Floats4 b) {
  const Floats4 products = a * b;
  return products[0] + products[1] + products[2];
}

/// Computes y_i = sum_j -M_ij (((T_i + T_j) / 2 - I)(p_i - p_j) - (d_i - d_j)): the rotated edges minus the current
/// ones. M is the differential operator, whose off-diagonal entries are at most 0.
struct EdgeResidual {
  const OperatorRows::Rows& m;
  const Transform* transforms;
  const double* displacement;  // at() also reads one number past the last row
  double* out;

  static LAPEDIT_INLINE Floats4 rotated(const Transform& by, Floats4 edge) {
    return edge[0] * by.columns[0] + edge[1] * by.columns[1] + edge[2] * by.columns[2];
  }
  LAPEDIT_INLINE Doubles4 at(int vertex) const { return load<Doubles4>(displacement + 3 * std::ptrdiff_t{vertex}); }

  LAPEDIT_INLINE void operator()(int i) const {
    const Transform& here = transforms[i];
    Floats4 coordinate = {}, others = {};
    Doubles4 current = {};
    const Doubles4 moved = at(i);
    for (int k = m.outerIndexPtr()[i]; k < m.outerIndexPtr()[i + 1]; ++k) {
      const int j = m.innerIndexPtr()[k];
      const double entry = m.valuePtr()[k];
      const Floats4 edge = static_cast<float>(entry) * (transforms[j].rest - here.rest);
      coordinate += edge;
      others += rotated(transforms[j], edge);
      current += entry * (at(j) - moved);
    }
    const Floats4 wanted = 0.5F * (rotated(here, coordinate) + others);
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      out[3 * std::ptrdiff_t{i} + e] = static_cast<double>(wanted[e]) - current[e];
    }
  }
};

}  // namespace

StepSolver::Frame::Frame(const RestPose& rest, int threads)
    : pool(threads),
      unit(rest.region->max_distance > 0 ? std::ldexp(1.0, std::ilogb(rest.region->max_distance)) : 1),
      transforms(new Transform[rest.region->size()]),
      displacement(rest.region->size() + 1, 3) {
  for_indices(pool, rest.region->size(), kGrain, [&](int i) {
    transforms[i] = {{}, floats4(rest.local.row(i) / unit)};
  });
  displacement.row(rest.region->size()).setZero();
}

StepSolver::Frame& StepSolver::started_frame() {
  if (!frame_) {
    frame_ = std::make_unique<Frame>(*rest_, options_.solver.threads);
  }
  Frame& f = *frame_;
  if (system_ && f.edges.rows() == 0) {
    f.edges.resize(region().size(), 3);
    f.residual.resize(region().size(), 3);
    for (int i = 0; i < region().size(); ++i) {
      if (system_->squared_weights[i] > 0) {
        f.constrained.push_back(i);
      }
    }
  }
  return f;
}

/// Computes a frame from the pose of the cells, corrected by one solve if there is a system.
void StepSolver::show_cells(bool quick, Points& positions) {
  Frame& f = started_frame();
  cells_->displace(f.unit, f.transforms.get(), f.displacement, system_ ? *system_->pool : f.pool);
  f.passes = 0;
  f.is_quick = quick;
  if (system_) {
    correct_frame(positions);
  } else {
    collect_frame(nullptr, positions);
  }
}

/// Returns the rows of edges, followed by those of links if there are any.
const Points& StepSolver::add_links() {
  Frame& f = *frame_;
  const Eigen::VectorXd& strengths = system_->powers.links;
  if (strengths.size() == 0) {
    return f.edges;
  }
  const Eigen::Index n = region().size();
  f.with_links.resize(n + strengths.size(), 3);
  f.with_links.topRows(n) = f.edges;
  for (Eigen::Index k = 0; k < strengths.size(); ++k) {
    const auto [a, b] = region().links[static_cast<std::size_t>(k)];
    const Floats4 edge = f.transforms[a].rest - f.transforms[b].rest;
    Floats4 turned =
        2.0F * edge + EdgeResidual::rotated(f.transforms[a], edge) + EdgeResidual::rotated(f.transforms[b], edge);
    const float squared = dot(turned, turned);
    turned *= squared > 0 ? std::sqrt(dot(edge, edge) / squared) : 0;
    for (int e = 0; e < 3; ++e) {
      f.with_links(n + k, e) =
          strengths[k] * (static_cast<double>(turned[e] - edge[e]) - (f.displacement(a, e) - f.displacement(b, e)));
    }
  }
  return f.with_links;
}

/// Adds A^-1 (b(R) - A x0) to the displacement and updates the positions. A is the symmetric positive definite matrix
/// of LaplacianSystem.
void StepSolver::correct_frame(Points& positions) {
  Frame& f = *frame_;
  const LaplacianSystem& system = *system_;
  const EdgeResidual residual = {system.powers.first->rows(), f.transforms.get(), f.displacement.data(),
                                 f.edges.data()};
  in_pieces(*system.pool, region().size(), kGrain, [&](int first, int last) { run_kernel(residual, first, last); });
  for (int k = 1; k < settings_.order; ++k) {
    system.powers.first->apply(f.edges, f.product, *system.pool);
    f.edges.swap(f.product);
  }
  system.powers.m->apply_transposed(add_links(), f.residual, *system.pool);
  for_indices(*system.pool, static_cast<int>(f.constrained.size()), kGrain, [&](int k) {
    const int i = f.constrained[k];
    const GroupPaths& paths = cells_->paths();
    const Vector3 wanted =
        region().classes[i] == VertexClass::Handle
            ? paths.displacement(i)
            : paths.rigid_motions()[region().component[i]].displacement(rest_->local.row(i).transpose());
    f.residual.row(i) += system.squared_weights[i] * (wanted.transpose() / f.unit - f.displacement.row(i));
  });
  solver_->solve(f.residual, f.edges);
  ++f.passes;
  collect_frame(&f.edges, positions);
}

/// Adds a step to the displacement and writes the positions. One sweep does both, since memory limits its speed.
void StepSolver::collect_frame(const Points* step, Points& positions) {
  Frame& f = *frame_;
  positions.resize(region().size(), 3);
  in_pieces(system_ ? *system_->pool : f.pool, region().size(), kGrain, [&](int first, int last) {
    const int rows = last - first;
    auto moved = f.displacement.middleRows(first, rows);
    if (step != nullptr) {
      moved += step->middleRows(first, rows);
    }
    positions.middleRows(first, rows) = rest_->world.middleRows(first, rows) + f.unit * moved;
  });
  finish(positions);
}

/// Fits rotations of the one-rings relative to the components' rigid motions, as pose() does.
void StepSolver::fit_frame() {
  Frame& f = *frame_;
  const GroupPaths& paths = cells_->paths();
  const int n = region().size();
  const bool rigid = paths.moves_rigidly();
  f.relative = f.unit * f.displacement.topRows(n);
  if (rigid) {
    f.before = rest_->local;
  }
  for (int i = 0; rigid && i < n; ++i) {
    const Vector3 moved = paths.rigid_motions()[region().component[i]].displacement(rest_->local.row(i).transpose());
    f.before.row(i) += moved.transpose();
    f.relative.row(i) -= moved.transpose();
  }
  cells_->fit(*system_, rigid ? f.before : rest_->local, f.ahead(f.relative, f.passes - 1), f.rotations);
  for (int i = 0; i < n; ++i) {
    const Matrix3& linear = paths.rigid_motions()[region().component[i]].linear;
    const Matrix3 rotation = f.rotations[i] - Matrix3::Identity();
    const Matrix3 whole = rotation + rotation * linear + linear;
    for (int k = 0; k < 3; ++k) {
      for (int e = 0; e < 3; ++e) {
        f.transforms[i].columns[k][e] = static_cast<float>(whole(e, k));
      }
    }
  }
}

void StepSolver::frame(const std::vector<HandleMotion>& handles, Points& positions) {
  cells_->solve(handles, Affine::Identity(), true);
  show_cells(true, positions);
}

bool StepSolver::refine(Points& positions) {
  if (!system_ || !has_frames() || !frame_) {
    return false;
  }
  const bool has_solve = frame_->passes > 0;
  const bool is_default = settings_.method == EditMethod::Default;
  if (!has_solve || (is_default && frame_->is_quick)) {
    cells_->solve(!has_solve);
    show_cells(!has_solve, positions);
    return true;
  }
  if (!is_default || frame_->passes >= settings_.passes()) {
    return false;
  }
  fit_frame();
  correct_frame(positions);
  return true;
}

}  // namespace lapedit
