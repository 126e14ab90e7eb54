// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lapedit/session/drag_motion.h"
#include "lapedit/session/session_model.h"
#include "lapedit/session/solver_thread.h"

namespace lapedit {

/// The phases of a session, each with the data that only it needs.
namespace phase {

/// There is no handle.
struct Idle {};

/// There is a handle.
struct Picked {
  bool adjustable = false;  ///< settings still apply to the last step
};

/// The handle follows the mouse or typed numbers, or its exact result is being solved for after the release.
struct Dragging {
  DragMotion motion;  ///< of the groups that move
  bool by_button;     ///< started by a button rather than by a key
  bool released = false;
  std::vector<HandleTransform> given = {};         ///< of the user's groups
  std::vector<Vector3> all_targets = {};           ///< of one group or mirror image
  std::vector<std::vector<Vector3>> targets = {};  ///< of the user's groups; of a bent curve only
  std::vector<HandleMotion> maps = {};             ///< of all groups and images; the vectors keep their memory
  /// If a point of the active group's curve moves: per vertex the weights of the motion and of its mirror image.
  std::vector<double> bend = {}, mirrored_bend = {};
  int first_serial = std::numeric_limits<int>::max(), last_serial = 0;  ///< of the requested solves
};

/// The last step is being solved again with other settings, or a new one without a handle is solved.
struct Adjusting {
  EditStep step;
  std::shared_ptr<const TriangleMesh> base;  ///< the mesh before the step
  StepPath path;
  bool is_new = false;
  bool open = false;                                               ///< changes continue: poses are shown, not applied
  std::shared_ptr<const Region> region = nullptr;                  ///< of the step, once it is known
  int first_serial = std::numeric_limits<int>::max(), serial = 0;  ///< of the solves
};

/// The steps of a saved edit are being applied.
struct Loading {
  Edit edit;
  bool adjustable;  ///< before loading, in case it is cancelled
};

using Phase = std::variant<Idle, Picked, Dragging, Adjusting, Loading>;

}  // namespace phase

/// The state of the region's preparation.
struct Preparation {
  bool running = false;
  bool has_preview = false;  ///< frames of a drag are available, at least from the region's cells
  bool ready = false;
  double progress = 0;  ///< 0 to 1
  std::string stage;
};

/// Figures of the panel: counts of vertices, lengths in model units.
struct DragFigures {
  int handle = 0, free = 0, anchors = 0, fixed = 0;
  int pieces = 0;                            ///< number of small pieces that move with the region
  std::shared_ptr<const EditReport> report;  ///< the last one; null: none
  bool full_frames = false;                  ///< each frame of a drag is a full solution
  int steps = 0;                             ///< applied

  std::string advice() const { return report ? report->advice() : std::string(); }
};

/// The step applied last, while it may still be changed.
struct LastStep {
  HandleTransform motion;  ///< of the whole displacement
  double fraction = 1;
  bool bent = false;    ///< a curve was bent: motion does not describe it
  bool single = false;  ///< one vertex was moved, which cannot be rotated or scaled
};

/// Sends requests to the solver thread and takes its results: prepares regions, poses drags and applies them as steps,
/// solves the last step again, applies saved edits. The phase says which of these is in progress.
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
  /// Returns whether a step is being solved: until it is applied, only discard() is possible.
  bool waits() const { return in_progress() && !moving(); }
  bool in_progress() const { return in<phase::Dragging>() || in<phase::Adjusting>() || in<phase::Loading>(); }
  bool adjustable() const;  ///< settings apply to the last step
  Surface surface();
  DragFigures figures() const;
  std::optional<LastStep> last_step() const;
  Preparation preparation() const {
    return {preparation_.running, preparation_.has_preview, preparation_.ready, worker_.progress(), worker_.stage()};
  }
  const SolverThread& worker() const { return worker_; }

  // Regions ----------------------------------------------------------------------------------------------------------

  void prepare();
  /// Prepares after a change of groups or region.
  void handles_changed();
  /// Ends a drag or adjustment. @param adjustable  whether settings still apply to the last step. The detail is that
  /// step's, or 1, since it is meant for one step
  void rest(bool adjustable);

  // Drags ------------------------------------------------------------------------------------------------------------

  /// Begins to move the active group; a drag in progress changes to another kind of motion. @return false if that is
  /// impossible; the model has the reason
  bool begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button);
  /// Makes the current drag move a single point of the active group, a curve.
  void bend(int point);
  /// Requests the pose of the current drag: a passing one, or the final one after the release.
  void request();
  void release();
  /// Cancels work in progress and shows the mesh again.
  void discard();

  // Steps ------------------------------------------------------------------------------------------------------------

  /// Solves the last step again with the current settings. @param open  only shows the result: another change follows
  void adjust(bool open);
  /// Begins a step that changes the detail of the region and moves no handle, or reports why not.
  void begin_detail(bool open);
  /// Solves the last step again with another motion, or a fraction of it; adjustable() has to hold.
  void adjust_path(const HandleTransform& motion, double fraction, bool open);
  void load(Edit edit);
  /// Prepares the region after undone or redone steps. @param applied  whether settings apply to the last step
  void take_over(bool applied);

  // Answers ----------------------------------------------------------------------------------------------------------

  enum class Response { None, Some, Step };  ///< Step: the awaited step has been applied
  Response poll();
  bool wait(std::chrono::milliseconds longest = std::chrono::hours(1)) { return worker_.wait(longest); }

 private:
  EditSettings plain_settings() const;
  void request_preparation(PrepareTask task);
  void set_targets(phase::Dragging& drag) const;
  bool take_pose();
  void begin_adjusting();
  void request_adjusted(bool prepares);
  void show_adjusted(const phase::Adjusting& adjusting);
  const AppliedStep& apply(EditStep step, EditResult pose, std::optional<StepPath> path = {});
  void commit_drag();
  void commit_adjusted();
  void commit_loaded(const std::vector<EditResult>& results);
  void progress();
  void find_unconnected(const Region& region);
  void on_error(const std::string& sentence);

  SessionModel& model_;
  phase::Phase phase_;
  Preparation preparation_;  // without progress and stage
  DragFigures figures_;      // the report
  SolverPose solved_;
  SolverThread worker_;  // last: its thread ends first
};

/// Returns the weight of each handle vertex in the displacement of one point of a curve: 1 at the point, 0 from the
/// next points on, smooth along the curve. Towards an end the curve swings freely; between points it keeps its
/// direction at them. Equal displacements of all points translate the curve.
/// @param group  the handle's vertices, ascending. @param point  number among curve.points
std::vector<double> bend_weights(const TriangleMesh& mesh, const std::vector<int>& group, const HandleCurve& curve,
                                 int point);

}  // namespace lapedit
