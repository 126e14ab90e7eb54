// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lapedit/fit/scan.h"

namespace lapedit {

/// Pairs that draw the vertices of a template to a scan: each vertex with the nearest point of the scan, and samples of
/// the scan with the nearest points of the template, which reach vertices that the first kind does not. Rejects pairs
/// at the end of a surface, pairs whose normals are more than 60 degrees apart, and gradually pairs that are more than
/// five times as far apart as most.
class Correspondences {
 public:
  /// Template and scan must outlive the object. @param free  per vertex: whether it may be drawn
  /// @param distance  up to which pairs count fully, in units of the scan's size; 0: from the distances
  /// @param borders   whether the template's border is drawn to that of the scan
  Correspondences(const Scan& scan, const SurfaceIndex& surface, std::vector<char> free, double distance, bool borders);

  /// Lets the scan draw a vertex from now on.
  void draw(int vertex) { free_[static_cast<std::size_t>(vertex)] = 1; }

  /// Finds the pairs of the template's positions. @param least  lower limit of the automatic distance
  /// @param part  fraction of vertices and samples to search for; equal fractions select the same ones. The weights are
  /// divided by it
  void update(double least, double part, ThreadPool& pool);

  /// Treats the scan's normals as reversed if more than twice as many pairs have opposite normals as equal ones,
  /// unless it is known to be outward: of a thin shell its inner side may be nearer.
  /// @return the fraction of these pairs that contradicts the decision
  double turn_normals(ThreadPool& pool);
  bool reversed() const { return side_ < 0; }

  const Eigen::VectorXd& weights() const { return weights_; }  ///< per vertex, 0 (no partner) to 1 / part
  const Points& pulls() const { return pulls_; }               ///< displacement to the partner, where there is a weight

  /// Returns the distances of the pairs of weight 0.5 or more, from template to scan or, with `back`, the reverse.
  const std::vector<double>& distances(bool back) const { return back ? back_.distances : forward_.distances; }
  /// Returns the fraction of the free vertices or, with `back`, of the scan's samples that have such a pair.
  double matched(bool back) const;
  /// Returns the RMS distance of all samples of the scan from the template, also of those without a pair.
  double uncovered() const;
  /// Returns the fraction of the template's pairs whose points of the scan are near to another part of the template
  /// too.
  /// @param rest  the template before the fit. @param away  distance of parts there
  double doubled(const Points& rest, double away, ThreadPool& pool) const;

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
  std::vector<std::uint32_t> rank_;  // of the vertices by position
  double given_;
  std::unique_ptr<const SurfaceIndex> border_;  // edges at the end of the scan, if the template's border is drawn there
  double side_ = 1;                             // -1: the scan's normals are reversed
  SurfaceSamples samples_;
  Direction forward_, back_;
  Eigen::VectorXd weights_;
  Points pulls_;
};

}  // namespace lapedit
