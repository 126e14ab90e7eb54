// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/laplacian_editor.h"

#include <utility>

#include "lapedit/base/stopwatch.h"

namespace lapedit {

LaplacianEditor::LaplacianEditor(const TriangleMesh& mesh, std::shared_ptr<const Region> region,
                                 const EditSettings& settings, const Progress& progress,
                                 std::unique_ptr<LaplacianEditor> previous) {
  prepare(mesh, std::make_shared<const RestPose>(mesh, std::move(region)), settings, progress, std::move(previous));
}

LaplacianEditor::LaplacianEditor(const TriangleMesh& mesh, std::shared_ptr<CellModel> cells,
                                 const EditSettings& settings, const Progress& progress,
                                 std::unique_ptr<LaplacianEditor> previous)
    : cells_(std::move(cells)) {
  prepare(mesh, cells_->rest(), settings, progress, std::move(previous));
}

/// The cells do not need the factor, so a second thread makes them meanwhile.
void LaplacianEditor::prepare(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest,
                              const EditSettings& settings, const Progress& progress,
                              std::unique_ptr<LaplacianEditor> previous) {
  validate(settings);
  constexpr int kWorthAThread = 2000;
  const bool makes_cells = settings.rotation == DetailRotation::LocalGlobal && !cells_;
  const bool apart = makes_cells && rest->region->size() >= kWorthAThread;
  ThreadPool(apart && thread_count(settings.threads) > 1 ? 2 : 1).each(makes_cells ? 2 : 1, [&](int part) {
    if (part == 0) {
      solver_ = std::make_unique<PoseSolver>(mesh, rest, settings, progress,
                                             previous ? std::move(previous->solver_) : nullptr);
    } else {
      const Stopwatch watch;
      EditSettings own = settings;
      own.threads = apart ? 1 : settings.threads;
      cells_ = std::make_shared<CellModel>(mesh, rest, own);
      cells_ms_ = watch.elapsed();
    }
  });
}

const Points& LaplacianEditor::solve(const std::vector<HandleMotion>& handles, const Affine& anchors,
                                     const Progress& go_on) {
  const bool turns = system().settings.rotation == DetailRotation::LocalGlobal;
  turn_ms_ = 0;
  if (turns) {
    report_progress(go_on, 0, "rotations");
    const Stopwatch watch;
    cells_->solve(handles, anchors, false);
    cells_->spread(start_, *system().pool);
    turn_ms_ = watch.elapsed();
  }
  return solver_->solve(handles, anchors, turns ? &start_ : nullptr, go_on);
}

EditReport LaplacianEditor::report(const Points& stored, bool whole) const {
  EditReport report = solver_->report(stored, whole);
  report.kernel_ms += cells_ms_;
  report.rotate_ms += turn_ms_;
  return report;
}

}  // namespace lapedit
