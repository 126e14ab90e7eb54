// SPDX-License-Identifier: GPL-3.0-or-later
#include "ours.h"

#include <algorithm>

#include "lapedit/edit/step_solver.h"
#include "lapedit/linear/nested_dissection.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace speed {

using lapedit::Points;
using lapedit::Region;
using lapedit::StepSolver;

namespace {

/// Those that the peers can follow: the umbrella operator without a membrane, one pass; higher orders do not rotate.
lapedit::EditSettings settings(int order) {
  auto result = lapedit::EditSettings::of(order == 1 ? lapedit::EditMethod::Default : lapedit::EditMethod::Linear);
  result.laplacian = lapedit::LaplacianKind::Umbrella;
  result.iterations = order == 1 ? 1 : 0;
  result.membrane = 0;
  result.order = order;
  result.handle_weight = Ours::kHandleWeight;
  result.anchor_weight = Ours::kAnchorWeight;
  return result;
}

std::unique_ptr<StepSolver> solver_of(const Scene& scene, std::shared_ptr<const Region> region, int order,
                                      int threads) {
  lapedit::StepOptions options;
  options.solver.threads = threads;
  return std::make_unique<StepSolver>(scene.mesh, lapedit::FoundRegion{std::move(region)}, settings(order), options);
}

std::shared_ptr<const Region> region_of(const Scene& scene, int threads) {
  return std::make_shared<const Region>(
      lapedit::build_region(scene.mesh, scene.adjacency, scene.spec, scene.handle, threads));
}

}  // namespace

struct Ours::State {
  int order, threads;
  std::unique_ptr<StepSolver> solver = {};
  std::vector<lapedit::HandleMotion> handles = std::vector<lapedit::HandleMotion>(1);
  Points positions = {};

  /// As SolverThread does it.
  void prepare(const Scene& scene, std::shared_ptr<const Region> region) {
    constexpr int kPreviewFrom = 12000;
    auto next = solver_of(scene, std::move(region), order, threads);
    if (next->region().size() >= kPreviewFrom || order > 1) {
      next->make_cells(scene.mesh);
    }
    next->prepare(scene.mesh, {}, solver ? solver->system().get() : nullptr);
    solver = std::move(next);
  }
};

Ours::Ours(const Scene& scene, int order, int threads) : state_(std::make_unique<State>(State{order, threads})) {
  state_->prepare(scene, region_of(scene, threads));
}
Ours::~Ours() = default;

void Ours::frame(const lapedit::Affine& handle) {
  state_->handles[0] = handle;
  state_->solver->frame(state_->handles, state_->positions);
}
const Points& Ours::positions() const {
  return state_->positions;
}
const Points& Ours::exact(const lapedit::Affine& handle) {
  state_->handles[0] = handle;
  return state_->solver->pose(state_->handles);
}
const std::vector<lapedit::Matrix3>& Ours::exact_rotations() const {
  return state_->solver->rotations();
}

void Ours::second_handle(const Scene& scene, const std::vector<int>& vertices) {
  Region region = state_->solver->region();
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == lapedit::VertexClass::Handle) {
      region.classes[i] = lapedit::VertexClass::Free;
      region.group[i] = -1;
    }
    if (std::binary_search(vertices.begin(), vertices.end(), region.mesh_vertex[i])) {
      region.classes[i] = lapedit::VertexClass::Handle;
      region.group[i] = 0;
    }
  }
  state_->prepare(scene, std::make_shared<const Region>(std::move(region)));
}
const Region& Ours::region() const {
  return state_->solver->region();
}

struct OurHand::State {
  std::unique_ptr<StepSolver> solver;
  std::vector<lapedit::HandleMotion> handles = std::vector<lapedit::HandleMotion>(1);
  Points positions = {};
};

OurHand::OurHand(const Scene& scene, int order, int threads)
    : state_(std::make_unique<State>(State{solver_of(scene, region_of(scene, threads), order, threads)})) {
  state_->solver->make_cells(scene.mesh);
}
OurHand::~OurHand() = default;

void OurHand::frame(const lapedit::Affine& handle) {
  state_->handles[0] = handle;
  state_->solver->frame(state_->handles, state_->positions);
}
const Points& OurHand::positions() const {
  return state_->positions;
}
int OurHand::cells() const {
  return state_->solver->cells()->cells().count();
}

struct OurSolver::State {
  lapedit::SparseCholesky cholesky;
};

OurSolver::OurSolver(const Scene& scene, const Sparse& normal, int threads, Precision precision) {
  lapedit::CholeskyOptions options;
  options.single_precision = precision == Precision::Single;
  options.pool = std::make_shared<lapedit::ThreadPool>(threads);
  options.order = lapedit::fill_reducing_ordering(scene.region.neighbours, threads);
  state_.reset(new State{lapedit::SparseCholesky(normal, options)});
}
OurSolver::~OurSolver() = default;

void OurSolver::solve(const Points& rhs, Points& x) {
  state_->cholesky.solve(rhs, x);
}
std::size_t OurSolver::factor_nonzeros() const {
  return state_->cholesky.factor_nonzeros();
}

}  // namespace speed
