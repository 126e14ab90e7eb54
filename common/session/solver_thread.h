// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"

namespace lapedit {

/// The input for preparing a region for dragging.
struct PrepareTask {
  std::shared_ptr<const TriangleMesh> mesh;  ///< rest pose; has passed validate()
  std::shared_ptr<const Adjacency> adjacency;
  RegionSpec region;
  std::vector<std::vector<int>> groups;  ///< handle groups, each ascending without duplicates
  EditSettings settings;
  StoredScalar scalar = StoredScalar::Float;      ///< precision that poses are rounded to
  std::vector<std::vector<double>> weights = {};  ///< per group, as HandleGroup::weights; empty: 1
  std::optional<MirrorPlane> mirror = {};         ///< as StepOptions::mirror; groups and region are mirrored already
};

/// A mesh and the steps to apply to it.
struct ApplyTask {
  std::shared_ptr<const TriangleMesh> mesh;  ///< has passed validate()
  std::shared_ptr<const Adjacency> adjacency;
  Edit edit;
  StoredScalar scalar = StoredScalar::Float;
};

/// A pose of a region, computed by the solver thread.
struct SolverPose {
  int serial = 0;    ///< as returned by SolverThread::solve()
  Points positions;  ///< one row per region vertex
};

/// Results since the last SolverThread::poll().
struct SolverUpdate {
  std::shared_ptr<const Region> region;  ///< with classified vertices: can be shown, not yet dragged
  bool preview = false;                  ///< solve() has responses, possibly from the cells alone
  bool ready = false;                    ///< prepared: solve() has responses from the system
  bool full_frames = false;              ///< once ready: frames are full solutions, see StepSolver::has_frames()
  bool pose = false;                     ///< poll() filled its argument with a pose
  std::shared_ptr<const EditReport> report;
  std::shared_ptr<const std::vector<EditResult>> applied;  ///< one entry per step of an ApplyTask
  std::string error;                                       ///< preparing or applying failed: the message for the user
  std::string pose_error;                                  ///< solving failed; the region stays prepared

  bool any() const {
    return region || preview || ready || pose || report || applied || !error.empty() || !pose_error.empty();
  }
};

/// Prepares regions and solves for poses on its own threads, so that a window never waits.
///
/// A region of more than a few thousand vertices has previews at once: until it is prepared, frames are poses of its
/// cells, see StepSolver. Final poses are always full ones, with the same bits.
///
/// The newest request wins: prepare(), apply() and cancel() discard all earlier requests, solve() discards earlier
/// solves that have not begun. All functions must be called from one thread, that of the window. They return at once,
/// except wait() and the destructor.
class SolverThread {
 public:
  /// @param wake  called from the solver thread whenever poll() has new results, and from time to time during long work
  explicit SolverThread(std::function<void()> wake);
  /// Waits until the current stage has noticed the cancellation.
  ~SolverThread();

  void prepare(PrepareTask task);
  void apply(ApplyTask task);
  /// Cancels current work and discards the prepared region.
  void cancel();

  /// Requests a pose of the region prepared last or being prepared; without a region it does nothing. @return the
  /// serial number of the request, ascending
  /// @param last  true: the final pose, solved in full, with its report. false: a frame; when no request
  ///              follows, further passes and the full pose follow, all with the same serial number, and then the
  ///              report
  /// Nothing is allocated if an earlier call had as many maps.
  int solve(const std::vector<HandleMotion>& maps, bool last);

  /// Returns new results. @param pose swapped with the newest pose, if there is one; pass the same object again to
  /// avoid allocations
  SolverUpdate poll(SolverPose& pose);

  /// Waits until poll() has new results or the solver thread is idle, at most for some time. @return whether there are
  /// results
  bool wait(std::chrono::milliseconds longest = std::chrono::hours(1));

  bool busy() const;          ///< whether requests are unanswered, reports not counted
  double progress() const;    ///< of preparing or applying, 0 to 1
  std::string stage() const;  ///< name of the current stage

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
