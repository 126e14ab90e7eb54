// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/fit/scan.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Components of a template that its scan does not show, such as eyes behind lids and teeth. A fit moves each by a
/// similarity, that of the surface around it.
class HiddenPieces {
 public:
  /// Takes all components without landmarks and anchors whose area is below a quarter of the largest component's.
  /// @param surface   the region, aligned with the scan. @param keep  vertices of components that are not hidden
  /// @param excluded  vertices that the scan must not draw: their pieces stay hidden
  HiddenPieces(const Region& region, const SurfaceIndex& surface, const std::vector<int>& keep,
               const std::vector<int>& excluded);

  /// Removes the pieces that the scan shows: most of their vertices are much nearer to their nearest points of the scan
  /// than the other components are. @return their vertices
  std::vector<int> take_shown(const SurfaceIndex& surface, const Scan& scan);

  /// Returns whether a vertex is of a component that was taken, even if it is no longer hidden.
  bool hides(int vertex) const { return is_hidden_[static_cast<std::size_t>(vertex)] != 0; }
  int count() const { return static_cast<int>(pieces_.size()); }
  /// Gives the pieces the positions to which the surface around them takes them. @param scaled  whether their size may
  /// change
  void follow(const Points& rest, bool scaled, Points& points) const;

 private:
  struct Piece {
    std::vector<int> vertices, around;
    Eigen::VectorXd weights;  // of the vertices around
    bool is_excluded = false;
  };
  void find_around(const Points& rest, Piece& piece) const;

  std::vector<char> is_hidden_;  // per vertex
  std::vector<Piece> pieces_;
};

}  // namespace lapedit
