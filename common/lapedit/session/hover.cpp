// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/hover.h"

#include <chrono>
#include <cmath>
#include <future>
#include <system_error>

#include "lapedit/mesh/distance_contour.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

constexpr double kOfSize = 0.02;  // of the mesh

}  // namespace

HoverSearch::HoverSearch(const TriangleMesh& mesh, const Adjacency& adjacency)
    : mesh_(mesh),
      adjacency_(adjacency),
      faces_(mesh),
      grid_(mesh.vertices, usable_vertices(mesh)),
      near_(kOfSize * bounding_box(mesh.vertices, usable_vertices(mesh)).diagonal().norm()),
      search_({mesh, adjacency}),
      paths_(adjacency.neighbours, mesh.vertices) {}

std::optional<SurfaceHit> HoverSearch::hit(const Camera& view, const Vector2& pixel) const {
  std::optional<SurfaceHit> hit = faces_.first_hit(view.ray(pixel));
  for (const double pixels : {2.0, 4.0}) {
    for (int i = 0; i < 8 && !hit; ++i) {
      const double angle = i * std::atan(1.0);
      hit = faces_.first_hit(view.ray(pixel + pixels * Vector2(std::cos(angle), std::sin(angle))));
    }
  }
  return hit;
}

void HoverSearch::outline(int vertex, HoverPreview& preview) {
  preview.region.resize(0, 3);
  preview.disc.resize(0, 3);
  const bool with_region = preview.kind == HoverPreview::Kind::Region;
  const double farthest = with_region ? preview.radius : preview.disc_radius;
  const std::vector<int>& reached = search_.run({vertex}, farthest, nullptr, kMostVertices);
  preview.is_whole = reached.size() < kMostVertices;
  const double seen = preview.is_whole || reached.empty() ? farthest : search_.distance(reached.back());
  if (with_region && preview.is_whole) {
    distance_contour(mesh_, adjacency_, search_, preview.radius, reached, ends_, preview.region);
  }
  if (preview.disc_radius > 0 && preview.disc_radius <= seen) {
    distance_contour(mesh_, adjacency_, search_, preview.disc_radius, reached, ends_, preview.disc);
  }
}

void HoverSearch::mirrored_outline(const std::optional<MirrorPlane>& plane, int vertex, HoverPreview& preview) {
  preview.mirrored_region.resize(0, 3);
  preview.mirrored_disc.resize(0, 3);
  preview.mirrored_point.reset();
  const Vector3 position =
      plane ? Vector3(reflection(*plane) * mesh_.vertices.row(vertex).transpose()) : Vector3::Zero();
  const int image = plane && position.allFinite() ? grid_.nearest(position, near_) : -1;
  if (image < 0) {
    return;
  }
  HoverPreview other;
  other.kind = preview.kind;
  other.radius = preview.radius;
  other.disc_radius = preview.disc_radius;
  outline(image, other);
  preview.mirrored_region = std::move(other.region);
  preview.mirrored_disc = std::move(other.disc);
  preview.mirrored_point = mesh_.vertices.row(image).transpose();
}

void HoverSearch::path(int from, int to, Points& positions) {
  if (from < 0) {
    positions.resize(0, 3);
    return;
  }
  if (from != paths_from_) {
    paths_.begin(from, kMostVertices);
    paths_from_ = from;
  }
  positions = gather(mesh_.vertices, paths_.to(to));
}

HoverSearch* HoverBackground::of(const std::shared_ptr<const TriangleMesh>& mesh,
                                 const std::shared_ptr<const Adjacency>& adjacency) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (found_) {
      ready_ = std::move(found_);
      is_coming_ = false;
    }
  }
  if (ready_ && ready_->mesh == mesh) {
    return &ready_->search;
  }
  if (!is_coming_) {
    try {
      work_ = JoinedThread(std::packaged_task<void()>([this, mesh, adjacency] {
        auto made = std::make_unique<Made>(mesh, adjacency);
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          found_ = std::move(made);
        }
        wake_();
      }));
      is_coming_ = true;
    } catch (const std::system_error&) {
      // No thread is available: the next movement of the mouse tries again.
    }
  }
  return nullptr;
}

}  // namespace lapedit
