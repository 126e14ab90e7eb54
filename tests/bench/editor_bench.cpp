// SPDX-License-Identifier: GPL-3.0-or-later
//
// Times of an edit on regions of about the sizes in the paper's Table 1, each with CHOLMOD and with Eigen's own
// factorisation, the slower alternative, in the same run. Both have to give the same surface.
#include <benchmark/benchmark.h>

#include <cmath>

#include "lapedit/edit.h"
#include "shapes.h"

namespace {

using namespace lapedit;

struct Scene {
  TriangleMesh mesh;
  Adjacency adjacency;
  std::vector<std::vector<int>> handle;
  RegionSpec region;
  std::vector<Affine> lift;

  /// A field of letters of about so many vertices; the region reaches its border.
  explicit Scene(int vertices) {
    const int ny = static_cast<int>(std::lround(std::sqrt(vertices / 2.0)));
    mesh = shapes::letter_field(2 * ny, ny);
    adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
    handle = {{nearest_vertex(mesh, Vector3(2, 1, 0))}};
    region.radius = 3;
    region.padding = 0.3;
    lift.assign(1, Affine(Eigen::Translation3d(0, 0, 0.8)));
  }
  Region build() const { return build_region(mesh, adjacency, region, handle); }
};

EditSettings settings(CholeskyBackend backend, DetailRotation rotation) {
  EditSettings result;
  result.backend = backend;
  result.rotation = rotation;
  return result;
}

/// Region, operator and factor; without the smoothing tables.
void prepare(benchmark::State& state, CholeskyBackend backend) {
  const Scene scene(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    LaplacianEditor editor(scene.mesh, scene.build(), settings(backend, DetailRotation::None));
    benchmark::DoNotOptimize(&editor.region());
  }
  state.counters["region"] = scene.build().size();
}

/// Cursor in, positions out, rotation included.
void drag(benchmark::State& state, CholeskyBackend backend) {
  Scene scene(static_cast<int>(state.range(0)));
  LaplacianEditor editor(scene.mesh, scene.build(), settings(backend, DetailRotation::SmoothSurface));
  LaplacianEditor other(scene.mesh, scene.build(), settings(CholeskyBackend::Eigen, DetailRotation::SmoothSurface));
  const double difference = (editor.solve(scene.lift) - other.solve(scene.lift)).cwiseAbs().maxCoeff();
  if (!(difference < 1e-6)) {
    state.SkipWithError("the two factorisations disagree");
  }
  for (auto _ : state) {
    scene.lift[0].translation().x() += 1e-3;
    benchmark::DoNotOptimize(editor.solve(scene.lift).data());
  }
  state.counters["region"] = editor.region().size();
  state.counters["rough_ms"] = editor.report().rough_ms;
  state.counters["rotate_ms"] = editor.report().rotate_ms + editor.report().normals_ms;
  state.counters["solve_ms"] = editor.report().solve_ms;
}

void sizes(benchmark::internal::Benchmark* bench) {
  for (const int vertices : {1300, 3600, 5000, 13600, 17900, 34300}) {
    bench->Arg(vertices);
  }
  bench->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}

BENCHMARK_CAPTURE(prepare, automatic, CholeskyBackend::Automatic)->Apply(sizes);
BENCHMARK_CAPTURE(prepare, eigen, CholeskyBackend::Eigen)->Apply(sizes);
BENCHMARK_CAPTURE(drag, automatic, CholeskyBackend::Automatic)->Apply(sizes);
BENCHMARK_CAPTURE(drag, eigen, CholeskyBackend::Eigen)->Apply(sizes);

}  // namespace
