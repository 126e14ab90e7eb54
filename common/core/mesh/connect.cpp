// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "lapedit/base/refuse.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"
#include "lapedit/mesh/visibility.h"

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

/// Finds the nearest vertices that a link may lead to: those of other pieces, from a border those of a border of the
/// same piece that are near in space but far along the surface, and those on the other side of a wall.
class LinkSearch {
 public:
  LinkSearch(const TriangleMesh& mesh, const CompressedRows& neighbours, double gap, const std::vector<char>* allowed);
  std::vector<Link> links();

 private:
  static constexpr double kFar = 3;  // times the distance in space
  // A border is searched for its own piece as far as this number of vertices goes.
  static constexpr std::size_t kMostReached = 2048;

  void find_walls();
  VertexTree::Found across_border(int v, const VertexTree& borders, double limit);
  int across_wall(int v, const VertexTree& tree);

  const TriangleMesh& mesh_;
  const Points& points_;
  const CompressedRows& neighbours_;
  double gap_;
  std::vector<int> labels_, usable_, borders_;
  std::vector<char> is_border_, is_open_;  // per vertex; per label: whether it is a sheet
  Eigen::AlignedBox3d box_;                // vertices outside it have no other piece and no border in reach
  GeodesicSearch search_;
  std::size_t pairs_ = 0;  // of vertices that links() looked at
  TriangleMesh walls_;     // faces of closed pieces in reach
  std::optional<Visibility> rays_;
  Points inwards_;  // normals
};

LinkSearch::LinkSearch(const TriangleMesh& mesh, const CompressedRows& neighbours, double gap,
                       const std::vector<char>* allowed)
    : mesh_(mesh),
      points_(mesh.vertices),
      neighbours_(neighbours),
      gap_(gap),
      is_border_(mesh.vertices.rows(), 0),
      search_(PathGraph(neighbours, mesh.vertices)) {
  const int count = connected_components(neighbours, labels_);
  const int largest = largest_label(labels_, count);
  std::vector<double> edges(count, 0), faces(count, 0);  // edges of borders
  for (const auto& [a, b] : single_edges({mesh.faces.data(), mesh.faces.data() + mesh.faces.size()})) {
    is_border_[a] = is_border_[b] = 1;
    ++edges[labels_[a]];
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    ++faces[labels_[mesh.faces(f, 0)]];
  }
  // A sheet of n equal triangles has more than sqrt(5 n) edges at its border, so that a piece with few has holes.
  is_open_.resize(count);
  for (int k = 0; k < count; ++k) {
    is_open_[k] = edges[k] * edges[k] > faces[k];
  }
  for (int v = 0; v < static_cast<int>(points_.rows()); ++v) {
    if (neighbours[v].size() > 0 && (!allowed || (*allowed)[v]) && points_.row(v).allFinite()) {
      usable_.push_back(v);
      if (is_border_[v]) {
        borders_.push_back(v);
      }
      if (labels_[v] != largest || is_border_[v]) {
        box_.extend(points_.row(v).transpose());
      }
    }
  }
  const Vector3 margin = Vector3::Constant(gap);
  box_ = Eigen::AlignedBox3d(box_.min() - margin, box_.max() + margin);
  find_walls();
}

/// Prepares the search through closed pieces, whose normals point outwards if they enclose a positive volume together.
/// A piece whose faces disagree counts alone, after some were flipped.
void LinkSearch::find_walls() {
  Eigen::AlignedBox3d reach = bounding_box(points_, usable_);
  const Vector3 margin = Vector3::Constant(2 * gap_), centre = reach.center();
  reach = Eigen::AlignedBox3d(reach.min() - margin, reach.max() + margin);
  Faces faces = mesh_.faces;
  const std::vector<char> flips = flips_of(paired_sides(static_cast<int>(points_.rows()), faces), faces);
  std::vector<double> volumes(is_open_.size(), 0);
  std::vector<char> disagrees(is_open_.size(), 0);
  double volume = 0;
  std::vector<int> near;
  for (int f = 0; f < static_cast<int>(mesh_.faces.rows()); ++f) {
    const Vector3 a = points_.row(mesh_.faces(f, 0)), b = points_.row(mesh_.faces(f, 1)),
                  c = points_.row(mesh_.faces(f, 2));
    const double part = (a - centre).dot((b - a).cross(c - a));
    const int label = labels_[mesh_.faces(f, 0)];
    if (flips[f]) {
      faces.row(f).reverseInPlace();
      disagrees[label] = 1;
    }
    if (!is_open_[label] && std::isfinite(part)) {
      volumes[label] += flips[f] ? -part : part;
      if (reach.intersects(face_box(points_, mesh_.faces, f))) {
        near.push_back(f);
      }
    }
  }
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    volume += disagrees[k] ? 0 : volumes[k];
  }
  const bool has_sides = volume != 0 || std::find(disagrees.begin(), disagrees.end(), 1) != disagrees.end();
  if (has_sides && !near.empty()) {
    vertex_normals(points_, faces, inwards_);
    for (int v = 0; v < static_cast<int>(points_.rows()); ++v) {
      inwards_.row(v) *= (disagrees[labels_[v]] ? volumes[labels_[v]] : volume) > 0 ? -1 : 1;
    }
    walls_ = {points_, gather(mesh_.faces, near)};
    rays_.emplace(walls_);
  }
}

/// Returns the nearest border vertex of the same piece that is far along the surface. @param limit  squared
VertexTree::Found LinkSearch::across_border(int v, const VertexTree& borders, double limit) {
  const std::vector<int>& reached = search_.run({v}, kFar * std::sqrt(limit), nullptr, kMostReached);
  pairs_ += reached.size();
  if (reached.size() == kMostReached) {  // vertices that it did not reach are farther along the surface than this
    const double radius = search_.distance(reached.back()) / kFar;
    limit = std::min(limit, radius * radius);
  }
  const CompressedRows::Row ring = neighbours_[v];
  return borders.nearest(
      points_.row(v).transpose(), limit, VertexTree::kNoLabel,
      [&](int w) {
        return labels_[w] == labels_[v] && w != v && !std::binary_search(ring.begin(), ring.end(), w) &&
               search_.distance(w) > kFar * (points_.row(v) - points_.row(w)).norm();
      },
      pairs_);
}

/// Returns the vertex on the other side of a wall, -1 if there is none: a ray through the inside meets a surface of the
/// opposite direction, and the wall is at least as wide on each side as it is thick, unlike a limb.
int LinkSearch::across_wall(int v, const VertexTree& tree) {
  constexpr double kOpposite = -0.5;
  const Vector3 position = points_.row(v).transpose(), inwards = inwards_.row(v).transpose();
  const auto hit = rays_->first_hit({position, inwards}, std::nextafter(gap_, kUnreached), v);
  if (!hit || labels_[hit->vertex] != labels_[v] || inwards_.row(hit->vertex).dot(inwards) > kOpposite) {
    return -1;
  }
  const double thickness = (hit->point - position).norm();
  const Vector3 middle = (hit->point + position) / 2;
  for (const int w : neighbours_[v]) {
    const Vector3 edge = points_.row(w).transpose() - position;
    if (rays_->first_hit({middle, (edge - edge.dot(inwards) * inwards).normalized()}, thickness)) {
      return -1;
    }
  }
  const int to =
      tree.nearest(
              hit->point, gap_ * gap_, VertexTree::kNoLabel,
              [&](int w) { return labels_[w] == labels_[v] && inwards_.row(w).dot(inwards) < kOpposite; }, pairs_)
          .vertex;
  const CompressedRows::Row ring = neighbours_[v];
  const bool is_link = to >= 0 && !std::binary_search(ring.begin(), ring.end(), to) &&
                       (points_.row(to).transpose() - position).norm() <= gap_;
  return is_link ? to : -1;
}

std::vector<Link> LinkSearch::links() {
  const VertexTree tree(points_, usable_, &labels_), borders(points_, borders_, &labels_);
  std::vector<Link> links;
  Checkpoints checkpoints;
  const auto add = [&](int from, int to) {
    if (to >= 0) {
      links.push_back({to, (points_.row(to) - points_.row(from)).norm(), from});
    }
  };
  const auto any = [](int) { return true; };
  for (const int v : usable_) {
    const std::size_t before = pairs_;
    const Vector3 position = points_.row(v).transpose();
    if (box_.contains(position)) {
      VertexTree::Found to = tree.nearest(position, gap_ * gap_, labels_[v], any, pairs_);
      if (is_border_[v]) {
        const VertexTree::Found own = across_border(v, borders, to.squared);
        const bool is_nearer = own.squared < to.squared || to.vertex < 0 || own.vertex < to.vertex;
        to = own.vertex >= 0 && is_nearer ? own : to;
      }
      add(v, to.vertex);
    }
    if (rays_ && !is_open_[labels_[v]]) {
      add(v, across_wall(v, tree));
    }
    checkpoints(1 + static_cast<int>(pairs_ - before));
  }
  return links;
}

}  // namespace

CompressedRows with_edges(const CompressedRows& neighbours, const std::vector<std::pair<int, int>>& edges) {
  CompressedRows linked;
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

CompressedRows linked_neighbours(const TriangleMesh& mesh, const CompressedRows& neighbours, double gap,
                                 const std::vector<char>* allowed) {
  if (!(gap > 0 && std::isfinite(gap))) {
    refuse_edit(ErrorCause::BadParameter, {"region.connect"}, "Pieces are to be connected over a gap of ", gap,
                ": give a finite length greater than 0, or 0 to connect none.");
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
  return with_edges(neighbours, sorted_set(std::move(entries)));
}

}  // namespace lapedit
