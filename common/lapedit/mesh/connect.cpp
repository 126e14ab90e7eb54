// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
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

/// Links from each vertex that has another piece in reach; of the largest piece only vertices in the other pieces' box
/// are examined.
std::vector<Link> nearest_links(const Points& points, const IndexLists& neighbours, double gap,
                                const std::vector<char>* allowed) {
  std::vector<int> labels, usable;
  const int count = connected_components(neighbours, labels);
  std::vector<Link> links;
  if (count < 2) {
    return links;
  }
  const int largest = largest_label(labels, count);
  Eigen::AlignedBox3d box;
  for (int v = 0; v < static_cast<int>(points.rows()); ++v) {
    if (neighbours[v].size() > 0 && (!allowed || (*allowed)[v]) && points.row(v).allFinite()) {
      usable.push_back(v);
      if (labels[v] != largest) {
        box.extend(points.row(v).transpose());
      }
    }
  }
  const VertexGrid grid(points, usable);
  const Vector3 margin = Vector3::Constant(gap);
  box = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
  for (const int v : usable) {
    const Vector3 position = points.row(v).transpose();
    if (labels[v] == largest && !box.contains(position)) {
      continue;
    }
    const int to = grid.nearest(position, gap, [&](int w) { return labels[w] != labels[v]; });
    if (to >= 0) {
      links.push_back({to, (points.row(to).transpose() - position).norm(), v});
    }
  }
  return links;
}

}  // namespace

IndexLists linked_neighbours(const TriangleMesh& mesh, const IndexLists& neighbours, double gap,
                             const std::vector<char>* allowed) {
  if (!(gap > 0 && std::isfinite(gap))) {
    throw EditError(ErrorCause::BadParameter, "Pieces are to be connected over a gap of " + number_text(gap) +
                                                  ": give a finite length greater than 0, or 0 to connect none.");
  }
  std::vector<Link> links = nearest_links(mesh.vertices, neighbours, gap, allowed);
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
  IndexLists linked;
  linked.offsets.reserve(neighbours.offsets.size());
  linked.values.reserve(neighbours.values.size() + entries.size());
  auto entry = entries.begin();
  for (int v = 0; v < neighbours.rows(); ++v) {
    const auto first = linked.values.size();
    linked.values.insert(linked.values.end(), neighbours[v].begin(), neighbours[v].end());
    for (; entry != entries.end() && entry->first == v; ++entry) {
      linked.values.push_back(entry->second);
    }
    std::sort(linked.values.begin() + static_cast<std::ptrdiff_t>(first), linked.values.end());
    linked.offsets.push_back(static_cast<int>(linked.values.size()));
  }
  return linked;
}

}  // namespace lapedit
