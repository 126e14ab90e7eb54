// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/live/drag_frames.h"

#include <cmath>
#include <utility>

#include "lapedit/base/simd.h"
#include "lapedit/deform/ring_rotations.h"

namespace lapedit {
namespace {

using Turn = CellModel::Turn;

constexpr int kGrain = 1024;

/// y_i = sum_j -M_ij (((T_i + T_j) / 2 - I)(p_i - p_j) - (d_i - d_j)), or with T_i alone: the rotated edges minus their
/// current state.
struct EdgeResidual {
  const OperatorRows::Rows& m;
  const Turn* turns;
  const double* displacement;  // readable for one number more
  bool by_edges;
  double* out;

  static LAPEDIT_INLINE Floats4 turned(const Turn& turn, Floats4 edge) {
    return edge[0] * turn.columns[0] + edge[1] * turn.columns[1] + edge[2] * turn.columns[2];
  }
  LAPEDIT_INLINE Doubles4 at(int vertex) const { return load<Doubles4>(displacement + 3 * std::ptrdiff_t{vertex}); }

  LAPEDIT_INLINE void operator()(int i) const {
    const Turn& own = turns[i];
    Floats4 coordinate = {}, others = {};
    Doubles4 way = {};
    const Doubles4 here = at(i);
    for (int k = m.outerIndexPtr()[i]; k < m.outerIndexPtr()[i + 1]; ++k) {
      const int j = m.innerIndexPtr()[k];
      const double entry = m.valuePtr()[k];
      const Floats4 edge = static_cast<float>(entry) * (turns[j].rest - own.rest);
      coordinate += edge;
      others += turned(turns[j], edge);
      way += entry * (at(j) - here);
    }
    const Floats4 whole = turned(own, coordinate);
    const Floats4 wanted = by_edges ? 0.5F * (whole + others) : whole;
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      out[3 * std::ptrdiff_t{i} + e] = static_cast<double>(wanted[e]) - way[e];
    }
  }
};

/// Data of the correction.
struct Correction {
  const LaplacianSystem& system;
  RefinedSolver& solver;
  RingRotations rings;
  std::vector<int> held;  // vertices with a weight
  std::vector<Matrix3> rotations;
  Points edges, between, residual, before, previous, ahead;

  explicit Correction(const LaplacianEditor& editor)
      : system(editor.system()),
        solver(editor.solver()),
        rings(system.region, *system.powers.first, *system.pool),
        edges(system.region.size(), 3),
        residual(system.region.size(), 3) {
    for (int i = 0; i < system.region.size(); ++i) {
      if (system.squared_weights[i] > 0) {
        held.push_back(i);
      }
    }
  }
};

}  // namespace

struct DragFrames::Impl {
  EditSettings settings;
  ThreadPool pool;
  std::shared_ptr<CellModel> cells;
  std::unique_ptr<Correction> correction;
  double unit;  // of lengths in single precision, and of displacements
  std::unique_ptr<Turn[]> turns;
  Points displacement;  // with one more row
  Points positions;
  int passes = 0;         // of the last pose
  bool is_quick = false;  // its cells

  Impl(std::shared_ptr<CellModel> made, const EditSettings& given)
      : settings(given),
        pool(given.threads),
        cells(std::move(made)),
        unit(rest().region->max_distance > 0 ? std::ldexp(1.0, std::ilogb(rest().region->max_distance)) : 1),
        turns(new Turn[rest().region->size()]),
        displacement(rest().region->size() + 1, 3),
        positions(rest().region->size(), 3) {
    for_indices(pool, rest().region->size(), kGrain, [this](int i) {
      turns[i] = {{}, floats4(rest().local.row(i) / unit)};
    });
    displacement.row(positions.rows()).setZero();
  }
  const RestPose& rest() const { return *cells->rest(); }

  void start(bool quick);
  void turn_rings();
  void correct();
  void collect(ThreadPool& on, const Points* step);
};

/// displacement += A^-1 (b(R) - A x0), and positions with it
void DragFrames::Impl::correct() {
  Correction& c = *correction;
  const LaplacianSystem& system = c.system;
  const EdgeResidual residual = {system.powers.first->rows(), turns.get(), displacement.data(),
                                 settings.turning == DetailTurning::Edge, c.edges.data()};
  in_pieces(*system.pool, system.region.size(), kGrain,
            [&](int first, int last) { run_kernel(residual, first, last); });
  for (int k = 1; k < settings.order; ++k) {
    system.powers.first->apply(c.edges, c.between, *system.pool);
    c.edges.swap(c.between);
  }
  system.powers.m->apply_transposed(c.edges, c.residual, *system.pool);
  for_indices(*system.pool, static_cast<int>(c.held.size()), kGrain, [&](int k) {
    const int i = c.held[k];
    const Vector3 wanted =
        system.region.classes[i] == VertexClass::Handle
            ? cells->paths().displacement(i)
            : cells->paths().carried()[system.region.component[i]].displacement(system.rest.local.row(i).transpose());
    c.residual.row(i) += system.squared_weights[i] * (wanted.transpose() / unit - displacement.row(i));
  });
  Points& step = c.edges;  // no longer needed
  c.solver.solve(c.residual, step);
  ++passes;
  collect(*system.pool, &step);
}

/// Adds a step and takes the pose over, in one sweep, since that reads and writes much memory.
void DragFrames::Impl::collect(ThreadPool& on, const Points* step) {
  in_pieces(on, static_cast<int>(positions.rows()), kGrain, [&](int first, int last) {
    const int rows = last - first;
    auto moved = displacement.middleRows(first, rows);
    if (step != nullptr) {
      moved += step->middleRows(first, rows);
    }
    positions.middleRows(first, rows) = rest().world.middleRows(first, rows) + unit * moved;
  });
  require_finite_result(positions);
}

DragFrames::DragFrames(const TriangleMesh& mesh, std::shared_ptr<const Region> region, const EditSettings& settings,
                       const Progress& progress) {
  validate(settings);
  impl_ = std::make_unique<Impl>(
      std::make_shared<CellModel>(mesh, std::make_shared<const RestPose>(mesh, std::move(region)), settings, progress),
      settings);
}
DragFrames::DragFrames(std::shared_ptr<CellModel> cells, const EditSettings& settings)
    : impl_(std::make_unique<Impl>(std::move(cells), settings)) {}
DragFrames::~DragFrames() = default;

const std::shared_ptr<CellModel>& DragFrames::cells() const {
  return impl_->cells;
}

bool DragFrames::has_frames(const EditSettings& settings) {
  return settings.rotation == DetailRotation::None || settings.rotation == DetailRotation::LocalGlobal;
}

void DragFrames::correct_with(const LaplacianEditor* editor) {
  impl_->correction.reset();
  if (editor != nullptr && has_frames(impl_->settings)) {
    impl_->correction = std::make_unique<Correction>(*editor);
  }
}

/// Computes the cells' pose and, if there is a factor, its correction.
void DragFrames::Impl::start(bool quick) {
  ThreadPool& used = correction ? *correction->system.pool : pool;
  cells->place(unit, turns.get(), displacement, used);
  passes = 0;
  is_quick = quick;
  if (correction) {
    correct();
  } else {
    collect(used, nullptr);
  }
}

/// Fits rotations of the one-rings to an extrapolated pose, relative to the components' rigid motions, as the editor
/// does.
void DragFrames::Impl::turn_rings() {
  Correction& c = *correction;
  const Region& region = *rest().region;
  const GroupPaths& paths = cells->paths();
  const auto n = positions.rows();
  c.ahead = displacement.topRows(n);
  if (passes > 1) {
    c.ahead += kMomentum * (displacement.topRows(n) - c.previous);
  }
  c.previous = displacement.topRows(n);
  c.ahead *= unit;
  const bool carries = paths.carries();
  if (carries) {
    c.before = rest().local;
  }
  for (Eigen::Index i = 0; carries && i < n; ++i) {
    const Vector3 way = paths.carried()[region.component[i]].displacement(rest().local.row(i).transpose());
    c.before.row(i) += way.transpose();
    c.ahead.row(i) -= way.transpose();
  }
  c.rings.fit(carries ? c.before : rest().local, c.ahead, c.rotations);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Matrix3& along = paths.carried()[region.component[i]].linear;
    const Matrix3 turn = c.rotations[i] - Matrix3::Identity();
    const Matrix3 whole = turn + turn * along + along;
    for (int k = 0; k < 3; ++k) {
      for (int e = 0; e < 3; ++e) {
        turns[i].columns[k][e] = static_cast<float>(whole(e, k));
      }
    }
  }
}

const Points& DragFrames::pose(const std::vector<HandleMotion>& handles) {
  Impl& s = *impl_;
  s.cells->solve(handles, Affine::Identity(), true);
  s.start(true);
  return s.positions;
}

bool DragFrames::refine() {
  Impl& s = *impl_;
  if (!corrected() || s.settings.rotation != DetailRotation::LocalGlobal) {
    return false;
  }
  if (s.is_quick) {
    s.cells->solve(false);
    s.start(false);
    return true;
  }
  if (s.passes >= s.settings.passes()) {
    return false;
  }
  s.turn_rings();
  s.correct();
  return true;
}

bool DragFrames::corrected() const {
  return impl_->passes > 0;
}

const Points& DragFrames::positions() const {
  return impl_->positions;
}

}  // namespace lapedit
