// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_stretch.h"

#include <algorithm>
#include <cmath>

namespace lapedit {
namespace {

constexpr int kVerticesPerPiece = 4096;

}  // namespace

VertexStretch::VertexStretch(const Region& region, const Points& rest)
    : stretch_(static_cast<std::size_t>(region.size()), 0.0F), pool_(region.size() < 4 * kVerticesPerPiece ? 1 : 0) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(2 * static_cast<std::size_t>(region.faces.size()));
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = region.faces(f, k), b = region.faces(f, (k + 1) % 3);
      if (a != b) {
        edges.emplace_back(a, b);
        edges.emplace_back(b, a);
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  offsets_.assign(stretch_.size() + 1, 0);
  for (const auto& [a, b] : edges) {
    ++offsets_[a + 1];
    ends_.push_back(b);
    const double length = (rest.row(region.mesh_vertex[a]) - rest.row(region.mesh_vertex[b])).stableNorm();
    inverse_rest_.push_back(static_cast<float>(length > 0 && std::isfinite(1 / length) ? 1 / length : 0));
  }
  for (std::size_t i = 0; i < stretch_.size(); ++i) {
    offsets_[i + 1] += offsets_[i];
  }
}

const std::vector<float>& VertexStretch::of(const Points& pose) {
  in_pieces(pool_, static_cast<int>(stretch_.size()), kVerticesPerPiece, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      float most = 0;
      for (int e = offsets_[i]; e < offsets_[i + 1]; ++e) {
        const auto length = static_cast<float>((pose.row(i) - pose.row(ends_[e])).norm());
        const float ratio = length * inverse_rest_[e];
        if (inverse_rest_[e] > 0 && std::isfinite(ratio)) {
          const float change = ratio >= 1 ? std::min(ratio - 1, kMost) : std::max(1 - 1 / ratio, -kMost);
          most = std::abs(change) > std::abs(most) ? change : most;
        }
      }
      stretch_[i] = most;
    }
  });
  return stretch_;
}

}  // namespace lapedit
