// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The inside of LaplacianEditor, for its two files alone: laplacian_editor_preparation.cpp has what is done once,
// laplacian_editor.cpp what each solution takes.

#include <algorithm>
#include <memory>
#include <vector>

#include "lapedit/base/stopwatch.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/drag_preview.h"
#include "lapedit/deform/laplacian_editor.h"
#include "lapedit/deform/smoother.h"
#include "lapedit/linear/accurate_residual.h"
#include "lapedit/linear/operator_rows.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace lapedit {

inline double largest_row(const Points& points) {
  return points.rows() > 0 ? points.rowwise().norm().maxCoeff() : 0;
}

struct LaplacianEditor::State {
  /// A map as "minus identity", about a local origin: keeps a translation of a far-away mesh exact.
  struct Motion {
    Matrix3 linear = Matrix3::Zero();       ///< L - I
    Vector3 translation = Vector3::Zero();  ///< displacement of the local origin

    static Motion of(const Affine& map, const Vector3& origin) {
      Motion motion;
      motion.linear = map.linear() - Matrix3::Identity();
      motion.translation = motion.linear * origin + map.translation();
      return motion;
    }
    Vector3 displacement(const Vector3& local) const { return linear * local + translation; }
    bool none() const { return linear.isZero(0) && translation.isZero(0); }
  };

  /// What an edit owes to the region, its anchors and the settings alone: another handle can go on with it.
  struct Foundation {
    OperatorRows m;      // the operator, M^k
    OperatorRows first;  // M_1, the operator of order 1; empty if m is it
    int uniform_edges = 0;
    Eigen::VectorXd weights;  // w_i^2 of those that the factor knows
    double matrix_norm = 0;   // of the factor's matrix
    std::unique_ptr<SparseCholesky> factor;
    int refinements = 0;
    std::unique_ptr<Smoother> smoother;
    Points smooth_rest;
    bool smooth_rest_is_exact = false;  // or as good as previews need it
  };

  /// Something that the unrotated result depends on linearly.
  struct Response {
    int group;
    int column;  // of the group's motion about the origin; 3: its translation
    int vertex;  // local, of a group that is one vertex and has but one response, its way; else -1
  };

  Region region;
  EditSettings settings;
  EditReport report;
  std::shared_ptr<ThreadPool> pool;
  Foundation base;
  bool took_operator = false;  // from another editor
  std::vector<int> order;      // of elimination, while preparing

  Vector3 origin = Vector3::Zero();    // the first handle vertex: coordinates below are relative to it
  Points world;                        // rest pose as given
  Points rest;                         // rest pose about the origin
  Points delta;                        // M_1 rest
  Eigen::VectorXd squared_weights;     // w_i^2 of handles and anchors, 0 for free vertices
  DragPreview::Correction correction;  // of the factor, for handles that were kept out of it
  std::unique_ptr<RotationEstimator> estimator;
  std::unique_ptr<DragPreview> preview;
  std::vector<Response> responses;  // of the preview

  // Of the last solve.
  std::vector<Motion> targets;            // per handle group
  std::vector<Motion> carried;            // per component: where it is carried before anything else
  std::vector<Matrix3> carried_rotation;  // per component
  std::vector<int> handles_seen;          // per component without anchors
  bool is_carried = false;
  bool estimator_at_rest = false;
  Points carried_pose;  // empty unless something is carried
  Points constraint_rhs, rhs, d, previous, residual, step, rows, positions;
  Points motions, at_rows, corrected;
  DoubledPoints doubled, between;
  Progress go_on;          // of the solve at work
  double last_change = 0;  // of the last step of refinement, over the solution
  std::vector<Matrix3> rotations;

  bool all_anchored() const {
    return std::all_of(region.anchored.begin(), region.anchored.end(), [](char anchored) { return anchored; });
  }
  const OperatorRows& first() const { return settings.order == 1 ? base.m : base.first; }

  // Preparation.
  void set_up(const TriangleMesh& mesh, const Progress& progress, State* before);
  void assemble(const TriangleMesh& mesh, State* before);
  void weigh();
  bool fits_factor(const State* before) const;
  bool fits_smoother(const State* before) const;
  void factorise(State* before);
  void make_factor(bool single_precision);
  template <class Solve>
  int refine(const Eigen::VectorXd& weights, const Points& right, Points& x, double accurate, const Solve& solve);
  bool make_sure();
  bool find_refinements();
  bool keep_handles_out();
  void smooth(State* before);
  bool may_preview() const;
  void make_preview();
  Eigen::MatrixXd find_responses();

  // Solutions.
  void check(const std::vector<Affine>& handles) const;
  [[noreturn]] void refuse_conditioning() const;
  void turn_from(const Points& pose);
  void carry_components(const std::vector<Affine>& handles, const Affine& anchors);
  bool set_constraints();
  void normal_product(const Eigen::VectorXd& weights, const Points& x, Points& out);
  void solve_once(const Points& right, Points& x);
  void solve_exactly(const Points& right, Points& x);
  void rotate_deltas();
  void collect_positions();
};

}  // namespace lapedit
