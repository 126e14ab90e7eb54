// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"

namespace lapedit {

/// What is needed to make one region ready for dragging.
struct PrepareTask {
  std::shared_ptr<const TriangleMesh> mesh;  ///< rest pose; has passed validate()
  std::shared_ptr<const Adjacency> adjacency;
  RegionSpec region;
  std::vector<std::vector<int>> groups;  ///< handle groups, each ascending without duplicates
  EditSettings settings;
  StoredScalar scalar = StoredScalar::Float;      ///< poses are rounded to it
  std::vector<std::vector<double>> weights = {};  ///< per group, as HandleGroup::weights; none: 1
  std::optional<MirrorPlane> mirror = {};         ///< as StepProblem::mirror; groups and region are mirrored already

  StepProblem problem() const { return {*mesh, *adjacency, region, groups, settings, scalar, weights, mirror}; }
};

/// A mesh and the steps to apply to it.
struct ApplyTask {
  std::shared_ptr<const TriangleMesh> mesh;  ///< has passed validate(), as the adjacency below is its own
  std::shared_ptr<const Adjacency> adjacency;
  Edit edit;
  StoredScalar scalar = StoredScalar::Float;
};

/// A region posed by the worker.
struct SolverPose {
  int serial = 0;    ///< as returned by SolverThread::solve()
  Points positions;  ///< one row per region vertex
  double solve_ms = 0;
};

/// What has become known since the last SolverThread::poll().
struct SolverNews {
  std::shared_ptr<const Region> region;  ///< classified: can be shown, not yet dragged
  bool in_hand = false;                  ///< solves are being answered, if only by the cells
  double in_hand_ms = 0;                 ///< from the question on
  bool ready = false;                    ///< prepared: solves are being answered by the editor
  double prepare_ms = 0;                 ///< of all stages, once ready
  std::string taken_over;                ///< once ready: see EditReport::taken_over
  bool full_frames = false;              ///< once ready: frames are full solutions, see DragFrames::has_frames()
  bool pose = false;                     ///< the pose handed to poll() was filled
  std::shared_ptr<const EditReport> report;
  std::shared_ptr<const std::vector<EditResult>> applied;  ///< one entry per step of an ApplyTask
  std::string error;                                       ///< preparing or applying failed: the sentence for the user
  std::string pose_error;                                  ///< solving failed; the region stays prepared
};

/// Prepares regions and solves for poses on threads of its own, so that a window never waits.
///
/// A region of more than a few thousand vertices has previews at once: until it is prepared, passing poses are those
/// of its cells, and after that DragFrames with their correction. What stays is always the editor's, to the bit.
///
/// The newest question wins: prepare(), apply() and cancel() drop what was asked before, solve() the solves before it
/// that have not begun. All functions are for one thread, that of the window, and return at once, except wait() and the
/// destructor.
class SolverThread {
 public:
  /// @param wake  called from the worker's thread whenever poll() has something new, and at times during long work
  explicit SolverThread(std::function<void()> wake);
  /// Waits until the stage at work notices that it is not wanted.
  ~SolverThread();

  void prepare(PrepareTask task);
  void apply(ApplyTask task);
  /// Drops what is being done, and what was prepared.
  void cancel();

  /// Asks for the pose of the region last prepared, or still to be; without one, nothing happens. @return its serial,
  /// counting up
  /// @param last  the pose is to stay: it is solved for in full, and its report comes with it. Else it is a frame
  ///              (DragFrames); when the questions pause it is followed by its other passes and the full pose, all of
  ///              the same serial, and then by its report
  /// Nothing is allocated once as many maps were given before.
  int solve(const std::vector<HandleMotion>& maps, bool last);

  /// Hands out what is new. @param pose  swapped with the newest pose, if there is one, and to be given again next
  /// time: nothing is allocated
  SolverNews poll(SolverPose& pose);

  /// Until poll() would have news or the worker has nothing to do; for tests and for leaving. @return whether news
  bool wait();

  bool busy() const;          ///< something asked is not yet answered; reports are not counted
  double progress() const;    ///< of preparing or applying, 0 to 1
  const char* stage() const;  ///< name of what is being done

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
