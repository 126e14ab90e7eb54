// SPDX-License-Identifier: GPL-3.0-or-later
#include "ours.h"

#include "lapedit/deform/coarse_preview.h"
#include "lapedit/edit/laplacian_editor.h"
#include "lapedit/deform/smooth_normals.h"
#include "lapedit/linear/nested_dissection.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace speed {

using lapedit::LaplacianEditor;
using lapedit::Points;
using lapedit::Region;

namespace {

/// Those that the peers can follow: the umbrella operator without a membrane.
lapedit::EditSettings settings(int order, int threads) {
  lapedit::EditSettings result;
  result.laplacian = lapedit::LaplacianKind::Umbrella;
  result.rotation = lapedit::DetailRotation::SmoothSurface;
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
  std::unique_ptr<LaplacianEditor> editor;
  std::vector<lapedit::Affine> handles;
  const Points* positions = nullptr;
  const Points* normals = nullptr;
  Points own_normals;
  Eigen::VectorXd areas;
};

Ours::Ours(const Scene& scene, int order, int threads) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.settings = settings(order, threads);
  s.handles.resize(1);
  s.editor = std::make_unique<LaplacianEditor>(
      scene.mesh, lapedit::build_region(scene.mesh, scene.adjacency, scene.spec, scene.handle, threads), s.settings);
}
Ours::~Ours() = default;

void Ours::frame(const lapedit::Affine& handle) {
  State& s = *state_;
  s.handles[0] = handle;
  s.positions = &s.editor->preview(s.handles);
  s.normals = &s.editor->preview_normals();
  if (s.normals->rows() == 0) {
    lapedit::vertex_normals(*s.positions, s.editor->region().faces, s.own_normals, s.areas);
    s.normals = &s.own_normals;
  }
}
const Points& Ours::positions() const {
  return *state_->positions;
}
const Points& Ours::normals() const {
  return *state_->normals;
}

const Points& Ours::exact(const lapedit::Affine& handle) {
  state_->handles[0] = handle;
  return state_->editor->solve(state_->handles);
}
const std::vector<lapedit::Matrix3>& Ours::exact_rotations() const {
  return state_->editor->rotations();
}

void Ours::second_handle(const Scene& scene, int vertex) {
  State& s = *state_;
  Region region = s.editor->region();
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == lapedit::VertexClass::Handle) {
      region.classes[i] = lapedit::VertexClass::Free;
      region.group[i] = -1;
    }
    if (region.mesh_vertex[i] == vertex) {
      region.classes[i] = lapedit::VertexClass::Handle;
      region.group[i] = 0;
    }
  }
  s.editor = std::make_unique<LaplacianEditor>(scene.mesh, std::move(region), s.settings, lapedit::Progress(),
                                               std::move(s.editor));
}
const Region& Ours::region() const {
  return state_->editor->region();
}

struct OurHand::State {
  std::shared_ptr<const Region> region;
  lapedit::CoarsePreview preview;
  std::vector<lapedit::Affine> handles{lapedit::Affine::Identity()};
  const Points* positions = nullptr;
  Points normals;
  Eigen::VectorXd areas;

  State(const Scene& scene, const lapedit::EditSettings& given)
      : region(std::make_shared<const Region>(
            lapedit::build_region(scene.mesh, scene.adjacency, scene.spec, scene.handle, given.threads))),
        preview(scene.mesh, region, given) {}
};

OurHand::OurHand(const Scene& scene, int order, int threads)
    : state_(std::make_unique<State>(scene, settings(order, threads))) {}
OurHand::~OurHand() = default;

void OurHand::frame(const lapedit::Affine& handle) {
  State& s = *state_;
  s.handles[0] = handle;
  s.positions = &s.preview.pose(s.handles);
  lapedit::vertex_normals(*s.positions, s.region->faces, s.normals, s.areas);
}
const Points& OurHand::positions() const {
  return *state_->positions;
}
int OurHand::cells() const {
  return state_->preview.cells();
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
