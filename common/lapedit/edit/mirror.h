// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/edit/edit_step.h"

namespace lapedit {

/// Handle groups with their mirror images.
///
/// The image of a set of vertices are the vertices nearest to its mirrored places, and those whose own mirrored places
/// are nearest to one of the set, so that an image is as dense as the surface there; that of a lone vertex is one
/// vertex. A vertex that is in a given group stays in it and is in no image. A group that its own image meets becomes
/// one with it: what of its transform is not the same on both sides falls away. Of a translation the part along the
/// plane stays, of a rotation the turn about the plane's normal, of a scale all of it, about a centre in the plane; of
/// a matrix with the polar decomposition L = Q P the same of way and turn, and (P + S P S) / 2. Any other group has
/// an image that moves by S T S: the translation mirrored, the axis mirrored and turned round for the same degrees,
/// the centre mirrored, the same scale.
class MirroredHandles {
 public:
  /// @param groups  mesh vertex numbers, ascending without duplicates; @param weights  of each group, or none
  /// @throws EditError (NoHandle, BadIndex; BadParameter if a vertex has no vertex near its mirrored place)
  /// Cost: O(vertices), once.
  MirroredHandles(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups, const MirrorPlane& plane,
                  const std::vector<std::vector<double>>& weights = {});

  /// The given groups in their order, and behind them the images.
  const std::vector<std::vector<int>>& groups() const { return groups_; }
  const std::vector<std::vector<double>>& weights() const { return weights_; }
  /// The given group that each of them belongs to.
  const std::vector<int>& source() const { return source_; }

  /// What group g does, from the transform of each given group. @throws EditError as resolve()
  HandleTransform transform(std::size_t g, const std::vector<HandleTransform>& given) const;
  /// All of them resolved, with the bits that the runner's have. Nothing is allocated after the first call.
  void maps(const std::vector<HandleTransform>& given, std::vector<HandleMotion>& maps) const;

 private:
  HandleTransform symmetric(const HandleTransform& given, const Vector3& centre) const;
  HandleTransform reflected(const HandleTransform& given, const Vector3& centre) const;

  Vector3 normal_;
  Affine mirror_;
  std::vector<std::vector<int>> groups_;
  std::vector<std::vector<double>> weights_;
  std::vector<int> source_;
  std::vector<char> symmetric_;     // of each given group
  std::vector<Vector3> centroids_;  // of groups_
};

/// The region with what is mirrored: sets of vertices and kept anchors take their images in, as far as there are any; a
/// radius and components follow from the handles. @throws EditError (BadIndex)
RegionSpec mirrored(const TriangleMesh& mesh, const RegionSpec& region, const MirrorPlane& plane);

/// The step without its key `mirror`, written out for a mesh: equal but for StepProblem::mirror.
/// @throws EditError as the above
EditStep mirrored(const TriangleMesh& mesh, const EditStep& step);

/// Averages poses of a region that is its own mirror image, so that they are it to the last bits: cells and
/// factorisations follow the numbering of the vertices and are not symmetric.
class PoseSymmetry {
 public:
  /// Does nothing where a vertex of the region has no twin in it, at its mirrored place but for 1e-6 of the mesh's
  /// diagonal.
  PoseSymmetry(const TriangleMesh& mesh, const Region& region, const MirrorPlane& plane);
  bool applies() const { return !twin_.empty(); }
  void apply(Points& places) const;  ///< size() x 3; allocates nothing

 private:
  Points rest_;
  Matrix3 mirror_;
  std::vector<int> twin_;  // local; empty: not symmetric
};

}  // namespace lapedit
