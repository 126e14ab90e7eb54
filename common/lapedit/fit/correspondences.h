// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "lapedit/fit/fit_constants.h"
#include "lapedit/fit/scan.h"

namespace lapedit {

/// How the vertices of a template are drawn to a scan: nearest points of the scan, and nearest points of the template
/// to samples of the scan, which reach template vertices whose own nearest points do not. Rejected are pairs at the end
/// of a surface, those whose normals are more than 60 degrees apart, and gradually those that are more than five times
/// as far apart as most.
class Correspondences {
 public:
  /// Template and scan must outlive the object. @param free  per vertex: whether it may be drawn
  /// @param distance  up to which pairs count fully, in units of the scan's size; 0: from the distances
  Correspondences(const Scan& scan, const SurfaceIndex& surface, std::vector<char> free, double distance,
                  const FitConstants& constants);

  /// Finds the pairs of the template's positions. @param least  of the automatic distance
  /// @param part  fraction of vertices and samples to search for, the same for the same fraction; pairs found count
  /// more
  void update(double least, double part, ThreadPool& pool);

  /// Takes the scan's normals as reversed if most pairs are. @return the fraction of the others, of those that decide
  /// @param between  called from time to time; an exception of it reaches the caller
  double turn_normals(ThreadPool& pool, const std::function<void()>& between);
  bool reversed() const { return side_ < 0; }

  const Eigen::VectorXd& weights() const { return weights_; }  ///< per vertex, 0 (no partner) to 1 over the fraction
  const Points& pulls() const { return pulls_; }               ///< displacement to the partner, where there is a weight

  /// Distances of the pairs that count at least half, from template to scan and back.
  const std::vector<double>& distances(bool back) const { return back ? back_.distances : forward_.distances; }
  /// Fraction of the free vertices, or of the samples of the scan, that such a pair has.
  double matched(bool back) const;

 private:
  struct Pair {
    NearestPoint at;
    Vector3 pull = Vector3::Zero();  // before weighting
    double distance = -1;            // -1: rejected, or not searched
  };
  struct Direction {
    std::vector<Pair> pairs;
    std::vector<double> distances;
    double full = 0;
  };
  void look(const SurfaceIndex& on, const Vector3& point, const Vector3& normal, Pair& pair) const;
  void gather(Direction& direction, double least);

  const Scan& scan_;
  const SurfaceIndex& surface_;
  std::vector<char> free_;
  double given_;
  FitConstants with_;
  double side_ = 1;  // -1: the scan's normals are reversed
  SurfaceSamples samples_;
  Direction forward_, back_;
  Eigen::VectorXd weights_;
  Points pulls_;
};

}  // namespace lapedit
