// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/visibility.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {
namespace {

Vector3 corner(const TriangleMesh& mesh, int face, int k) {
  return position_of(mesh.vertices, mesh.faces(face, k));
}

/// Returns a tree over the faces with finite corners.
BoxTree finite_faces(const TriangleMesh& mesh) {
  constexpr int kLeaf = 4;
  std::vector<int> faces;
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<std::size_t>(mesh.faces.rows()));
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    const auto corners = mesh.faces.row(f);
    if (std::all_of(corners.begin(), corners.end(), [&](int v) { return mesh.vertices.row(v).allFinite(); })) {
      faces.push_back(f);
      const Eigen::AlignedBox3d box = face_box(mesh.vertices, mesh.faces, f);
      // Not narrower than the error of distance_along(), nor than the spacing of numbers.
      constexpr double kRounding = 1e-15;
      const Vector3 margin = Vector3::Constant(kRaySeam * box.diagonal().norm()) +
                             kRounding * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
      boxes[f] = {box.min() - margin, box.max() + margin};
    }
  }
  const auto box_of = [&boxes](int f) -> const Eigen::AlignedBox3d& { return boxes[f]; };
  return BoxTree(std::move(faces), kLeaf, box_of, [](int) { return 0; });
}

}  // namespace

Visibility::Visibility(const TriangleMesh& mesh) : mesh_(mesh), faces_(finite_faces(mesh)) {
  if (faces_.items().size() > 1) {
    constexpr double kSamePosition = 1e-7;
    same_position_ = kSamePosition * faces_.nodes().front().box.diagonal().norm();
  }
}

bool Visibility::shows_side(const Camera& view, const Adjacency& adjacency, int vertex, int side) const {
  const Vector3 position = mesh_.vertices.row(vertex).transpose();
  const Ray through = view.ray(view.pixel(position));
  const CompressedRows::Row around = adjacency.faces[vertex];
  // The comparisons make points behind the viewer and NaN invisible.
  return (position - through.origin).dot(through.direction) >= 0 &&
         std::any_of(around.begin(), around.end(),
                     [&](int f) { return side * area_normal(mesh_, f).dot(through.direction) < 0; });
}

bool Visibility::sees(const Camera& view, const Adjacency& adjacency, int vertex, int side) const {
  if (!shows_side(view, adjacency, vertex, side)) {
    return false;
  }
  const Vector3 position = mesh_.vertices.row(vertex).transpose();
  // Ends at the near plane, which clips everything before it: the viewer may be inside the mesh.
  const Ray through = view.ray(view.pixel(position));
  const double reach = (position - through.origin).dot(through.direction);
  const Ray back{position, -through.direction};
  return !faces_.along(back, reach, [&](int face) {
    const double t = distance_along(mesh_, back, face);
    return t > same_position_ && t < reach && !(mesh_.faces.row(face).array() == vertex).any();
  });
}

std::optional<SurfaceHit> Visibility::first_hit(const Ray& ray, double limit, int except) const {
  double distance = limit;
  int found = -1;
  faces_.along(ray, distance, [&](int face) {
    const double t = distance_along(mesh_, ray, face);
    const bool is_nearer = t < distance || (t == distance && found >= 0 && face < found);
    if (is_nearer && !(mesh_.faces.row(face).array() == except).any()) {
      distance = t;
      found = face;
    }
    return false;
  });
  return found >= 0 ? std::optional(hit_of(mesh_, ray, found, distance)) : std::nullopt;
}

std::vector<int> brushed_vertices(const TriangleMesh& mesh, const Adjacency& adjacency, const Visibility& visibility,
                                  const Camera& view, const std::vector<SurfaceHit>& hits, const Vector2& from,
                                  const Vector2& to, double radius) {
  constexpr double kPixels = 2;
  const Vector2 way = to - from;
  const double squared = way.squaredNorm();
  const auto is_near = [&](const Vector2& pixel) {
    const double along = squared > 0 ? std::clamp((pixel - from).dot(way) / squared, 0.0, 1.0) : 0;
    return (pixel - from - along * way).norm() <= radius;
  };
  std::vector<int> all;
  for (const int side : {-1, 1}) {
    std::vector<char> known(mesh.vertices.rows(), 0);
    std::map<std::array<double, 3>, bool> shown;  // by pixel and depth: dense meshes have many vertices in each
    std::vector<int> found;
    const auto look = [&](int v, bool anywhere) {
      const Vector3 position = mesh.vertices.row(v).transpose();
      const Vector2 pixel = view.pixel(position);
      if (known[v] || !(anywhere || is_near(pixel)) || !visibility.shows_side(view, adjacency, v, side)) {
        return;
      }
      known[v] = 1;
      const Vector3& origin = hits.front().point;
      const double depth = view.toward_viewer(origin).dot(position - origin) / view.pixel_size(origin);
      const Eigen::Array3d slot = (Eigen::Array3d(pixel.x(), pixel.y(), depth) / kPixels).floor();
      const auto [place, is_new] = shown.try_emplace({slot.x(), slot.y(), slot.z()});
      if (is_new) {
        place->second = visibility.sees(view, adjacency, v, side);
      }
      if (place->second) {
        found.push_back(v);
      }
    };
    for (const SurfaceHit& hit : hits) {
      if ((area_normal(mesh, hit.face).dot(view.toward_viewer(hit.point)) < 0) == (side < 0)) {
        look(hit.vertex, true);
        for (const int corner : mesh.faces.row(hit.face)) {
          look(corner, false);
        }
      }
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (const int w : adjacency.neighbours[found[k]]) {
        look(w, false);
      }
    }
    all.insert(all.end(), found.begin(), found.end());
  }
  return sorted_set(std::move(all));
}

double distance_along(const TriangleMesh& mesh, const Ray& ray, int face) {
  const Vector3 a = corner(mesh, face, 0);
  const Vector3 along = corner(mesh, face, 1) - a;
  const Vector3 across = corner(mesh, face, 2) - a;
  const Vector3 p = ray.direction.cross(across);
  const double determinant = along.dot(p);
  if (!(std::abs(determinant) > 0)) {
    return kUnreached;
  }
  const Vector3 offset = ray.origin - a;
  const double u = offset.dot(p) / determinant;
  if (!(u >= -kRaySeam && u <= 1 + kRaySeam)) {
    return kUnreached;
  }
  const Vector3 q = offset.cross(along);
  const double v = ray.direction.dot(q) / determinant;
  if (!(v >= -kRaySeam && u + v <= 1 + kRaySeam)) {
    return kUnreached;
  }
  const double t = across.dot(q) / determinant;
  return t >= 0 && std::isfinite(t) ? t : kUnreached;
}

SurfaceHit hit_of(const TriangleMesh& mesh, const Ray& ray, int face, double distance) {
  SurfaceHit hit;
  hit.point = ray.origin + distance * ray.direction;
  hit.face = face;
  double closest = kUnreached;
  for (int k = 0; k < 3; ++k) {
    const double away = (corner(mesh, face, k) - hit.point).norm();
    if (away < closest) {
      closest = away;
      hit.vertex = mesh.faces(face, k);
    }
  }
  return hit;
}

std::vector<int> enclosed_vertices(const TriangleMesh& mesh, const Adjacency& adjacency, const Visibility& visibility,
                                   const Camera& view, const std::vector<Vector2>& line) {
  const auto encloses = [&line](const Vector2& pixel) {
    bool inside = false;
    for (std::size_t k = 0; k < line.size(); ++k) {
      const Vector2 &a = line[k], &b = line[(k + 1) % line.size()];
      const bool crosses = (a.y() > pixel.y()) != (b.y() > pixel.y());
      inside ^= crosses && pixel.x() < a.x() + (pixel.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    }
    return inside;
  };
  constexpr int kGrain = 512;
  std::vector<char> seen(mesh.vertices.rows(), 0);
  ThreadPool pool(0);
  for_indices(pool, static_cast<int>(seen.size()), kGrain, [&](int v) {
    const Vector3 position = mesh.vertices.row(v).transpose();
    seen[v] = position.allFinite() && view.in_front(position) && encloses(view.pixel(position)) &&
              (visibility.sees(view, adjacency, v) || visibility.sees(view, adjacency, v, -1));
  });
  std::vector<int> vertices;
  for (int v = 0; v < static_cast<int>(seen.size()); ++v) {
    if (seen[v]) {
      vertices.push_back(v);
    }
  }
  return vertices;
}

}  // namespace lapedit
