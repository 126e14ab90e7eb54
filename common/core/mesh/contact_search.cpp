// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/contact_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/surface_index.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

using Corners = std::array<Vector3, 4>;

/// Gap in mean edges, the part of a distance at rest, and the part of a gap that is never used up.
constexpr double kGap = 0.3, kPartOfRest = 0.5, kLeast = 0.1;
/// Faces per leaf, and in pieces of parallel work.
constexpr int kLeaf = 4, kGrain = 1024, kTasks = 128;
/// Contacts of a motion per vertex that moves: ten edits of the benchmark had up to 7, most of them when compressed.
constexpr int kMostPerVertex = 50;

std::pair<int, int> ascending(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

/// Sets the weights of the nearest points of two segments. Source: C. Ericson, Real-time collision detection, 2005,
/// section 5.1.9.
void nearest_of_edges(const Corners& x, std::array<double, 4>& weights) {
  const Vector3 d1 = x[1] - x[0], d2 = x[3] - x[2], r = x[0] - x[2];
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  const double denominator = a * e - b * b;
  const auto part = [](double numerator, double of) { return of > 0 ? std::clamp(numerator / of, 0.0, 1.0) : 0.0; };
  double s = part(b * f - c * e, denominator);
  double t = e > 0 ? (b * s + f) / e : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = part(t * b - c, a);
  }
  weights = {1 - s, s, t - 1, -t};
}

/// Sets the weights of nearest points. @return the vector between them
Vector3 nearest(const Corners& x, bool edges, std::array<double, 4>& weights) {
  if (edges) {
    nearest_of_edges(x, weights);
  } else {
    const Vector3 on_face = nearest_weights(x[0], x[1], x[2], x[3]);
    weights = {1, -on_face[0], -on_face[1], -on_face[2]};
  }
  return weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2] + weights[3] * x[3];
}

Corners corners(const Contact& contact, const Points& at) {
  return {position_of(at, contact.vertices[0]), position_of(at, contact.vertices[1]),
          position_of(at, contact.vertices[2]), position_of(at, contact.vertices[3])};
}

/// Sets nearest points, normal and distance. @return whether the distance is not zero
bool place(Contact& contact, const Corners& x) {
  contact.normal = nearest(x, contact.edges, contact.weights);
  contact.distance = contact.normal.norm();
  contact.normal /= contact.distance > 0 ? contact.distance : 1;
  return contact.distance > 0;
}

bool share_corner(const Faces& faces, int f, int g) {
  const int a = faces(g, 0), b = faces(g, 1), c = faces(g, 2);
  const auto has = [&](int v) { return v == a || v == b || v == c; };
  return has(faces(f, 0)) || has(faces(f, 1)) || has(faces(f, 2));
}

double volume(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Returns whether a segment passes through a triangle.
bool pierces(const Vector3& p, const Vector3& q, const std::array<Vector3, 3>& t) {
  if (!(volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) < 0)) {
    return false;
  }
  const double u = volume(p, q, t[0], t[1]), v = volume(p, q, t[1], t[2]), w = volume(p, q, t[2], t[0]);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/// Returns whether two faces cross, at least one edge of one through the other. A common corner does not count.
bool cross(const Points& at, const Eigen::Array3i& f, const Eigen::Array3i& g) {
  const std::array<Vector3, 3> a = {position_of(at, f[0]), position_of(at, f[1]), position_of(at, f[2])};
  const std::array<Vector3, 3> b = {position_of(at, g[0]), position_of(at, g[1]), position_of(at, g[2])};
  const auto has = [](const Eigen::Array3i& face, int v) { return (face == v).any(); };
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if ((!has(g, f[k]) && !has(g, f[next]) && pierces(a[k], a[next], b)) ||
        (!has(f, g[k]) && !has(f, g[next]) && pierces(b[k], b[next], a))) {
      return true;
    }
  }
  return false;
}

/// Returns the distance of a contact's features along its normal.
double distance_along(const Contact& contact, const Corners& x) {
  const Vector3& n = contact.normal;
  const double a = n.dot(x[0]), b = n.dot(x[1]), last = std::max(n.dot(x[2]), n.dot(x[3]));
  return contact.edges ? std::min(a, b) - last : a - std::max(b, last);
}

/// Returns the part of a motion, 0 to 1, in which a contact keeps at least `thickness` and a tenth of what it has more
/// at the beginning. @param bound  below which it never comes, or 0
double safe_part(const Contact& contact, const Corners& from, const Corners& to, double bound, double thickness) {
  constexpr double kUsed = 0.9;
  constexpr int kMostSteps = 200;
  if (bound > thickness + (1 - kUsed) * (contact.distance - thickness)) {
    return 1;
  }
  Corners x = from, d;
  Vector3 mean = Vector3::Zero();
  for (int k = 0; k < 4; ++k) {
    mean += 0.25 * (to[k] - from[k]);
  }
  for (int k = 0; k < 4; ++k) {
    d[k] = to[k] - from[k] - mean;
  }
  const std::array<double, 4> length = {d[0].norm(), d[1].norm(), d[2].norm(), d[3].norm()};
  const double most = contact.edges ? std::max(length[0], length[1]) + std::max(length[2], length[3])
                                    : length[0] + std::max({length[1], length[2], length[3]});
  std::array<double, 4> weights;
  double left = contact.distance - thickness, done = 0;
  const double least = (1 - kUsed) * left;
  for (int step = 0; step < kMostSteps && left > 0; ++step) {
    const double next = kUsed * left / most;
    if (done + next >= 1) {
      return 1;
    }
    for (int k = 0; k < 4; ++k) {
      x[k] += next * d[k];
    }
    left = nearest(x, contact.edges, weights).norm() - thickness;
    if (done > 0 && left < least) {
      return done;
    }
    done += next;
  }
  return done;
}

}  // namespace

void ContactSurface::Bounds::add(const Bounds& other) {
  low = low.min(other.low);
  high = high.max(other.high);
  least = least.min(other.least);
  most = most.max(other.most);
  normal_low = normal_low.min(other.normal_low);
  normal_high = normal_high.max(other.normal_high);
}

/// Connected components of sets of faces.
class ContactSurface::Patches {
 public:
  explicit Patches(Eigen::Index vertices) : parent_(static_cast<std::size_t>(vertices)) {}
  /// @param faces  all of them, for is_patch()
  Patches(Eigen::Index vertices, const Faces& faces) : Patches(vertices) {
    fan_.resize(parent_.size());
    const CompressedRows at = faces_around(static_cast<int>(vertices), faces);
    std::vector<int> uses(parent_.size());
    Checkpoints checkpoints;
    for (int v = 0; v < static_cast<int>(vertices); ++v) {
      checkpoints();
      fan_[v] = fan_of(v, at[v], faces, uses);
    }
  }

  /// Returns whether the faces are connected and, unless they are few, at no border, since two sides of a slit may
  /// overlap in their plane. O(faces)
  bool is_patch(const Faces& faces, const std::vector<int>& order, int first, int last) {
    join(faces, order, first, last);
    const int root = find(faces(order[first], 0));
    const Fan most = last - first <= kLeaf ? Fan::Open : Fan::Closed;
    return std::all_of(order.begin() + first, order.begin() + last, [&](int f) {
      const auto face = faces.row(f);
      return find(face[0]) == root && std::all_of(face.begin(), face.end(), [&](int v) { return fan_[v] <= most; });
    });
  }

  void join(const Faces& faces, const std::vector<int>& order, int first, int last) {
    for (int k = first; k < last; ++k) {
      for (const int v : faces.row(order[k])) {
        parent_[v] = v;
      }
    }
    for (int k = first; k < last; ++k) {
      const auto face = faces.row(order[k]);
      parent_[find(face[1])] = find(face[0]);
      parent_[find(face[2])] = find(face[0]);
    }
  }
  int find(int v) {
    while (parent_[v] != v) {
      v = parent_[v] = parent_[parent_[v]];
    }
    return v;
  }

 private:
  /// What the faces at a vertex are: several fans where surfaces touch in a vertex, or meet in an edge of three faces.
  enum class Fan : char { Closed, Open, Several };

  /// @param uses  for all vertices, any numbers
  Fan fan_of(int v, const CompressedRows::Row& at, const Faces& faces, std::vector<int>& uses) {
    const auto each_end = [&](const auto& call) {
      for (const int f : at) {
        const int k = faces(f, 0) == v ? 0 : faces(f, 1) == v ? 1 : 2;
        call(faces(f, (k + 1) % 3), faces(f, (k + 2) % 3));
      }
    };
    each_end([&](int a, int b) {
      parent_[a] = a;
      parent_[b] = b;
      uses[a] = uses[b] = 0;
    });
    each_end([&](int a, int b) {
      parent_[find(a)] = find(b);
      ++uses[a];
      ++uses[b];
    });
    Fan fan = Fan::Closed;
    int root = -1;
    each_end([&](int a, int b) {
      root = root < 0 ? find(a) : root;
      const auto [fewest, most] = std::minmax(uses[a], uses[b]);
      fan = most > 2 || find(a) != root ? Fan::Several : std::max(fan, fewest < 2 ? Fan::Open : Fan::Closed);
    });
    return fan;
  }
  std::vector<int> parent_;
  std::vector<Fan> fan_;  // per vertex
};

ContactSurface::ContactSurface(Points rest, Faces moving)
    : rest_(std::move(rest)),
      moving_vertices_(static_cast<int>(rest_.rows())),
      moving_faces_(static_cast<int>(moving.rows())) {
  for (const auto& face : moving.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      gap_ += kGap / 3 * (rest_.row(face[k]) - rest_.row(face[(k + 1) % 3])).norm() / moving_faces_;
    }
  }
  add_tree(0, moving);
  moving_nodes_ = static_cast<int>(nodes_.size());
}

void ContactSurface::set_resting(const Points& more, const Faces& resting) {
  nodes_.resize(static_cast<std::size_t>(moving_nodes_));
  rest_.conservativeResize(moving_vertices_ + more.rows(), 3);
  rest_.bottomRows(more.rows()) = more;
  add_tree(moving_faces_, resting);
  resting_bounded_ = false;
  crosses_.clear();
  crossing_pieces_.clear();
}

/// Builds a tree of faces, which replace those from `first` on.
void ContactSurface::add_tree(int first, const Faces& faces) {
  const int count = first + static_cast<int>(faces.rows());
  Points centres(count, 3);
  faces_.conservativeResize(count, 3);
  order_.resize(static_cast<std::size_t>(count));
  for (int f = first; f < count; ++f) {
    const auto face = faces.row(f - first);
    faces_.row(f) = face;
    centres.row(f) = (rest_.row(face[0]) + rest_.row(face[1]) + rest_.row(face[2])) / 3;
    order_[f] = f;
  }
  if (first < count) {
    Patches patches(rest_.rows(), faces_);
    build(first, count, centres, patches);
  }
  for (int f = first; f < count; ++f) {
    faces_.row(f) = faces.row(order_[f] - first);
  }
  face_bounds_.resize(static_cast<std::size_t>(count));
  node_bounds_.resize(nodes_.size());
}

/// Finds what each face stands for: the first face with a corner or an edge does.
void ContactSurface::find_owners(ThreadPool& pool) {
  const auto count = static_cast<int>(faces_.rows());
  const CompressedRows at = faces_around(static_cast<int>(rest_.rows()), faces_);
  owned_.assign(static_cast<std::size_t>(count), 0);
  for_indices(pool, count, kGrain, [&](int f) {
    for (int k = 0; k < 3; ++k) {
      const int corner = faces_(f, k);
      const auto [a, b] = ascending(corner, faces_(f, (k + 1) % 3));
      const auto has_end = [this, end = b](int g) { return (faces_.row(g).array() == end).any(); };
      owned_[f] |= static_cast<unsigned char>((*at[corner].begin() == f ? 1 : 0) << k);
      owned_[f] |= static_cast<unsigned char>((*std::find_if(at[a].begin(), at[a].end(), has_end) == f ? 8 : 0) << k);
    }
  });
}

int ContactSurface::build(int first, int last, const Points& centres, Patches& patches) {
  checkpoint(last - first);
  const auto node = static_cast<int>(nodes_.size());
  // Larger ones are hardly ever smooth; of resting ones only leaves are asked for.
  const int largest_patch = first < moving_faces_ ? 512 : kLeaf;
  nodes_.push_back({first, last, -1, last - first <= largest_patch && patches.is_patch(faces_, order_, first, last)});
  if (last - first > kLeaf) {
    Eigen::AlignedBox3d box;
    for (int k = first; k < last; ++k) {
      box.extend(position_of(centres, order_[k]));
    }
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const int middle = (first + last) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](int f, int g) { return std::pair(centres(f, axis), f) < std::pair(centres(g, axis), g); });
    build(first, middle, centres, patches);
    const int right = build(middle, last, centres, patches);
    nodes_[node].right = right;
  }
  return node;
}

void ContactSurface::bound(const Points& from, const Points& to, ThreadPool& pool) {
  const bool all = !resting_bounded_, moves = &from != &to;
  resting_bounded_ = true;
  in_pieces(pool, all ? static_cast<int>(faces_.rows()) : moving_faces_, kGrain, [&](int first, int last) {
    for (int f = first; f < last; ++f) {
      Bounds& bounds = face_bounds_[f];
      const auto corners = [this, f](const Points& at) {
        return std::array<Vector3, 3>{position_of(at, faces_(f, 0)), position_of(at, faces_(f, 1)),
                                      position_of(at, faces_(f, 2))};
      };
      const auto normal = [](const std::array<Vector3, 3>& x) {
        return (x[1] - x[0]).cross(x[2] - x[0]).normalized().array().eval();
      };
      const std::array<Vector3, 3> a = corners(from);
      bounds.low = a[0].cwiseMin(a[1]).cwiseMin(a[2]).array();
      bounds.high = a[0].cwiseMax(a[1]).cwiseMax(a[2]).array();
      bounds.least = bounds.most = Eigen::Array3d::Zero();
      bounds.normal_low = bounds.normal_high = normal(a);
      if (moves && f < moving_faces_) {
        const std::array<Vector3, 3> b = corners(to);
        const Eigen::Array3d d0 = b[0] - a[0], d1 = b[1] - a[1], d2 = b[2] - a[2], after = normal(b);
        bounds.least = d0.min(d1).min(d2);
        bounds.most = d0.max(d1).max(d2);
        bounds.normal_low = bounds.normal_low.min(after);
        bounds.normal_high = bounds.normal_high.max(after);
      }
    }
  });
  const int count = all ? static_cast<int>(nodes_.size()) : moving_nodes_;
  for_indices(pool, count, kGrain, [&](int n) {
    if (nodes_[n].right < 0) {
      node_bounds_[n] = face_bounds_[nodes_[n].first];
      for (int f = nodes_[n].first + 1; f < nodes_[n].last; ++f) {
        node_bounds_[n].add(face_bounds_[f]);
      }
    }
  });
  for (int n = count - 1; n >= 0; --n) {
    if (nodes_[n].right >= 0) {
      node_bounds_[n] = node_bounds_[n + 1];
      node_bounds_[n].add(node_bounds_[nodes_[n].right]);
    }
  }
}

/// Returns whether boxes come nearer than the margin in the motion of one relative to the other.
bool ContactSurface::may_touch(const Bounds& a, const Bounds& b) const {
  if (margin_ == 0) {  // at rest, see crossings()
    return a.low[0] <= b.high[0] && a.high[0] >= b.low[0] && a.low[1] <= b.high[1] && a.high[1] >= b.low[1] &&
           a.low[2] <= b.high[2] && a.high[2] >= b.low[2];
  }
  const Eigen::Array3d least = (a.least - b.most).min(0.0), most = (a.most - b.least).max(0.0);
  return (a.low + least <= b.high + margin_).all() && (a.high + most >= b.low - margin_).all();
}

/// Returns whether two nodes, or the same twice, are one patch whose normals are within a cone, before and
/// after the motion. Of two nodes only leaves count. At rest leaves do not, since the outline of a few stretched faces
/// may overlap.
bool ContactSurface::is_smooth(int a, int b) const {
  constexpr double kCosine = 0.25;
  if ((margin_ == 0 && nodes_[a].right < 0) || !nodes_[a].is_patch || !nodes_[b].is_patch ||
      (a != b && (nodes_[a].right >= 0 || nodes_[b].right >= 0))) {
    return false;
  }
  const Eigen::Array3d low = node_bounds_[a].normal_low.min(node_bounds_[b].normal_low);
  const Eigen::Array3d high = node_bounds_[a].normal_high.max(node_bounds_[b].normal_high), axis = low + high;
  return (axis * low).min(axis * high).sum() > kCosine * axis.matrix().norm() && (a == b || have_common_corner(a, b));
}

bool ContactSurface::have_common_corner(int a, int b) const {
  for (int f = nodes_[a].first; f < nodes_[a].last; ++f) {
    for (int g = nodes_[b].first; g < nodes_[b].last; ++g) {
      if (share_corner(faces_, f, g)) {
        return true;
      }
    }
  }
  return false;
}

bool ContactSurface::is_exempt(int f, int g) const {
  return piece_[f] == piece_[g]
             ? crosses_[f] && crosses_[g]
             : std::binary_search(crossing_pieces_.begin(), crossing_pieces_.end(), ascending(piece_[f], piece_[g]));
}

/// Returns whether two faces with a common corner are not folded onto each other, or faces without one are too far
/// apart.
bool ContactSurface::are_apart(int f, int g) const {
  constexpr double kCosine = 0.5;
  const Bounds &a = face_bounds_[f], &b = face_bounds_[g];
  if (!may_touch(a, b)) {
    return true;
  }
  if (!share_corner(faces_, f, g)) {
    return false;
  }
  const Eigen::Array3d one = a.normal_low + a.normal_high, other = b.normal_low + b.normal_high;
  return (one * other).sum() > kCosine * one.matrix().norm() * other.matrix().norm();
}

/// Calls visit(f, g, found) for all pairs of faces that may touch, of which at least one moves. @return what was found,
/// in an order that does not depend on threads
template <class Found, class Visit>
std::vector<Found> ContactSurface::each_pair(ThreadPool& pool, const Visit& visit) const {
  using Pair = std::pair<int, int>;
  if (moving_nodes_ == 0) {
    return {};  // a cloud
  }
  std::vector<Pair> tasks;
  const auto split = [this](Pair pair, std::vector<Pair>& open) {
    const auto [a, b] = pair;
    if (a == b) {
      if (!is_smooth(a, a)) {
        open.insert(open.end(), {{a + 1, a + 1}, {nodes_[a].right, nodes_[a].right}, {a + 1, nodes_[a].right}});
      }
    } else if (may_touch(node_bounds_[a], node_bounds_[b])) {
      const bool first = nodes_[a].right >= 0 &&
                         (nodes_[b].right < 0 || nodes_[a].last - nodes_[a].first >= nodes_[b].last - nodes_[b].first);
      if (first) {
        open.insert(open.end(), {{a + 1, b}, {nodes_[a].right, b}});
      } else {
        open.insert(open.end(), {{a, b + 1}, {a, nodes_[b].right}});
      }
    }
  };
  const auto is_leaf = [this](Pair pair) { return nodes_[pair.first].right < 0 && nodes_[pair.second].right < 0; };
  tasks.push_back({0, 0});
  if (moving_nodes_ < static_cast<int>(nodes_.size())) {
    tasks.push_back({0, moving_nodes_});
  }
  for (std::size_t before = 0; tasks.size() < kTasks && tasks.size() != before;) {
    before = tasks.size();
    std::vector<Pair> next;
    for (const Pair& pair : tasks) {
      is_leaf(pair) ? next.push_back(pair) : split(pair, next);
    }
    tasks.swap(next);
  }
  const bool is_known = !crosses_.empty();
  std::vector<std::vector<Found>> found(tasks.size());
  pool.each(static_cast<int>(tasks.size()), [&](int task) {
    std::vector<Pair> open = {tasks[static_cast<std::size_t>(task)]};
    Checkpoints checkpoints;
    while (!open.empty()) {
      const Pair pair = open.back();
      open.pop_back();
      checkpoints();
      if (!is_leaf(pair)) {
        split(pair, open);
      } else if (may_touch(node_bounds_[pair.first], node_bounds_[pair.second]) &&
                 !is_smooth(pair.first, pair.second)) {
        for (int f = nodes_[pair.first].first; f < nodes_[pair.first].last; ++f) {
          for (int g = pair.first == pair.second ? f + 1 : nodes_[pair.second].first; g < nodes_[pair.second].last;
               ++g) {
            if (!are_apart(f, g) && !(is_known && is_exempt(f, g))) {
              visit(f, g, found[static_cast<std::size_t>(task)]);
            }
          }
        }
      }
    }
  });
  std::vector<Found> all;
  for (const std::vector<Found>& some : found) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

/// Calls pair(contact) for the vertices and faces, and the edges, that two faces stand for, without common vertices.
template <class Pair>
void ContactSurface::each_feature(int f, int g, const Pair& pair) const {
  const auto a = faces_.row(f), b = faces_.row(g);
  const auto vertices = [&](int owner, const auto& mine, const auto& others) {
    for (int k = 0; k < 3; ++k) {
      if ((owned_[owner] >> k & 1) && !(others.array() == mine[k]).any()) {
        pair({{mine[k], others[0], others[1], others[2]}});
      }
    }
  };
  vertices(f, a, b);
  vertices(g, b, a);
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      const int p = a[k], q = a[(k + 1) % 3], r = b[l], s = b[(l + 1) % 3];
      if ((owned_[f] >> (3 + k) & 1) && (owned_[g] >> (3 + l) & 1) && p != r && p != s && q != r && q != s) {
        pair({{p, q, r, s}, true});
      }
    }
  }
}

double ContactSurface::gap_of(const Contact& contact) const {
  std::array<double, 4> weights;
  return std::min(gap_, kPartOfRest * nearest(corners(contact, rest_), contact.edges, weights).norm());
}

bool ContactSurface::update(Contact& contact, const Points& at) {
  return place(contact, corners(contact, at));
}

/// Returns the pairs of faces that cross, without those known to be exempt.
std::vector<std::pair<int, int>> ContactSurface::crossings(const Points& at, ThreadPool& pool) {
  margin_ = 0;
  bound(at, at, pool);
  return each_pair<std::pair<int, int>>(pool, [&](int f, int g, auto& pairs) {
    if (cross(at, faces_.row(f).transpose(), faces_.row(g).transpose())) {
      pairs.push_back({f, g});
    }
  });
}

/// Finds what crosses at rest, unless it is known.
void ContactSurface::find_exempt(ThreadPool& pool) {
  if (!crosses_.empty()) {
    return;
  }
  find_owners(pool);
  const auto found = crossings(rest_, pool);
  crosses_.assign(static_cast<std::size_t>(faces_.rows()), 0);
  piece_.assign(crosses_.size(), 0);
  if (found.empty()) {
    return;
  }
  std::vector<int> all(crosses_.size());
  std::iota(all.begin(), all.end(), 0);
  Patches patches(rest_.rows());
  patches.join(faces_, all, 0, static_cast<int>(all.size()));
  std::transform(all.begin(), all.end(), piece_.begin(), [&](int f) { return patches.find(faces_(f, 0)); });
  std::vector<char> at(static_cast<std::size_t>(rest_.rows()), 0);
  for (const auto& [f, g] : found) {
    if (piece_[f] != piece_[g]) {
      crossing_pieces_.push_back(ascending(piece_[f], piece_[g]));
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      at[faces_(f, k)] = at[faces_(g, k)] = 1;
    }
  }
  std::sort(crossing_pieces_.begin(), crossing_pieces_.end());
  for (int f = 0; f < faces_.rows(); ++f) {
    crosses_[f] = at[faces_(f, 0)] || at[faces_(f, 1)] || at[faces_(f, 2)] ? 1 : 0;
  }
}

int ContactSurface::new_crossings(const Points& at, ThreadPool& pool) {
  auto now = crossings(at, pool), before = crossings(rest_, pool);
  std::sort(now.begin(), now.end());
  std::sort(before.begin(), before.end());
  now.erase(std::set_difference(now.begin(), now.end(), before.begin(), before.end(), now.begin()), now.end());
  return static_cast<int>(now.size());
}

bool ContactSurface::is_clear(const Points& at, ThreadPool& pool) {
  const auto found = crossings(at, pool);
  if (!found.empty()) {
    find_exempt(pool);
  }
  return std::all_of(found.begin(), found.end(), [&](const auto& pair) { return is_exempt(pair.first, pair.second); });
}

Sweep ContactSurface::sweep(const Points& from, const Points& to, ThreadPool& pool) {
  find_exempt(pool);
  margin_ = gap_;
  bound(from, to, pool);
  Sweep sweep;
  std::atomic<int> left = kMostPerVertex * moving_vertices();  // so that no motion takes minutes and gigabytes
  sweep.contacts = each_pair<Contact>(pool, [&](int f, int g, std::vector<Contact>& found) {
    if (left < 0) {
      return;
    }
    each_feature(f, g, [&](Contact contact) {
      const Corners before = corners(contact, from), after = corners(contact, to);
      if (!place(contact, before)) {
        return;
      }
      // The distance along a fixed direction is concave in time: least at the beginning or at the end.
      const double nearer = std::min(contact.distance, distance_along(contact, after));
      if (nearer >= gap_) {
        return;
      }
      contact.gap = gap_of(contact);
      if (!(contact.gap > 0) || nearer >= contact.gap) {
        return;
      }
      contact.safe = safe_part(contact, before, after, nearer, std::min(kLeast * contact.gap, 0.5 * contact.distance));
      bool is_near = contact.distance < contact.gap;
      if (!is_near) {
        Corners x;
        for (int k = 0; k < 4; ++k) {
          x[k] = before[k] + contact.safe * (after[k] - before[k]);
        }
        is_near = place(contact, x) && (contact.safe < 1 || contact.distance < contact.gap);
      }
      if (is_near) {
        --left;
        found.push_back(contact);
      }
    });
  });
  sweep.is_hopeless = left < 0;
  for (const Contact& contact : sweep.contacts) {
    sweep.safe = std::min(sweep.safe, contact.safe);
  }
  return sweep;
}

}  // namespace lapedit
