// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {
namespace {

constexpr double kTouches = 0.01;  // of the moving part's size
constexpr double kSmall = 0.5;     // a piece's size over that of the moving part
constexpr double kEncloses = 0.4;  // winding number of the moving part about a piece
/// Only the largest pieces are tested for being enclosed: as many as take some seconds, but at least these.
constexpr std::size_t kMostAngles = 20000000, kEnclosed = 64;

/// A part of the surface beyond the inner edge of the band.
struct Part {
  std::vector<int> vertices;
  std::size_t beyond = 0;  // vertices that the radius does not reach
};

/// Adds parts beyond the band that only the region connects to the remaining surface. If the region is between two such
/// parts of a component, it does not add the larger one, nor one of at least half its size.
void take_tips(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec, Attached& found) {
  const double inner = (1 - spec.padding) * spec.radius;
  const auto n = static_cast<int>(found.distance.size());
  const auto reached = static_cast<std::size_t>(
      std::count_if(found.distance.begin(), found.distance.end(), [](double d) { return d < kUnreached; }));
  std::vector<char> seen(n, 0);
  std::vector<Part> closed;
  std::vector<int> component;
  // Per component: vertices of its largest closed part; kOpen if a part of it is open.
  constexpr std::size_t kOpen = 0;
  std::vector<std::size_t> largest(connected_components(adjacency.neighbours, component), 1);
  Checkpoints checkpoints;
  for (int start = 0; start < n; ++start) {
    if (seen[start] || !(found.distance[start] > inner) || found.distance[start] == kUnreached) {
      continue;
    }
    Part part{{start}};
    bool is_open = false;
    seen[start] = 1;
    for (std::size_t k = 0; k < part.vertices.size(); ++k) {
      checkpoints();
      for (const int w : adjacency.neighbours[part.vertices[k]]) {
        is_open |= seen[w] == 2 || !mesh.vertices.row(w).allFinite();
        if (!seen[w] && found.distance[w] > inner) {
          part.beyond += found.distance[w] == kUnreached;
          // The search continues through a part that is too large only inside the band.
          if (found.distance[w] < kUnreached || part.beyond <= reached) {
            seen[w] = 1;
            part.vertices.push_back(w);
          }
        }
      }
    }
    if (is_open || part.beyond > reached) {
      largest[component[start]] = kOpen;
      for (const int v : part.vertices) {
        seen[v] = 2;
      }
    } else {
      closed.push_back(std::move(part));
    }
  }
  for (const Part& part : closed) {
    std::size_t& most = largest[component[part.vertices[0]]];
    most = most == kOpen ? kOpen : std::max(most, part.vertices.size());
  }
  for (const Part& part : closed) {
    const std::size_t most = largest[component[part.vertices[0]]];
    if (2 * part.vertices.size() < most || most == kOpen) {
      for (const int v : part.vertices) {
        found.distance[v] = std::min(found.distance[v], spec.radius);
        found.is_free[v] = 1;
      }
    }
  }
}

/// Returns the winding number of the faces of the moving part about a point: 1 inside a closed surface.
double winding(const TriangleMesh& mesh, const std::vector<int>& faces, const Vector3& point) {
  constexpr double kFullAngle = 12.566370614359172;
  double angle = 0;
  Checkpoints checkpoints;
  for (const int f : faces) {
    checkpoints();
    std::array<Vector3, 3> to;
    for (int k = 0; k < 3; ++k) {
      to[k] = (mesh.vertices.row(mesh.faces(f, k)).transpose() - point).normalized();
    }
    angle += 2 * std::atan2(to[0].dot(to[1].cross(to[2])), 1 + to[0].dot(to[1]) + to[1].dot(to[2]) + to[2].dot(to[0]));
  }
  return std::abs(angle) / kFullAngle;
}

/// Adds small pieces that the moving part encloses or touches.
class PieceSearch {
 public:
  PieceSearch(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec, Attached& found)
      : mesh_(mesh), found_(found), moving_(moving(spec)) {
    const Eigen::AlignedBox3d box = bounding_box(mesh.vertices, moving_);
    std::vector<char> moves(found.distance.size(), 0);
    for (const int v : moving_) {
      moves[v] = 1;
    }
    size_ = moving_.empty() ? 0 : box.diagonal().norm();
    const Vector3 margin = Vector3::Constant(kSmall * size_);  // a piece that touches may extend beyond the box
    box_ = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
    for (const int v : moving_) {
      for (const int f : adjacency.faces[v]) {
        const auto corners = mesh.faces.row(f);
        if (moves[corners[0]] && moves[corners[1]] && moves[corners[2]] && corners.minCoeff() == v) {
          faces_.push_back(f);
        }
      }
    }
  }

  void take(const Adjacency& adjacency, const std::vector<char>& allowed) {
    std::vector<std::vector<int>> pieces;
    std::vector<char> seen(found_.distance.size(), 0);
    Checkpoints checkpoints;
    for (std::size_t v = 0; v < seen.size(); ++v) {
      checkpoints();
      if (std::vector<int> piece = piece_of(static_cast<int>(v), adjacency, allowed, seen); !piece.empty()) {
        pieces.push_back(std::move(piece));
      }
    }
    std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    if (!pieces.empty()) {
      tree_.emplace(mesh_.vertices, moving_);
    }
    const std::size_t tested = std::max(kEnclosed, kMostAngles / (faces_.size() + 1));
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      consider(pieces[k], k < tested);
    }
    found_.links = sorted_set(std::move(found_.links));
  }

 private:
  std::vector<int> moving(const RegionSpec& spec) const {
    const double inner = spec.kind == RegionSpec::Kind::Radius ? (1 - spec.padding) * spec.radius : kUnreached;
    std::vector<int> vertices;
    for (std::size_t v = 0; v < found_.distance.size(); ++v) {
      if (found_.distance[v] < kUnreached && (found_.distance[v] <= inner || found_.is_free[v])) {
        vertices.push_back(static_cast<int>(v));
      }
    }
    return vertices;
  }

  /// Returns the piece of a vertex, empty if it is large, outside the box or seen before. O(vertices in the box) in
  /// all.
  std::vector<int> piece_of(int start, const Adjacency& adjacency, const std::vector<char>& allowed,
                            std::vector<char>& seen) const {
    constexpr char kOut = 2;
    const auto is_out = [&](int v) {
      const Vector3 position = mesh_.vertices.row(v).transpose();
      return found_.distance[v] < kUnreached || !position.allFinite() || !box_.contains(position) ||
             (!allowed.empty() && !allowed[v]);
    };
    if (seen[start] || is_out(start) || adjacency.faces[start].size() == 0) {
      return {};
    }
    std::vector<int> piece{start};
    bool out = false;
    seen[start] = 1;
    for (std::size_t k = 0; k < piece.size() && !out; ++k) {
      for (const int w : adjacency.neighbours[piece[k]]) {
        out |= seen[w] == kOut || is_out(w);
        if (seen[w] == 0) {
          seen[w] = 1;
          piece.push_back(w);
        }
      }
    }
    if (out || bounding_box(mesh_.vertices, piece).diagonal().norm() > kSmall * size_) {
      for (const int v : piece) {
        seen[v] = kOut;
      }
      return {};
    }
    return piece;
  }

  void consider(const std::vector<int>& piece, bool may_be_enclosed) {
    std::vector<std::pair<int, int>> links;
    Checkpoints checkpoints;
    for (const int v : piece) {
      checkpoints();
      const int near = tree_->nearest(mesh_.vertices.row(v).transpose(), kTouches * size_);
      if (near >= 0) {
        links.emplace_back(v, near);
      }
    }
    if (links.empty() &&
        !(may_be_enclosed &&
          winding(mesh_, faces_, Vector3(bounding_box(mesh_.vertices, piece).center())) >= kEncloses)) {
      return;
    }
    // Links at the ends of the piece along each axis hold it on all sides and do not constrain its shape.
    for (int axis = 0; axis < 3; ++axis) {
      const auto ends = std::minmax_element(
          piece.begin(), piece.end(), [&](int a, int b) { return mesh_.vertices(a, axis) < mesh_.vertices(b, axis); });
      for (const int v : {*ends.first, *ends.second}) {
        links.emplace_back(v, tree_->nearest(mesh_.vertices.row(v).transpose()));
      }
    }
    double nearest = kUnreached;
    for (const auto& [v, w] : links) {
      nearest = std::min(nearest, found_.distance[w]);
      found_.links.emplace_back(v, w);
      found_.links.emplace_back(w, v);
    }
    for (const int v : piece) {
      found_.distance[v] = nearest;
      found_.is_free[v] = 1;
    }
    ++found_.pieces;
  }

  const TriangleMesh& mesh_;
  Attached& found_;
  std::vector<int> moving_;  // the moving part: the region without its band
  std::optional<VertexTree> tree_;
  std::vector<int> faces_;  // of the moving part
  Eigen::AlignedBox3d box_;
  double size_ = 0;
};

}  // namespace

Attached attached_to(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                     std::vector<double> distance, const std::vector<char>& allowed) {
  Attached found;
  found.is_free.assign(distance.size(), 0);
  found.distance = std::move(distance);
  if (spec.tips && spec.kind == RegionSpec::Kind::Radius) {
    take_tips(mesh, adjacency, spec, found);
  }
  if (spec.pieces) {
    PieceSearch(mesh, adjacency, spec, found).take(adjacency, allowed);
  }
  return found;
}

}  // namespace lapedit
