// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lapedit/cells/cell_model.h"
#include "lapedit/cells/rotation_fit.h"
#include "lapedit/deform/correction_step.h"
#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/deform/frame_rotations.h"
#include "lapedit/edit/contact_pose.h"
#include "lapedit/edit/mirror.h"

// Prepares a step and computes its poses. This example pulls up vertex 42 with the surface within 0.3 of it:
//
//     RegionSpec spec;
//     spec.radius = 0.3;
//     const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
//     StepSolver solver(mesh, find_region(mesh, adjacency, spec, {{42}}), EditSettings());
//     solver.prepare(mesh);
//     Affine up = Affine::Identity();
//     up.translation().z() = 0.1;
//     const Points& result = solver.pose({up});
//     for (int i = 0; i < solver.region().size(); ++i) {
//       mesh.vertices.row(solver.region().mesh_vertex[i]) = result.row(i);
//     }

namespace lapedit {

/// Precision of the mesh that takes the result: positions are rounded to it after each step, so that a replay sees
/// what an interactive session saw.
enum class StoredScalar { Float, Double };

/// Rounds to the mesh's precision. @throws EditError (NotFinite) if a coordinate becomes infinite
void round_to(StoredScalar scalar, Points& positions);
/// Returns the spacing of coordinates of this size.
double spacing(StoredScalar scalar, double coordinate);

/// A step's region, and the time that finding it took.
struct FoundRegion {
  std::shared_ptr<const Region> region;
  double milliseconds = 0;
};

/// @param groups   handle groups, vertices in any order; @param weights per group, as HandleGroup::weights; none: 1
/// @param threads  as for SolverOptions
/// @throws EditError as sort_group(), build_region() and require_size()
FoundRegion find_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                        std::vector<std::vector<int>> groups, std::vector<std::vector<double>> weights = {},
                        int threads = 0);

/// @throws EditError (BadParameter) if fourth powers of the region's lengths or coordinates may be no numbers
void require_size(const TriangleMesh& mesh, const Region& region);

struct StepOptions {
  StoredScalar scalar = StoredScalar::Double;
  /// The mirror plane of groups and region: poses become symmetric to the last bits, see PoseSymmetry.
  std::optional<MirrorPlane> mirror = {};
  SolverOptions solver = {};
};

/// Solves for poses of one region with its handles (paper, sections 3 to 5). Filters, program and window solve all
/// steps with this class, so that a step has the same bits everywhere.
///
/// A pose minimises |M^k x - M^(k-1) R delta|^2 + sum_i w_i^2 |x_i - c_i|^2 over the region's vertices, plus the
/// membrane's c x^T L x with rotated edges. Here k is the order, delta = M p are the differential coordinates of the
/// rest pose p, and R the rotations that the method estimates. With k = 1 this is the paper's system. For k > 1
/// coordinates are rotated before M^(k-1) is applied; where R is constant this is the paper's formula. The unknowns are
/// displacements from the rest pose, so vertices that do not move keep their bits. The same motions give the same bits,
/// independent of earlier poses.
///
/// A pose of EditMethod::Default starts from that of the cells. Each pass fits rotations R, at first those of the
/// cells, and adds
///
///     d <- d + A^-1 (b(R) - A d),
///
/// with the existing factor, until d is accurate: to 1e-11 in the last pass. A frame of a drag does so once, from cells
/// that are posed quickly, or is their pose alone until there is a system: an approximation in a fraction of the time.
/// refine() replaces it, pass by pass, by the pose.
///
/// With another detail than 1 the pose p is p + (1 - detail) (b - p) in all of this, see fair_displacement(). Handles
/// move relative to it. Without a handle that is the result.
///
/// Other handles, anchors or settings need a new object, which can reuse the system of an old one.
class StepSolver {
 public:
  /// Stores the region. Poses need prepare() or take(), frames make_cells().
  /// @param mesh  rest pose; not kept. @throws EditError (BadParameter) as validate()
  StepSolver(const TriangleMesh& mesh, FoundRegion found, const EditSettings& settings,
             const StepOptions& options = {});
  ~StepSolver();

  /// Makes cells if there are none, and there is a handle, so that frames are available. Cost: some milliseconds per
  /// 10000 vertices.
  /// @throws EditError (IllConditioned, Cancelled)
  void make_cells();
  /// Makes the system: the operator, one sparse Cholesky factorisation, tables. The object does not change, so another
  /// thread may compute frames meanwhile.
  /// @param previous  a system that is no longer needed, or null. Parts that still fit, above all the factor, are
  ///                  reused: another small handle in the same region with the same anchors is ready in a fraction of
  ///                  the time. The result has the same bits in both cases
  /// @throws EditError (IllConditioned, Cancelled)
  std::shared_ptr<const LaplacianSystem> make_system(const TriangleMesh& mesh,
                                                     const LaplacianSystem* previous = nullptr) const;
  /// Makes poses available. @param system  from make_system()
  void take(std::shared_ptr<const LaplacianSystem> system);
  /// Makes cells, where the method needs them for poses, and the system, on two threads, and takes it.
  void prepare(const TriangleMesh& mesh, const LaplacianSystem* previous = nullptr);

  const Region& region() const { return *rest_->region; }
  const EditSettings& settings() const { return settings_; }
  const std::shared_ptr<const LaplacianSystem>& system() const { return system_; }  ///< null before take()

  /// Computes a pose. Requires a system.
  ///
  /// A component without anchors is first moved by the mean of its groups' maps, so that it follows a single group
  /// exactly.
  /// @param handles   one motion per handle group; an affine map converts to a motion
  /// @param fraction  of the change that the setting `detail` makes
  /// @return          size() x 3, model units, rounded to the mesh's precision; valid until the next call. Row i
  ///                  belongs to region().mesh_vertex[i]
  /// @throws EditError (NotFinite) if a map or the result is not finite; (Cancelled); the object stays usable
  /// Cost: some passes, each with a solve or, the last one, three to six. Nothing is allocated after the first call.
  const Points& pose(const std::vector<HandleMotion>& handles, double fraction = 1);
  /// Returns the rotations of the last pose, one per region vertex.
  const std::vector<Matrix3>& rotations() const { return rotations_; }

  /// Returns the report of preparation and last pose(). It computes residuals and stretch on each call. Preparation
  /// times are 0 after the first pose.
  EditReport report() const;

  /// Returns whether frames are available and cheaper than poses: with cells, but not with EditMethod::Paper once there
  /// is a system, nor with another detail before.
  bool has_frames() const {
    return cells_ && (system_ ? settings_.method != EditMethod::Paper : settings_.detail == 1);
  }
  /// Computes a frame with few passes over the cells. Requires has_frames().
  /// @param positions  out: as pose() returns them
  /// After the first call memory is allocated for targets only. @throws EditError (NoHandle, NotFinite)
  void frame(const std::vector<HandleMotion>& handles, Points& positions);
  /// Replaces the last frame by the next pass of its pose. Requires a system. @return whether there was one; after the
  /// last one settled() holds
  /// Nothing is allocated after the first passes. @throws EditError (NotFinite, Cancelled)
  bool refine(Points& positions);
  /// Returns whether the last result is a pose, with the bits that pose() returns for its motions.
  bool settled() const { return stage_ == Stage::Settled; }

 private:
  enum class Stage {
    None,   ///< no result, or a cancelled one
    Quick,  ///< a frame
    Full,   ///< some passes of a pose
    Settled
  };
  /// Counts and times of the last pose.
  struct PoseFigures {
    int iterations = 0;
    double rotate_ms = 0, solve_ms = 0;
    double rotation_left = 0;  ///< largest change of a rotation in the last pass, degrees
    int unsettled = -1;        ///< at this vertex of the region
  };
  struct Preparation {
    double region_ms = 0;
    int passes = 0;  ///< of a pose
    int poses = 0;   ///< since then
  };

  struct Motions {
    std::vector<HandleMotion> handles;
    double fraction = 1;
  };

  void make_cells(int threads);
  void set(const std::vector<HandleMotion>& handles, double fraction);
  void apply(const std::vector<HandleMotion>& handles, double fraction);
  void start(bool quick);
  void rotate();
  void correct(double accuracy);
  void advance();
  void settle();
  void stop_at_contact();
  ContactReport contact_report() const;
  void collect(Points& positions);
  ThreadPool& pool();

  std::shared_ptr<const RestPose> rest_;
  EditSettings settings_;
  StepOptions options_;
  Preparation preparation_;
  std::optional<PoseSymmetry> symmetry_;
  std::unique_ptr<CellModel> cells_;
  EditConstraints constraints_;     // of the last frame or pose
  Motions motions_;                 // likewise, with contacts
  std::optional<ThreadPool> pool_;  // of frames until there is a system

  // Of the system.
  std::shared_ptr<const LaplacianSystem> system_;
  std::unique_ptr<CorrectionStep> step_;
  std::unique_ptr<FrameRotations> frame_rotations_;  // with EditMethod::Paper
  std::unique_ptr<ContactPose> contact_;             // with EditSettings::contact

  // Of the last frame or pose.
  Stage stage_ = Stage::None;
  PoseFigures figures_;
  Points displacement_;                                // d, from the rigidly moved pose
  Points positions_;                                   // of the last pose; no rows before
  std::vector<Matrix3> rotations_, rotations_before_;  // of the last two passes
  Extrapolation ahead_;
};

}  // namespace lapedit
