// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/surface_pick.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "lapedit/geodesic.h"

namespace lapedit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Barycentric coordinates: a ray through a vertex or an edge must not slip between the triangles there.
constexpr double kSeam = 1e-9;

Vector3 corner(const TriangleMesh& mesh, int face, int k) {
  return mesh.vertices.row(mesh.faces(face, k)).transpose();
}

Vector3 normal(const TriangleMesh& mesh, int face) {
  const Vector3 a = corner(mesh, face, 0);
  return (corner(mesh, face, 1) - a).cross(corner(mesh, face, 2) - a);
}

/// Distance along the ray in units of its direction (Moeller and Trumbore 1997), infinity if it misses. Comparisons are
/// such that NaN misses.
double intersect(const TriangleMesh& mesh, int face, const Ray& ray) {
  const Vector3 a = corner(mesh, face, 0);
  const Vector3 along = corner(mesh, face, 1) - a;
  const Vector3 across = corner(mesh, face, 2) - a;
  const Vector3 p = ray.direction.cross(across);
  const double determinant = along.dot(p);
  if (!(std::abs(determinant) > 0)) {
    return kInfinity;
  }
  const Vector3 offset = ray.origin - a;
  const double u = offset.dot(p) / determinant;
  if (!(u >= -kSeam && u <= 1 + kSeam)) {
    return kInfinity;
  }
  const Vector3 q = offset.cross(along);
  const double v = ray.direction.dot(q) / determinant;
  if (!(v >= -kSeam && u + v <= 1 + kSeam)) {
    return kInfinity;
  }
  const double t = across.dot(q) / determinant;
  return t >= 0 && std::isfinite(t) ? t : kInfinity;
}

}  // namespace

std::optional<SurfaceHit> first_hit(const TriangleMesh& mesh, const Ray& ray) {
  int found = -1;
  double nearest = kInfinity;
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    const double t = intersect(mesh, f, ray);
    if (t < nearest) {
      nearest = t;
      found = f;
    }
  }
  if (found < 0) {
    return std::nullopt;
  }
  SurfaceHit hit;
  hit.point = ray.origin + nearest * ray.direction;
  hit.face = found;
  double closest = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const double distance = (corner(mesh, found, k) - hit.point).norm();
    if (distance < closest) {
      closest = distance;
      hit.vertex = mesh.faces(found, k);
    }
  }
  return hit;
}

/// A binary tree of boxes; the faces of a node are order[first .. last).
struct Visibility::Tree {
  static constexpr int kLeaf = 8;

  struct Node {
    Eigen::AlignedBox3d box;
    int first, last;
    int right;  // the left child is the next node; 0: a leaf
  };

  explicit Tree(const TriangleMesh& the_mesh) : mesh(the_mesh) {
    std::vector<Vector3> centers(mesh.faces.rows());
    for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
      centers[f] = (corner(mesh, f, 0) + corner(mesh, f, 1) + corner(mesh, f, 2)) / 3;
      if (centers[f].allFinite()) {
        order.push_back(f);
      }
    }
    nodes.reserve(2 * order.size() / kLeaf + 1);
    if (!order.empty()) {
      build(centers, 0, static_cast<int>(order.size()));
    }
  }

  int build(const std::vector<Vector3>& centers, int first, int last) {
    const int me = static_cast<int>(nodes.size());
    nodes.push_back({Eigen::AlignedBox3d(), first, last, 0});
    Eigen::AlignedBox3d box, of_centers;
    for (int i = first; i < last; ++i) {
      for (int k = 0; k < 3; ++k) {
        box.extend(corner(mesh, order[i], k));
      }
      of_centers.extend(centers[order[i]]);
    }
    nodes[me].box = box;
    if (last - first > kLeaf) {
      Eigen::Index axis = 0;
      of_centers.sizes().maxCoeff(&axis);
      const int middle = (first + last) / 2;
      std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                       [&](int a, int b) { return centers[a][axis] < centers[b][axis]; });
      build(centers, first, middle);
      const int right = build(centers, middle, last);
      nodes[me].right = right;
    }
    return me;
  }

  /// Whether a ray of unit direction meets any face but those of a vertex and those in the same place.
  bool meets(const Ray& ray, int vertex) const {
    if (nodes.empty()) {
      return false;
    }
    constexpr double kSamePlace = 1e-7;
    const double nearest = kSamePlace * nodes[0].box.diagonal().norm();
    const Vector3 inverse = ray.direction.cwiseInverse();
    std::array<int, 64> stack{};  // deeper than any tree halved down from the largest int
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const int at = stack[--size];
      const Node& node = nodes[at];
      const Vector3 low = (node.box.min() - ray.origin).cwiseProduct(inverse);
      const Vector3 high = (node.box.max() - ray.origin).cwiseProduct(inverse);
      double enter = 0, leave = kInfinity;
      for (int k = 0; k < 3; ++k) {
        // In this order NaN, from zero times infinity, cuts nothing off.
        enter = std::max(enter, std::min(low[k], high[k]));
        leave = std::min(leave, std::max(low[k], high[k]));
      }
      if (enter > leave * (1 + 1e-12)) {
        continue;
      }
      if (node.right > 0) {
        stack[size++] = node.right;
        stack[size++] = at + 1;
        continue;
      }
      for (int i = node.first; i < node.last; ++i) {
        const int f = order[i];
        const bool own = mesh.faces(f, 0) == vertex || mesh.faces(f, 1) == vertex || mesh.faces(f, 2) == vertex;
        const double t = own ? kInfinity : intersect(mesh, f, ray);
        if (t > nearest && t < kInfinity) {
          return true;
        }
      }
    }
    return false;
  }

  const TriangleMesh& mesh;
  std::vector<int> order;
  std::vector<Node> nodes;
};

Visibility::Visibility(const TriangleMesh& mesh) : tree_(std::make_unique<Tree>(mesh)) {}
Visibility::~Visibility() = default;

bool Visibility::sees(const View& view, const Adjacency& adjacency, int vertex, int side) const {
  const TriangleMesh& mesh = tree_->mesh;
  const Vector3 place = mesh.vertices.row(vertex).transpose();
  if (!place.allFinite() || !view.in_front(place)) {
    return false;
  }
  const Vector3 toward = view.toward_viewer(place);
  const IndexLists::Row around = adjacency.faces[vertex];
  const bool shown =
      std::any_of(around.begin(), around.end(), [&](int f) { return side * normal(mesh, f).dot(toward) > 0; });
  return shown && !tree_->meets({place, toward}, vertex);
}

std::vector<int> brushed_vertices(const TriangleMesh& mesh, const Adjacency& adjacency, const Visibility& visibility,
                                  const View& view, const SurfaceHit& hit, double radius) {
  const int side = normal(mesh, hit.face).dot(view.toward_viewer(hit.point)) < 0 ? -1 : 1;
  GeodesicSearch search(adjacency.neighbours, mesh.vertices);
  std::vector<char> visible(mesh.vertices.rows(), 0);
  for (const int v : search.run({hit.vertex}, radius)) {
    visible[v] = visibility.sees(view, adjacency, v, side);
  }
  if (!visible[hit.vertex]) {
    return {};
  }
  std::vector<int> result = search.run({hit.vertex}, radius, &visible);
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace lapedit
