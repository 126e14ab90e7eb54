// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/hidden_pieces.h"

#include <algorithm>
#include <cmath>

#include "lapedit/base/similarity.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

HiddenPieces::HiddenPieces(const Region& region, const SurfaceIndex& surface, const std::vector<int>& keep,
                           const std::vector<int>& excluded)
    : is_hidden_(static_cast<std::size_t>(region.size()), 0) {
  std::vector<int> labels;
  const int count = connected_components(region.neighbours, labels);
  const auto label_of = [&labels](int v) { return static_cast<std::size_t>(labels[static_cast<std::size_t>(v)]); };
  std::vector<double> areas(static_cast<std::size_t>(count), 0);
  const Eigen::VectorXd face = face_areas(surface.points(), surface.faces());
  for (Eigen::Index f = 0; f < face.size(); ++f) {
    areas[label_of(surface.faces()(f, 0))] += face[f];
  }
  constexpr double kSmall = 0.25;
  const double largest = *std::max_element(areas.begin(), areas.end());
  for (const int v : keep) {
    areas[label_of(v)] = largest;
  }
  std::vector<Piece> pieces(areas.size());
  for (int i = 0; i < region.size(); ++i) {
    if (areas[label_of(i)] < kSmall * largest) {
      is_hidden_[static_cast<std::size_t>(i)] = 1;
      pieces[label_of(i)].vertices.push_back(i);
    }
  }
  for (const int v : excluded) {
    pieces[label_of(v)].is_excluded = true;
  }
  for (Piece& piece : pieces) {
    if (!piece.vertices.empty()) {
      find_around(surface.points(), piece);
      pieces_.push_back(std::move(piece));
    }
  }
}

std::vector<int> HiddenPieces::take_shown(const SurfaceIndex& surface, const Scan& scan) {
  std::vector<int> taken;
  if (pieces_.empty()) {
    return taken;
  }
  Faces faces = surface.faces();
  keep_faces(faces, [&](Eigen::Index f) { return !hides(faces(f, 0)); });
  const SurfaceIndex others(surface.points(), std::move(faces));
  const auto is_shown = [&](const Piece& piece) {
    constexpr double kNearer = 0.25, kMost = 0.6;  // kNearer: squared
    std::size_t shown = 0;
    for (const int v : piece.vertices) {
      const NearestPoint at = scan.surface().nearest(surface.points().row(v).transpose());
      shown += at.squared < kNearer * others.nearest(scan.surface().position(at)).squared ? 1 : 0;
    }
    return static_cast<double>(shown) > kMost * static_cast<double>(piece.vertices.size());
  };
  const auto first = std::stable_partition(pieces_.begin(), pieces_.end(),
                                           [&](const Piece& p) { return p.is_excluded || !is_shown(p); });
  for (auto piece = first; piece != pieces_.end(); ++piece) {
    taken.insert(taken.end(), piece->vertices.begin(), piece->vertices.end());
  }
  pieces_.erase(first, pieces_.end());
  return taken;
}

/// Chooses the vertices that a piece follows: those that are not hidden, with weights that fall with the distance from
/// the ball about the piece.
void HiddenPieces::find_around(const Points& rest, Piece& piece) const {
  constexpr double kFall = 0.5, kNegligible = 1e-3;
  constexpr int kEnough = 30;
  const Points own = gather(rest, piece.vertices);
  const Eigen::RowVector3d centre = own.colwise().mean();
  const double radius = std::sqrt((own.rowwise() - centre).rowwise().squaredNorm().maxCoeff());
  std::vector<std::pair<double, int>> near;
  for (int i = 0; i < rest.rows(); ++i) {
    if (!hides(i)) {
      near.emplace_back(std::max(0.0, (rest.row(i) - centre).norm() - radius), i);
    }
  }
  const auto last = std::min(near.size(), static_cast<std::size_t>(kEnough)) - 1;
  std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(last), near.end());
  const double fall = kFall * radius + near[last].first;
  std::vector<double> weights;
  for (const auto& [distance, vertex] : near) {
    if (const double weight = std::exp(-distance * distance / (fall * fall)); weight > kNegligible) {
      piece.around.push_back(vertex);
      weights.push_back(weight);
    }
  }
  piece.weights = Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
}

void HiddenPieces::follow(const Points& rest, bool scaled, Points& points) const {
  for (const Piece& piece : pieces_) {
    const SimilarityMap map =
        best_similarity(gather(rest, piece.around), gather(points, piece.around), scaled ? 0 : 1, piece.weights);
    scatter(piece.vertices, map.all(gather(rest, piece.vertices)), points);
  }
}

}  // namespace lapedit
