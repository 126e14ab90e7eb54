// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/patch_border.h"
#include "lapedit/mesh/vertex_grid.h"

namespace lapedit {
namespace {

struct Link {
  int to;
  double length;
  int from;
  bool operator<(const Link& other) const {
    return to != other.to ? to < other.to : length != other.length ? length < other.length : from < other.from;
  }
};

/// Returns the most frequent label, the lowest one of equally frequent labels.
int largest_label(const std::vector<int>& labels, int count) {
  std::vector<int> sizes(count, 0);
  for (const int label : labels) {
    ++sizes[label];
  }
  return static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

/// Finds the nearest vertices that a link may lead to: those of other pieces, and, from a border, those of a border of
/// the same piece that are near in space but far along the surface.
class LinkSearch {
 public:
  LinkSearch(const TriangleMesh& mesh, const IndexLists& neighbours, double gap, const std::vector<char>* allowed);
  std::vector<Link> links();

 private:
  static constexpr double kFar = 3;  // times the distance in space

  double along_surface(int from, int to);
  bool leads(int from, int to);

  const Points& points_;
  const IndexLists& neighbours_;
  double gap_;
  std::vector<int> labels_, usable_;
  std::vector<char> is_border_;
  Eigen::AlignedBox3d box_;  // vertices outside it have no other piece and no border in reach
  GeodesicSearch search_;
  int searched_ = -1;
};

LinkSearch::LinkSearch(const TriangleMesh& mesh, const IndexLists& neighbours, double gap,
                       const std::vector<char>* allowed)
    : points_(mesh.vertices),
      neighbours_(neighbours),
      gap_(gap),
      is_border_(mesh.vertices.rows(), 0),
      search_(PathGraph(neighbours, mesh.vertices)) {
  const int largest = largest_label(labels_, connected_components(neighbours, labels_));
  for (const auto& [a, b] : single_edges({mesh.faces.data(), mesh.faces.data() + mesh.faces.size()})) {
    is_border_[a] = is_border_[b] = 1;
  }
  for (int v = 0; v < static_cast<int>(points_.rows()); ++v) {
    if (neighbours[v].size() > 0 && (!allowed || (*allowed)[v]) && points_.row(v).allFinite()) {
      usable_.push_back(v);
      if (labels_[v] != largest || is_border_[v]) {
        box_.extend(points_.row(v).transpose());
      }
    }
  }
  const Vector3 margin = Vector3::Constant(gap);
  box_ = Eigen::AlignedBox3d(box_.min() - margin, box_.max() + margin);
}

double LinkSearch::along_surface(int from, int to) {
  if (searched_ != from) {
    search_.run({from}, kFar * gap_);
    searched_ = from;
  }
  return search_.distance(to);
}

bool LinkSearch::leads(int from, int to) {
  if (labels_[from] != labels_[to]) {
    return true;
  }
  const IndexLists::Row ring = neighbours_[from];
  return is_border_[from] && is_border_[to] && from != to && !std::binary_search(ring.begin(), ring.end(), to) &&
         along_surface(from, to) > kFar * (points_.row(from) - points_.row(to)).norm();
}

std::vector<Link> LinkSearch::links() {
  const VertexGrid grid(points_, usable_);
  std::vector<Link> links;
  Checkpoints checkpoints;
  for (const int v : usable_) {
    checkpoints();
    const Vector3 position = points_.row(v).transpose();
    const int to = box_.contains(position) ? grid.nearest(position, gap_, [&](int w) { return leads(v, w); }) : -1;
    if (to >= 0) {
      links.push_back({to, (points_.row(to).transpose() - position).norm(), v});
    }
  }
  return links;
}

}  // namespace

IndexLists with_edges(const IndexLists& neighbours, const std::vector<std::pair<int, int>>& edges) {
  IndexLists linked;
  linked.offsets.reserve(neighbours.offsets.size());
  linked.values.reserve(neighbours.values.size() + edges.size());
  auto edge = edges.begin();
  Checkpoints checkpoints;
  for (int v = 0; v < neighbours.rows(); ++v) {
    checkpoints();
    const auto first = linked.values.size();
    linked.values.insert(linked.values.end(), neighbours[v].begin(), neighbours[v].end());
    for (; edge != edges.end() && edge->first == v; ++edge) {
      linked.values.push_back(edge->second);
    }
    std::sort(linked.values.begin() + static_cast<std::ptrdiff_t>(first), linked.values.end());
    linked.offsets.push_back(static_cast<int>(linked.values.size()));
  }
  return linked;
}

IndexLists linked_neighbours(const TriangleMesh& mesh, const IndexLists& neighbours, double gap,
                             const std::vector<char>* allowed) {
  if (!(gap > 0 && std::isfinite(gap))) {
    throw EditError(ErrorCause::BadParameter, "Pieces are to be connected over a gap of " + number_text(gap) +
                                                  ": give a finite length greater than 0, or 0 to connect none.")
        .at("region.connect");
  }
  std::vector<Link> links = LinkSearch(mesh, neighbours, gap, allowed).links();
  std::sort(links.begin(), links.end());
  std::vector<std::pair<int, int>> entries;
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (k < kMostLinks || links[k - kMostLinks].to != links[k].to) {
      entries.emplace_back(links[k].from, links[k].to);
      entries.emplace_back(links[k].to, links[k].from);
    }
  }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  return with_edges(neighbours, entries);
}

}  // namespace lapedit
