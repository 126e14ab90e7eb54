// SPDX-License-Identifier: GPL-3.0-or-later
// What grows how with the region, one row of the table in common/docs/performance.md per size given: run each size in a
// process of its own, since memory at its peak is the process's.
#include <malloc.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "lapedit/base/stopwatch.h"
#include "lapedit/edit/step_solver.h"
#include "scene.h"

namespace {

double held_megabytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / 1e6;
}

double peak_megabytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

int main(int argc, char** argv) {
  const int vertices = argc == 2 ? std::atoi(argv[1]) : 0;
  if (vertices < 100) {
    std::fprintf(stderr, "usage: growth_bench VERTICES (100 or more)\n");
    return 2;
  }
  const speed::Scene scene = speed::make_scene(vertices);
  const lapedit::EditSettings settings;
  lapedit::Stopwatch watch;
  const auto region = std::make_shared<const lapedit::Region>(
      lapedit::build_region(scene.mesh, scene.adjacency, scene.spec, scene.handle));
  const double found = watch.lap();
  const double before = held_megabytes();
  lapedit::StepSolver solver(scene.mesh, lapedit::FoundRegion{region}, settings);
  lapedit::Points positions;
  solver.make_cells(scene.mesh);
  solver.frame({speed::handle_move(0)}, positions);
  const double has_preview = found + watch.lap();
  solver.frame({speed::handle_move(1)}, positions);
  const double hand_frame = watch.lap();
  solver.prepare(scene.mesh);
  const double ready = watch.lap(), held = held_megabytes() - before;
  solver.frame({speed::handle_move(0)}, positions);
  watch.lap();
  solver.frame({speed::handle_move(1)}, positions);
  const double frame = watch.lap();
  solver.pose({speed::handle_move(1)});
  const double settled_first = watch.lap();
  solver.pose({speed::handle_move(2)});
  const double settled = watch.lap();
  std::printf("| %d | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f |\n", vertices, found, has_preview,
              hand_frame, ready, frame, settled_first, settled, held, peak_megabytes());
  return 0;
}
