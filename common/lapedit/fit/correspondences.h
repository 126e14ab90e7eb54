// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/fit/scan.h"

namespace lapedit {

/// Shares of tangential displacement that a surface without landmarks leaves open.
constexpr double kTangential = 0.2;

/// How the vertices of a template are drawn to a scan: nearest points of the scan, and nearest points of the template
/// to samples of the scan, which reach what is drawn to nothing from its own side. Rejected are pairs at the end of a
/// surface, those whose normals are more than 60 degrees apart, and gradually those that are more than five times as
/// far apart as most.
class Correspondences {
 public:
  /// Template and scan must outlive the object. @param surface  the template, whose positions the caller moves; its
  /// normals are recomputed. @param free  per vertex: whether it may be drawn
  /// @param distance  up to which pairs count fully, in units of the scan's size; 0: from the distances
  Correspondences(const Scan& scan, SurfaceShape& surface, std::vector<char> free, double distance);

  /// Finds the pairs of the template's positions. @param least  of the automatic distance
  void update(double least, ThreadPool& pool);

  /// Takes the scan's normals as reversed if most pairs are.
  /// @return whether it does. Call it after the alignment
  bool turn_normals(ThreadPool& pool);

  const Eigen::VectorXd& weights() const { return weights_; }  ///< per vertex, 0 (no partner) to 1
  const Points& pulls() const { return pulls_; }               ///< displacement to the partner, where there is a weight

  /// Distances of the pairs that count at least half, from template to scan and back.
  const std::vector<double>& distances(bool back) const { return back ? back_distances_ : distances_; }
  /// Fraction of the free vertices, or of the samples of the scan, that such a pair has.
  double matched(bool back) const;

 private:
  struct Pair {
    NearestPoint at;
    Vector3 pull;          // before weighting
    double distance = -1;  // -1: rejected
  };
  double full_distance(const std::vector<Pair>& pairs, double least) const;
  void look_forward(ThreadPool& pool);
  void look_back(ThreadPool& pool);

  const Scan& scan_;
  SurfaceShape& surface_;
  std::vector<char> free_;
  double given_;
  double side_ = 1;  // -1: the scan's normals are reversed
  SurfaceTree tree_;
  SurfaceSamples samples_;
  std::vector<Pair> forward_, back_;
  Eigen::VectorXd weights_;
  Points pulls_;
  std::vector<double> distances_, back_distances_;
};

}  // namespace lapedit
