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

std::optional<SurfaceHit> HoverSearch::hit(const Ray& ray) const {
  return faces_.first_hit(ray);
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
  if (mesh != mesh_ && !is_coming_) {
    ready_.reset();
    mesh_ = mesh;
    adjacency_ = adjacency;
    is_coming_ = true;
    try {
      work_ = JoinedThread(std::packaged_task<void()>([this, mesh, adjacency] {
        auto search = std::make_unique<HoverSearch>(*mesh, *adjacency);
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          found_ = std::move(search);
        }
        wake_();
      }));
    } catch (const std::system_error&) {  // no thread is available: the next movement of the mouse tries again
      mesh_.reset();
      is_coming_ = false;
      return nullptr;
    }
  }
  return mesh == mesh_ ? ready_.get() : nullptr;
}

}  // namespace lapedit
