// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <vector>

#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/laplacian_system.h"
#include "lapedit/mesh/contact_search.h"

namespace lapedit {

/// Keeps a region from crossing itself and the surface around it. Poses x follow the plain poses x0 of the handles'
/// paths. Each minimises
///
///     |x - x0|_A^2 / 2 + s / 2 sum_k max(0, gap_k - n_k . sum_j w_kj x_j)^2
///
/// over contacts k, linear in x, with the edit's matrix A. The dual of this problem needs A^-1 at the contacts'
/// vertices alone: products of halves of columns, which the existing factor gives. A pose moves no farther than sweeps
/// find safe, so nothing crosses, even if the contacts do not let it reach x0. Where the handles would have to cross
/// something, each group yields as a whole: A loses what keeps it from being translated. A group that turns stops where
/// that would tear the surface.
class ContactPose {
 public:
  /// @param mesh  not kept. O(faces log faces)
  ContactPose(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest);
  ~ContactPose();

  /// Returns whether a pose crosses nothing that it does not cross at rest. Cost: less than a settled pose.
  /// @param pose  size() x 3, relative to the rest pose's origin, as all poses here
  bool is_clear(const Points& pose, ThreadPool& pool);
  /// Follows plain poses of parts of the path, in equal steps from the rest pose; is_clear() was asked for the whole.
  /// Those before the last clear one need not be made. Cost: some settled poses. @throws EditError (Cancelled)
  void follow(const LaplacianSystem& system, const EditConstraints& constraints, int steps,
              const std::function<Points(double)>& plain);
  /// Moves on to the pose at a better plain pose of the same handles, unless that jams or stretches the surface.
  void refine(const Points& plain);

  const Points& pose() const { return pose_; }
  int touching() const { return touching_; }     ///< pairs that press on each other
  int vertex() const { return vertex_; }         ///< of the mesh, at the pair that presses most
  double part() const { return part_; }          ///< 0 to 1, to which the path was followed
  bool converged() const { return converged_; }  ///< whether contacts do not jam there

 private:
  class Response;
  struct Stretch {
    double mean = 0, most = 0;
  };
  void number(Faces& faces);
  void set_resting(const Points& pose);
  void include(const Points& pose);
  Points whole(const Points& pose) const;
  bool add(std::vector<Contact> contacts);
  void update_contacts();
  Points goal(const Points& plain);
  Eigen::VectorXd pressures(const Eigen::VectorXd& missing, double stiffness) const;
  bool limit(Points& next) const;
  bool attempt(const Points& plain);
  bool approach(const Points& plain);
  void yield();
  Stretch stretch(const Points& pose) const;
  double excess(const Points& plain) const;
  double advance(const Points& plain);
  double stop_after(double from, double below, double above, const std::function<Points(double)>& plain);

  std::shared_ptr<const RestPose> rest_;
  Points vertices_;         // of the mesh, relative to the origin
  Faces resting_;           // faces of the mesh without a corner in the region
  std::vector<int> local_;  // per vertex of the mesh: of the surface, or -1
  std::unique_ptr<ContactSurface> surface_;
  Eigen::AlignedBox3d box_;       // that the surface's resting faces meet
  std::vector<int> mesh_vertex_;  // of the surface's vertices

  // Of the last pose.
  const LaplacianSystem* system_ = nullptr;
  const EditConstraints* constraints_ = nullptr;
  std::unique_ptr<Response> response_;
  std::vector<Contact> contacts_;
  std::vector<double> turning_;  // per group: 1 if it turns, 0 if it does not
  Points pose_;
  double part_ = 1, step_ = 0;  // largest motion of a step of the path
  int touching_ = 0, vertex_ = -1;
  bool converged_ = true, blocked_ = false;
};

}  // namespace lapedit
