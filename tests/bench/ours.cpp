// SPDX-License-Identifier: GPL-3.0-or-later
#include "ours.h"

#include <algorithm>

#include "lapedit/linear/nested_dissection.h"
#include "lapedit/linear/sparse_cholesky.h"
#include "lapedit/live/drag_frames.h"

namespace speed {

using lapedit::DragFrames;
using lapedit::LaplacianEditor;
using lapedit::Points;
using lapedit::Region;

namespace {

/// Those that the peers can follow: the umbrella operator without a membrane, whole coordinates, one pass.
lapedit::EditSettings settings(int order, int threads) {
  lapedit::EditSettings result;
  result.laplacian = lapedit::LaplacianKind::Umbrella;
  result.iterations = 1;
  result.turning = lapedit::DetailTurning::Vertex;
  result.membrane = 0;
  result.order = order;
  result.threads = threads;
  result.handle_weight = Ours::kHandleWeight;
  result.anchor_weight = Ours::kAnchorWeight;
  return result;
}

}  // namespace

struct Ours::State {
  lapedit::EditSettings settings;
  std::unique_ptr<DragFrames> frames;
  std::unique_ptr<LaplacianEditor> editor;
  std::vector<lapedit::HandleMotion> handles{1};
  const Points* positions = nullptr;

  /// As SolverThread does it.
  void prepare(const Scene& scene, Region region) {
    constexpr int kHandFrom = 12000;
    if (region.size() < kHandFrom) {
      editor = std::make_unique<LaplacianEditor>(scene.mesh, std::move(region), settings, lapedit::Progress(),
                                                 std::move(editor));
      frames = std::make_unique<DragFrames>(editor->cells(), settings);
    } else {
      frames = std::make_unique<DragFrames>(scene.mesh, std::make_shared<const Region>(std::move(region)), settings);
      editor = std::make_unique<LaplacianEditor>(scene.mesh, frames->cells(), settings, lapedit::Progress(),
                                                 std::move(editor));
    }
    frames->correct_with(editor.get());
  }
};

Ours::Ours(const Scene& scene, int order, int threads) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.settings = settings(order, threads);
  s.prepare(scene, lapedit::build_region(scene.mesh, scene.adjacency, scene.spec, scene.handle, threads));
}
Ours::~Ours() = default;

void Ours::frame(const lapedit::Affine& handle) {
  State& s = *state_;
  s.handles[0] = handle;
  s.positions = &s.frames->pose(s.handles);
}
const Points& Ours::positions() const {
  return *state_->positions;
}
const Points& Ours::exact(const lapedit::Affine& handle) {
  state_->handles[0] = handle;
  return state_->editor->solve(state_->handles);
}
const std::vector<lapedit::Matrix3>& Ours::exact_rotations() const {
  return state_->editor->rotations();
}

void Ours::second_handle(const Scene& scene, const std::vector<int>& vertices) {
  State& s = *state_;
  Region region = s.editor->region();
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
  s.prepare(scene, std::move(region));
}
const Region& Ours::region() const {
  return state_->editor->region();
}

struct OurHand::State {
  std::shared_ptr<const Region> region;
  DragFrames frames;
  std::vector<lapedit::HandleMotion> handles{1};
  const Points* positions = nullptr;

  State(const Scene& scene, const lapedit::EditSettings& given)
      : region(std::make_shared<const Region>(
            lapedit::build_region(scene.mesh, scene.adjacency, scene.spec, scene.handle, given.threads))),
        frames(scene.mesh, region, given) {}
};

OurHand::OurHand(const Scene& scene, int order, int threads)
    : state_(std::make_unique<State>(scene, settings(order, threads))) {}
OurHand::~OurHand() = default;

void OurHand::frame(const lapedit::Affine& handle) {
  State& s = *state_;
  s.handles[0] = handle;
  s.positions = &s.frames.pose(s.handles);
}
const Points& OurHand::positions() const {
  return *state_->positions;
}
int OurHand::cells() const {
  return state_->frames.cells()->cells().count();
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
