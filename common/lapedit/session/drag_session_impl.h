// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The inside of DragSession, for the files drag_session*.cpp alone.

#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/format_text.h"
#include "lapedit/edit/solver_thread.h"
#include "lapedit/mesh/visibility.h"
#include "lapedit/session/drag_session.h"

namespace lapedit {

/// A step with what it changed.
struct AppliedStep {
  EditStep step;
  std::vector<int> vertices;
  Points before, after;
  RegionSpec next;  ///< the region for what follows in it
};

struct DragSession::Impl {
  static constexpr int kNone = std::numeric_limits<int>::max();

  // Constant.
  Callbacks callbacks;
  StoredScalar scalar;
  std::shared_ptr<const TriangleMesh> original;
  std::shared_ptr<const Adjacency> adjacency;

  // The mesh and how it came about.
  std::shared_ptr<const TriangleMesh> current;  // the worker reads it, too: replaced, never changed
  std::vector<AppliedStep> steps, undone;
  mutable std::string checksum;

  // What is set and picked.
  DragSettings settings;
  HandleMode mode = HandleMode::Vertex;
  RegionSpec spec;
  bool has_region = false;
  bool by_hand = false;  // brushed or selected: not to be lost by a click
  std::vector<std::vector<int>> groups;
  int active = -1;
  int curve_end = -1;  // where the next piece of a curve begins
  bool want_group = false, want_region = false;
  bool amendable = false;  // the last step is still what settings are about

  // What happens.
  State state = State::Idle;
  enum class Settling { Release, Amend, Load } settling = Settling::Release;
  std::optional<DragMotion> motion;
  bool held = false;  // the motion is by a held button
  struct Press {
    Vector3 point;    // what was grabbed
    int vertex = -1;  // nearest to it
    Cursor cursor;
    PressModifiers modifiers;
    bool draggable = true;
    bool brushed = false;
  };
  std::optional<Press> pressed;
  struct Deferred {
    enum { Press, Move, Release } kind;
    Cursor cursor;
    PressModifiers modifiers;
  };
  std::deque<Deferred> deferred;  // mouse events during Settling
  std::unique_ptr<Visibility> visibility;
  std::string refusal;

  // What is shown.
  std::shared_ptr<const Region> region, incoming;
  Points pose;
  int pose_serial = 0;
  bool away = false;  // the pose is another one than the mesh

  // The worker, last: its thread ends first.
  bool preparing = false, ready = false;
  double prepare_ms = 0, solve_ms = 0;
  std::shared_ptr<const EditReport> report;
  std::vector<Affine> maps;
  int first_serial = kNone, last_serial = kNone;  // of the solves that the motion asked for
  EditStep amended;                               // while settling an Amend
  std::shared_ptr<const TriangleMesh> amend_base;
  Edit loading;  // while settling a Load
  SolverPose worker_pose;
  SolverThread worker;

  Impl(TriangleMesh mesh, StoredScalar stored, Callbacks given);

  void log(const std::string& line) {
    if (callbacks.log) {
      callbacks.log(line);
    }
  }
  void refuse(const std::string& sentence) { refusal = sentence; }
  bool at_rest();
  void end_stroke();

  // Mesh and poses.
  void show(const std::vector<int>& vertices, const Points& places, bool settled) {
    if (callbacks.pose) {
      callbacks.pose(vertices, places, settled);
    }
  }
  void write(const std::vector<int>& vertices, const Points& places);
  void show_region(std::shared_ptr<const Region> shown);
  void back_to_rest(bool settled);

  // Regions.
  void sync_padding() {
    if (spec.padding != settings.padding) {
      spec.anchors = KeptAnchors();
    }
    spec.padding = settings.padding;
  }
  void set_vertices(std::vector<int> vertices) {
    spec = RegionSpec();
    spec.kind = RegionSpec::Kind::Vertices;
    spec.vertices = std::move(vertices);
    sync_padding();
    has_region = true;
  }
  void keep_region();
  void set_radius() {
    spec = RegionSpec();
    spec.radius = settings.radius;
    sync_padding();
    has_region = true;
    by_hand = false;
  }
  void prepare();
  void show_by_hand();
  bool choose_region(int vertex, std::vector<int>& handle);

  // Handles.
  void pick(const SurfaceHit& hit);
  std::optional<SurfaceHit> hit_at(const Cursor& cursor) const;
  int group_at(const std::optional<SurfaceHit>& hit, const Cursor& cursor) const;
  bool extend_curve(int vertex);
  void add_to_handle(int vertex);
  void take_from_handle(int vertex);
  void handles_changed();
  void brush(const Cursor& cursor);
  template <class Change>
  void change_region(const Change& change);

  // Motion.
  bool begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button);
  bool begin_by_key(MotionKind kind, const Cursor& cursor);
  void ask(bool last);
  void drop();
  void release_motion();

  // Steps.
  EditStep step_now() const;
  void commit_release();
  void amend();
  void commit_amended();
  void commit_loaded(const std::vector<EditResult>& results);
  void undo_one(bool settled);
  void redo_one();
  void take_over(const AppliedStep& step, bool done);
  void after_commit();

  // News of the worker.
  void take_pose();
  void on_error(const std::string& sentence);
};

}  // namespace lapedit
