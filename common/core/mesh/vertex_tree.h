// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/mesh/camera.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A binary tree of boxes over numbered items.
class BoxTree {
 public:
  static constexpr int kNoLabel = -1;
  struct Node {
    Eigen::AlignedBox3d box;
    int first;   // of the items in a leaf; -1: it has two children, the next node and `last`
    int last;    // end of the items in a leaf
    int label;   // of all items; kNoLabel: they have several
    int lowest;  // item
  };

  /// @param leaf      largest number of items in a leaf
  /// @param box_of    function: the finite box of an item, or its position
  /// @param label_of  function: the label of an item
  /// O(items log items).
  template <class BoxOf, class LabelOf>
  BoxTree(std::vector<int> items, int leaf, const BoxOf& box_of, const LabelOf& label_of) : items_(std::move(items)) {
    nodes_.reserve(4 * items_.size() / static_cast<std::size_t>(leaf));
    if (!items_.empty()) {
      build(0, static_cast<int>(items_.size()), leaf, box_of, label_of);
    }
  }

  const std::vector<Node>& nodes() const { return nodes_; }  ///< the first is the root
  const std::vector<int>& items() const { return items_; }   ///< in the order of the nodes

  /// Calls visit(item) for items in boxes that a ray meets before its end. Allocates nothing.
  /// @param last  the end, in units of the ray's direction, which visit() may change
  /// @return whether visit() returned true, which ends the search
  template <class Visit>
  bool along(const Ray& ray, const double& last, const Visit& visit) const {
    const Eigen::Array3d origin = ray.origin.array(), inverse = ray.direction.array().inverse();
    const auto meets = [&](const Eigen::AlignedBox3d& box) {
      const Eigen::Array3d at_min = (box.min().array() - origin) * inverse;
      const Eigen::Array3d at_max = (box.max().array() - origin) * inverse;
      const double enter = at_min.min(at_max).maxCoeff(), leave = at_min.max(at_max).minCoeff();
      return !(enter > leave || enter > last || leave < 0);  // NaN at the border: zero times infinity
    };
    int stack[kDeepest] = {0};
    int open = nodes_.empty() ? 0 : 1;
    while (open > 0) {
      const int next = stack[--open];
      const Node& node = nodes_[next];
      if (!meets(node.box)) {
        continue;
      }
      if (node.first < 0) {
        stack[open++] = node.last;
        stack[open++] = next + 1;
      } else if (std::any_of(items_.begin() + node.first, items_.begin() + node.last, visit)) {
        return true;
      }
    }
    return false;
  }

 private:
  friend class VertexTree;
  struct Open {
    double distance;
    int node;
  };
  static constexpr int kDeepest = 64;  // at most one entry per level remains

  template <class BoxOf, class LabelOf>
  int build(int first, int last, int leaf, const BoxOf& box_of, const LabelOf& label_of) {
    const auto number = nodes_.size();
    Node node;
    node.first = first;
    node.last = last;
    node.label = label_of(items_[first]);
    node.lowest = items_[first];
    for (int k = first; k < last; ++k) {
      const int item = items_[k];
      node.box.extend(box_of(item));
      node.label = label_of(item) == node.label ? node.label : kNoLabel;
      node.lowest = std::min(node.lowest, item);
    }
    nodes_.push_back(node);
    if (last - first > leaf) {
      Eigen::Index axis = 0;
      node.box.sizes().maxCoeff(&axis);
      const auto place = [&](int item) { return middle(box_of(item), axis); };
      const auto begin = items_.begin() + first, end = items_.begin() + last;
      // Halves of the box are found faster, and are nearly as good where they are balanced.
      const double half = middle(node.box, axis);
      auto split = std::partition(begin, end, [&](int item) { return place(item) < half; });
      if (3 * std::min(split - begin, end - split) < end - begin) {
        split = begin + (end - begin) / 2;
        std::nth_element(begin, split, end,
                         [&](int a, int b) { return std::pair(place(a), a) < std::pair(place(b), b); });
      }
      const int at = static_cast<int>(split - items_.begin());
      build(first, at, leaf, box_of, label_of);
      nodes_[number].first = -1;
      nodes_[number].last = build(at, last, leaf, box_of, label_of);
    }
    return static_cast<int>(number);
  }
  static double middle(const Eigen::AlignedBox3d& box, Eigen::Index axis) {
    return box.min()[axis] / 2 + box.max()[axis] / 2;
  }
  template <class Point>
  static double middle(const Eigen::MatrixBase<Point>& point, Eigen::Index axis) {
    return point[axis];
  }

  std::vector<int> items_;
  std::vector<Node> nodes_;
};

/// A tree of boxes over vertices that finds the nearest one, or the nearest one of another label. Boxes with vertices
/// of a single label are skipped whole, so the cost does not depend on how many vertices of that label are nearer.
class VertexTree {
 public:
  static constexpr int kNoLabel = BoxTree::kNoLabel;
  static constexpr std::size_t kMostLooks = 1024;

  /// @param vertices  with finite coordinates; points and labels are not copied and must outlive the object
  /// @param labels    per vertex of the mesh; null: all have the same
  /// O(vertices log vertices).
  VertexTree(const Points& points, std::vector<int> vertices, const std::vector<int>* labels = nullptr);

  struct Found {
    int vertex = -1;
    double squared;  ///< distance; the limit if no vertex was found
  };
  /// Returns the vertex nearest to a point, the lowest number of several; -1 if none is within the limit.
  int nearest(const Vector3& position, double limit = std::numeric_limits<double>::max()) const;
  /// Returns the vertex nearest to a point, the lowest number of several. After kMostLooks vertices, as from the centre
  /// of a sphere, it returns the nearest of those.
  /// @param limit   squared, of the distance
  /// @param except  vertices of this label are not considered
  /// @param accept  bool(int vertex): whether a vertex is considered
  /// @param looks   number of vertices that were looked at is added
  template <class Accept>
  Found nearest(const Vector3& position, double limit, int except, const Accept& accept, std::size_t& looks,
                std::size_t most_looks = kMostLooks) const {
    Found best{-1, limit};
    const auto is_nearer = [&best](double squared, int vertex) {
      return squared < best.squared || (squared == best.squared && (best.vertex < 0 || vertex < best.vertex));
    };
    using Open = BoxTree::Open;
    const std::vector<BoxTree::Node>& nodes = tree_.nodes();
    Open stack[BoxTree::kDeepest];
    int open = 0;
    const auto push = [&](Open next) {
      if (nodes[next.node].label != except || except == kNoLabel) {
        stack[open++] = next;
      }
    };
    const auto to_box = [&](int node) { return Open{squared_distance(position, nodes[node]), node}; };
    if (!nodes.empty()) {
      push(to_box(0));
    }
    for (const std::size_t last = looks + most_looks; open > 0 && looks < last;) {
      const Open next = stack[--open];
      const BoxTree::Node& node = nodes[next.node];
      if (!is_nearer(next.distance, node.lowest)) {
        continue;
      }
      if (node.first >= 0) {
        for (int k = node.first; k < node.last; ++k) {
          const int v = tree_.items()[k];
          const double squared = (points_.row(v).transpose() - position).squaredNorm();
          ++looks;
          if ((except == kNoLabel || label(v) != except) && is_nearer(squared, v) && accept(v)) {
            best = {v, squared};
          }
        }
        continue;
      }
      Open near = to_box(next.node + 1), far = to_box(node.last);
      if (std::pair(far.distance, nodes[far.node].lowest) < std::pair(near.distance, nodes[near.node].lowest)) {
        std::swap(near, far);
      }
      push(far);
      push(near);
    }
    return best;
  }

 private:
  static double squared_distance(const Vector3& position, const BoxTree::Node& node) {
    return node.box.squaredExteriorDistance(position);
  }
  int label(int vertex) const { return labels_ ? (*labels_)[vertex] : 0; }

  const Points& points_;
  const std::vector<int>* labels_;
  BoxTree tree_;
};

/// The refusal of a point that is too far from the surface.
struct OffSurface : EditError {
  using EditError::EditError;
};

/// Finds the vertices of a mesh nearest to points. Only vertices with a face and finite coordinates count.
class VertexFinder {
 public:
  struct Found {
    int vertex;
    double distance;  ///< model units
  };

  /// The mesh has to outlive the object. O(n log n). @throws EditError (NotFinite) if no vertex counts
  explicit VertexFinder(const TriangleMesh& mesh);

  /// Largest distance from a vertex, over the bounding box's diagonal, of a point that counts as on the surface.
  static constexpr double kFar = 0.1;

  /// Returns the nearest vertex, the lowest number of several. @param what  names the point in a refusal
  /// @throws EditError (NotFinite) if the point is not finite; OffSurface (BadParameter) if it is farther from every
  ///         vertex than a tenth of the bounding box's diagonal
  Found on_surface(const Vector3& point, const std::string& what,
                   const std::string& advice = "give a point on the surface") const;
  /// The same at any distance. @throws EditError (NotFinite)
  Found anywhere(const Vector3& point, const std::string& what) const;
  /// Returns whether a point is finite, and a vertex is not farther away than a fraction of the diagonal.
  bool is_near(const Vector3& point, double fraction = kFar) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<int> usable_;
  double diagonal_;
  VertexTree tree_;
};

/// Returns the vertex nearest to the handle point. @throws EditError as VertexFinder
int nearest_vertex(const TriangleMesh& mesh, const Vector3& point);

/// Returns a point as "(x, y, z)".
std::string place_text(const Vector3& point);

}  // namespace lapedit
