// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/edit/edit_step.h"

namespace lapedit {

/// Handle groups with their mirror images.
///
/// The image of a vertex set consists of the vertices nearest to its mirrored positions, and of those whose mirrored
/// positions are nearest to a vertex of the set, so that an image is as dense as the surface there; the image of a
/// single vertex is one vertex. Vertices of given groups are in no image. A group that meets its own image is merged
/// with it, and keeps the symmetric part of its transform: of a translation the part along the plane, of a rotation the
/// rotation about the plane's normal, of a scale all of it, about a centre in the plane; of a matrix with the polar
/// decomposition L = Q P the same parts of translation and rotation, and (P + S P S) / 2. Any other group has an image
/// that moves by S T S: translation and centre are mirrored, the axis is mirrored and reversed, the scale is equal. The
/// displacements of targets are mirrored. If a vertex and its image are in one group, each moves by the mean of its own
/// displacement and the mirrored one of the other.
class MirroredHandles {
 public:
  /// @param groups  mesh vertex numbers, ascending without duplicates; @param weights  of each group, or none
  /// @throws EditError (NoHandle, BadIndex; BadParameter if a vertex has no vertex near its mirrored position)
  /// Cost: O(vertices log vertices), once.
  MirroredHandles(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups, const MirrorPlane& plane,
                  const std::vector<std::vector<double>>& weights = {})
      : MirroredHandles(MirrorImages(mesh, plane), groups, plane, weights) {}
  /// @param images  of the mesh across the plane
  MirroredHandles(const MirrorImages& images, const std::vector<std::vector<int>>& groups, const MirrorPlane& plane,
                  const std::vector<std::vector<double>>& weights);

  /// Returns the given groups in their order, followed by the images.
  const std::vector<std::vector<int>>& groups() const { return groups_; }
  const std::vector<std::vector<double>>& weights() const { return weights_; }
  /// Returns the given group of each of them.
  const std::vector<int>& source() const { return source_; }

  /// Returns the motion of group g from the transforms of the given groups. @throws EditError as resolve()
  HandleTransform transform(std::size_t g, const std::vector<HandleTransform>& given) const;
  /// Computes the targets of the vertices of group g from those of the given groups, which have to be finite; empty if
  /// there are none. Allocates nothing for as many targets as before.
  void targets(std::size_t g, const std::vector<std::vector<Vector3>>& given, std::vector<Vector3>& targets) const;
  /// Computes the motions of all groups, without targets, with the same bits as motions_of() of the mirrored step.
  /// Nothing is allocated after the first call.
  void maps(const std::vector<HandleTransform>& given, std::vector<HandleMotion>& maps) const;

 private:
  HandleTransform symmetric(const HandleTransform& given, const Vector3& centre) const;
  HandleTransform reflected(const HandleTransform& given, const Vector3& centre) const;

  /// Indices, in the given group, of a vertex of groups_ and of the vertex whose image it is; -1: not in that group.
  struct Twin {
    int self, original;
  };

  Vector3 normal_;
  Affine mirror_;
  std::vector<std::vector<int>> groups_;
  std::vector<std::vector<double>> weights_;
  std::vector<int> source_;
  std::vector<char> symmetric_;     // of each given group
  std::vector<Vector3> centroids_;  // of groups_
  std::vector<std::vector<Twin>> twins_;
  std::vector<Points> rest_, given_rest_;  // of groups_ and of the given ones
};

/// Returns an equivalent step without `mirror` for a mesh, except for StepProblem::mirror. @throws EditError as
/// mirrored region and handles do
EditStep mirrored(const TriangleMesh& mesh, const EditStep& step);

}  // namespace lapedit
