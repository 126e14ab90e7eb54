// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lapedit/live/solver_thread.h"
#include "lapedit/session/drag_motion.h"
#include "lapedit/session/session_model.h"

namespace lapedit {

/// What a session is doing, and what means something only meanwhile.
namespace phase {

/// There is no handle.
struct Idle {};

/// There is a handle.
struct Picked {
  bool amendable = false;  ///< the step applied last is still what settings are about
};

/// The handle follows the mouse or typed numbers or, once released, its exact result is being solved for.
struct Dragging {
  DragMotion motion;  ///< of the active group
  bool by_button;     ///< held, rather than begun by a key
  bool released = false;
  std::vector<HandleTransform> given = {};                              ///< of the user's groups
  std::vector<HandleMotion> maps = {};                                  ///< of all groups; both kept for their memory
  int first_serial = std::numeric_limits<int>::max(), last_serial = 0;  ///< of the solves asked for
};

/// The last step is being solved for again, with other settings.
struct Amending {
  EditStep step;
  std::shared_ptr<const TriangleMesh> base;  ///< the mesh before the step
  DragSettings before;                       ///< of the step as it is now
  int serial = 0;                            ///< of the solve
};

/// The steps of a saved edit are being applied.
struct Loading {
  Edit edit;
  bool amendable;  ///< as it was, should this be dropped
};

using Phase = std::variant<Idle, Picked, Dragging, Amending, Loading>;

}  // namespace phase

/// What the panel shows. Counts of the region; milliseconds; lengths in model units.
struct DragFigures {
  int handle = 0, free = 0, anchors = 0, fixed = 0;
  // Empty while the region is being prepared, or before it has a pose.
  std::optional<double> in_hand_ms;  ///< until a drag could be followed
  std::optional<double> prepare_ms;
  std::optional<double> solve_ms;         ///< of the last pose
  std::optional<double> handle_error;     ///< largest distance of a handle vertex from its target, of the last report
  std::optional<double> largest_stretch;  ///< of an edge, new over old length minus 1, of the last report
  std::string advice;                     ///< of the last report; empty: none
  bool full_frames = false;               ///< each frame of a drag is a full solution
  std::string taken_over;                 ///< what preparing took over from the region before
  int steps = 0;                          ///< applied
};

/// What a session asks the solver for, and what comes of the answers: a region is prepared, a drag posed and made a
/// step, the last step solved for again, a saved edit applied. One of these at a time is the phase.
class SessionSolver {
 public:
  /// @param wake  as SolverThread's
  SessionSolver(SessionModel& model, std::function<void()> wake);

  template <class P>
  P* in() {
    return std::get_if<P>(&phase_);
  }
  template <class P>
  const P* in() const {
    return std::get_if<P>(&phase_);
  }
  bool moving() const { return in<phase::Dragging>() && !in<phase::Dragging>()->released; }
  /// Whether a step is being worked out: only drop() is possible until it is there.
  bool waits() const { return in_progress() && !moving(); }
  bool in_progress() const { return in<phase::Dragging>() || in<phase::Amending>() || in<phase::Loading>(); }
  bool amendable() const;  ///< settings are about the last step
  Surface surface() const;
  DragFigures figures() const;
  bool preparing() const { return preparation_ == Preparation::Running; }
  bool ready() const { return preparation_ == Preparation::Done; }
  bool in_hand() const { return in_hand_; }
  const SolverThread& worker() const { return worker_; }

  // Regions ----------------------------------------------------------------------------------------------------------

  void prepare();
  /// After groups or region have changed: prepares for them.
  void handles_changed();
  /// Nothing is to be amended any more.
  void rest(bool amendable);

  // Drags ------------------------------------------------------------------------------------------------------------

  /// The active group begins to move; a drag in progress goes on as another kind of motion.
  /// @return false if it cannot, which the model's refusal tells
  bool begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button);
  /// Asks for the pose of the drag as it is now: a passing one or, once it is released, the one to stay.
  void ask();
  void release();
  /// Ends what is in progress without a trace.
  void drop();

  // Steps ------------------------------------------------------------------------------------------------------------

  /// Solves the last step again with the settings as they are now. @param before  those of the step as it is
  void amend(const DragSettings& before);
  void load(Edit edit);
  /// The selection has become that of a step. @param applied  it is the one after it, else the one before
  void take_over(const AppliedStep& step, bool applied);

  // Answers ----------------------------------------------------------------------------------------------------------

  enum class News { None, Some, Step };  ///< Step: what was waited for has been applied
  News poll();
  bool wait() { return worker_.wait(); }

 private:
  enum class Preparation { None, Running, Done };

  void ask_to_prepare(PrepareTask task);
  bool take_pose();
  void commit_drag();
  void commit_amended();
  void commit_loaded(const std::vector<EditResult>& results);
  void go_on();
  void find_unconnected(const Region& region);
  void on_error(const std::string& sentence);

  SessionModel& model_;
  phase::Phase phase_;
  Preparation preparation_ = Preparation::None;
  bool in_hand_ = false;  // drags are followed, if only by the cells
  DragFigures heard_;     // times and errors
  SolverPose solved_;
  SolverThread worker_;  // last: its thread ends first
};

}  // namespace lapedit
